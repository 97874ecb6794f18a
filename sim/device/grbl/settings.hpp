// The numbered settings of a Grbl controller.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace scansion::sim::grbl {

/// `$n=v`. Values that stay through a reset and a power cut.
class Settings {
public:
  Settings();

  [[nodiscard]] double get(int number) const { return values_.at(number); }
  [[nodiscard]] bool is_on(int number) const { return get(number) != 0.0; }
  /// 0, or the number of the error.
  [[nodiscard]] int set(double number, double value);
  void force(int number, double value) { values_.at(number) = value; }
  /// `$n=v` a line, as `$$` shows them.
  [[nodiscard]] std::string listing() const;

private:
  std::map<int, double> values_;
};

} // namespace scansion::sim::grbl
