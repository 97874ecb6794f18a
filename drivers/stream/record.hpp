// One record of a described stream: bytes to values on the lattice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/link_counters.hpp"
#include "drivers/stream/plan.hpp"
#include "pipeline/import/number.hpp"

#include <span>

namespace scansion::stream {

/// Coordinates are counts whose magnitude is below this, so that every run fits the lattice.
inline constexpr std::int64_t kMostCounts = (std::int64_t{1} << 29) - 1;

struct Record {
  std::array<std::int64_t, 3> xyz{};
  bool is_invalid = false;
  std::optional<std::int64_t> line, time_ns, encoder;
};

/// The whole number nearest to number * factor (half away from zero) and how far it is; empty when it is not within `most`.
struct Rounded {
  std::int64_t value = 0;
  double error = 0.0;
};
[[nodiscard]] std::optional<Rounded> round_to(const Number& number, Rational factor, std::int64_t most) noexcept;

/// Thread-bound.
class RecordReader {
public:
  /// Fails with config when a scale and the resolution have no exact ratio.
  [[nodiscard]] static Result<RecordReader> create(const Plan& plan);

  /// A row with its sum, if it has one; the character behind it belongs to no number. Empty: taken.
  [[nodiscard]] std::optional<Reject> read(std::string_view row, Record& out);
  /// The fields of a binary record, whose sum was checked.
  [[nodiscard]] std::optional<Reject> read(std::span<const std::uint8_t> fields, Record& out);
  /// Whether the sum at the end of a binary record is right.
  [[nodiscard]] bool is_sum_right(std::span<const std::uint8_t> record) const noexcept;
  /// Largest rounding error met, in counts.
  [[nodiscard]] double rounding() const noexcept { return rounding_; }

private:
  [[nodiscard]] bool cut_sum(std::string_view& row) const noexcept;
  [[nodiscard]] bool take(const Field& field, Rational factor, const Number& number, Record& out);
  [[nodiscard]] Number load(const Storage& storage, const std::uint8_t* at) const noexcept;

  std::vector<Field> fields_;
  std::vector<Rational> factors_; ///< counts (or ns) in one of each field
  Checksum sum_ = Checksum::none;
  std::size_t sum_from_ = 0;
  bool is_sum_big_endian_ = false;
  std::string null_;
  std::optional<Number> null_number_; ///< for binary records
  double rounding_ = 0.0;
};

} // namespace scansion::stream
