// All members of the input as one stream of samples that can be started again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/import.hpp"
#include "pipeline/import/members.hpp"
#include "pipeline/import/sample.hpp"
#include "pipeline/import/text_fields.hpp"

#include <memory>

namespace scansion {

/// What three columns of CSV text without a heading mean.
enum class ThirdColumn : std::uint8_t {
  height, ///< x, y, z
  label   ///< x, z and a mark of 0 or 1
};

/// Each member ends with a line_end sample. Coordinates that the input does not state are filled in. Thread-bound.
class SampleStream {
public:
  /// `options` and `notes` outlive the stream.
  SampleStream(MemberList list, std::vector<Column> columns, const ImportOptions& options, Notes& notes);

  void restart(ThirdColumn third);
  /// The next samples, valid until the next call; empty at the end of the input.
  [[nodiscard]] Result<std::span<const Sample>> next();
  /// Goes on with the next member.
  void skip_member() noexcept;
  /// Whether the samples that next() gave last have a third column that may be a label.
  [[nodiscard]] bool third_may_be_label() const noexcept { return reader_ && reader_->third_may_be_label(); }
  /// "file:row" of one of the samples that next() gave last.
  [[nodiscard]] std::string where(std::uint64_t place) const;
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return done_ + (reader_ ? reader_->position() : 0); }
  [[nodiscard]] std::uint64_t bytes_total() const noexcept { return total_; }
  /// The first member's name and how many there are, for errors about the whole input.
  [[nodiscard]] std::string description() const;

private:
  [[nodiscard]] Result<std::unique_ptr<SampleReader>> open(const Member& member) const;
  void fill_in_y(std::span<Sample> samples);
  [[nodiscard]] Number y_of_line() const noexcept;

  MemberList list_;
  std::vector<Column> columns_;
  const ImportOptions& options_;
  Notes& notes_;
  Number spacing_;
  std::uint64_t total_;
  ThirdColumn third_ = ThirdColumn::height;
  std::size_t member_ = 0; ///< the next one to open
  std::unique_ptr<SampleReader> reader_;
  bool ended_ = false;     ///< the reader's line_end has been given out
  std::uint64_t done_ = 0; ///< bytes of the members before the reader's
  std::uint64_t line_ = 0; ///< lines before the current one
  bool line_open_ = false;
  Number y_;
  std::array<Sample, 256> block_;
};

} // namespace scansion
