// One row of an option schema (key, type, default, range, meaning) and the values read by it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace scansion {

enum class OptionType : std::uint8_t {
  text,
  integer,
  number,        ///< a TOML integer is taken too
  flag,          ///< true or false
  text_or_number ///< a word or a number; kept as text, the shortest decimal for a number
};

/// A default value. std::monostate: none, the key may be absent.
using OptionDefault = std::variant<std::monostate, bool, std::int64_t, double, std::string_view>;
/// A value in force.
using OptionValue = std::variant<bool, std::int64_t, double, std::string>;

/// Configuration, sample configuration and messages are all made from these rows.
struct Option {
  std::string_view key;
  OptionType type = OptionType::text;
  OptionDefault standard{};
  std::string_view meaning{}; ///< one line for a person, with the unit
  bool required = false;
  double min = -std::numeric_limits<double>::infinity(); ///< inclusive; numbers and integers
  double max = std::numeric_limits<double>::infinity();
  Result<void> (*check)(std::string_view) = nullptr; ///< texts: the context of its error is the reason
  std::string_view example{};                        ///< as TOML, shown where there is no value
  bool alternative = false; ///< instead of a row before it: an example of the whole table leaves it out
};

/// Values of one table, checked against its schema: every key with a default is present.
class OptionValues {
public:
  void set(std::string_view key, OptionValue value) { values_.insert_or_assign(std::string(key), std::move(value)); }

  /// The value, or nothing when the key is absent or of another type.
  template <class T>
  [[nodiscard]] std::optional<T> get(std::string_view key) const {
    const auto at = values_.find(key);
    if (at == values_.end()) return std::nullopt;
    const T* value = std::get_if<T>(&at->second);
    return value == nullptr ? std::nullopt : std::optional<T>(*value);
  }
  [[nodiscard]] std::string text(std::string_view key) const { return get<std::string>(key).value_or(std::string()); }
  [[nodiscard]] std::int64_t integer(std::string_view key) const { return get<std::int64_t>(key).value_or(0); }
  [[nodiscard]] bool flag(std::string_view key) const { return get<bool>(key).value_or(false); }
  [[nodiscard]] const OptionValue* find(std::string_view key) const {
    const auto at = values_.find(key);
    return at == values_.end() ? nullptr : &at->second;
  }

  friend bool operator==(const OptionValues&, const OptionValues&) = default;

private:
  std::map<std::string, OptionValue, std::less<>> values_;
};

} // namespace scansion
