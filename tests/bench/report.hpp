// Tables for a person (Markdown, aligned for a terminal) and for programs (JSON).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace scansion::bench {

/// What a figure has to reach: not above `must`, better not above `good`.
struct Bar {
  double must = 0.0, good = 0.0;
};

struct Figure {
  double value = 0.0;
  int decimals = 2;
};
struct Count {
  std::uint64_t value = 0;
};
/// One cell: nothing, words, a figure or a count.
using Cell = std::variant<std::monostate, std::string, Figure, Count>;

class Table {
public:
  Table(std::string title, std::vector<std::string> columns, std::string note = {})
      : title_(std::move(title)), columns_(std::move(columns)), note_(std::move(note)) {}

  void add(std::vector<Cell> cells) { rows_.push_back(std::move(cells)); }

  [[nodiscard]] const std::string& title() const noexcept { return title_; }
  [[nodiscard]] const std::string& note() const noexcept { return note_; }
  [[nodiscard]] const std::vector<std::string>& columns() const noexcept { return columns_; }
  [[nodiscard]] const std::vector<std::vector<Cell>>& rows() const noexcept { return rows_; }

private:
  std::string title_;
  std::vector<std::string> columns_;
  std::string note_;
  std::vector<std::vector<Cell>> rows_;
};

/// Prints each table when it is complete; as JSON all of them at the end.
class Report {
public:
  explicit Report(bool json) noexcept : json_(json) {}

  void print(const Table& table);
  void finish();

  /// The three cells "must", "good" and the mark: good, pass or FAIL. Empty without a bar.
  void judge(std::vector<Cell>& cells, double value, const std::optional<Bar>& bar);
  /// The same for a figure that should be high: not below `must`, better not below `good`.
  void judge_high(std::vector<Cell>& cells, double value, const Bar& bar);
  /// How many figures missed their must.
  [[nodiscard]] unsigned failed() const noexcept { return failed_; }

private:
  void mark(std::vector<Cell>& cells, const Bar& bar, bool good, bool pass);

  bool json_;
  std::vector<Table> tables_;
  unsigned failed_ = 0;
};

} // namespace scansion::bench
