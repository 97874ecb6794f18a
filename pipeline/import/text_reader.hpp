// Text of points: xyz rows and CSV profiles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/byte_window.hpp"
#include "pipeline/import/sample.hpp"
#include "pipeline/import/text_fields.hpp"

#include <memory>
#include <optional>

namespace scansion {

struct TextOptions {
  bool csv = false;            ///< a heading, two columns and empty fields are allowed
  std::vector<Column> columns; ///< given by the caller; empty: found
  bool third_is_label = false; ///< three columns without a heading are x, z, label
};

/// One row, one sample. Blank rows end scan lines, `#` starts a comment.
class TextReader final : public SampleReader {
public:
  /// `notes` outlives the reader.
  TextReader(ByteWindow window, TextOptions options, Notes& notes);

  [[nodiscard]] Result<std::size_t> read(std::span<Sample> out) override;
  [[nodiscard]] std::string where(std::uint64_t place) const override;
  [[nodiscard]] std::uint64_t position() const noexcept override { return window_.position(); }
  [[nodiscard]] bool without_y() const noexcept override { return begun_ && !has_y_; }
  [[nodiscard]] bool third_may_be_label() const noexcept override { return third_may_be_label_; }

private:
  enum class Row : std::uint8_t { sample, blank, nothing };

  [[nodiscard]] bool parse_fast(const char* p, Sample& sample) noexcept;
  [[nodiscard]] Result<Row> parse_carefully(std::string_view row, Sample& sample);
  [[nodiscard]] Result<bool> begin(std::string_view text);
  [[nodiscard]] Result<void> begin_heading();
  [[nodiscard]] Result<void> begin_headless();
  void use(std::vector<Column> columns);
  [[nodiscard]] Result<void> read_fields(Sample& sample);
  [[nodiscard]] Result<void> read_field(std::size_t column, Sample& sample);
  [[nodiscard]] Error too_few(std::size_t found) const;
  void note_extra();

  ByteWindow window_;
  TextOptions options_;
  Notes& notes_;
  Delimiter delimiter_ = Delimiter::any;
  std::vector<Column> columns_; ///< up to the last one that is used
  std::array<std::uint8_t, 256> classes_{};
  bool begun_ = false; ///< the first row with fields has been seen
  bool fast_ = false;  ///< all used columns are coordinates
  bool has_y_ = true;
  bool third_may_be_label_ = false;
  bool line_open_ = false;  ///< a sample came since the last line_end
  bool note_extra_ = false; ///< columns after the used ones deserve a note
  std::vector<std::string_view> fields_;
  std::string line_text_; ///< the line column's last text
  bool has_line_text_ = false;
  bool new_line_ = false;      ///< the row just read starts a new line
  std::optional<Sample> held_; ///< found no room after a line_end
};

} // namespace scansion
