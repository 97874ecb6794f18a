// Remarks for a person, each subject once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace scansion {

/// Hands one-line remarks to the caller's function; a second remark on the same subject is left out. Thread-bound.
class Notes {
public:
  enum class Subject : std::uint8_t { passed_over, extra_columns, other_columns, labels, no_labels, bits, properties };

  explicit Notes(std::function<void(const std::string&)> sink) : sink_(std::move(sink)) {}

  void say(Subject subject, const std::string& text) {
    const std::uint32_t bit = 1U << static_cast<unsigned>(subject);
    if ((said_ & bit) != 0) return;
    said_ |= bit;
    if (sink_) sink_(text);
  }

private:
  std::function<void(const std::string&)> sink_;
  std::uint32_t said_ = 0;
};

} // namespace scansion
