// Faults of a simulated connection.
// SPDX-License-Identifier: Apache-2.0
#include "sim/port/fault_plan.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace scansion {
namespace {

constexpr std::array<std::string_view, 11> kPortKinds{"unplug", "cut",  "mute", "garbage",   "flip", "drop",
                                                      "insert", "half", "drip", "duplicate", "lose"};

std::int64_t nanoseconds(double seconds) {
  return static_cast<std::int64_t>(std::min(seconds, 1e9) * 1e9);
}

/// Over as soon as it happened.
bool is_moment(std::string_view kind) {
  return kind == "cut" || kind == "garbage" || kind == "half";
}

} // namespace

Result<FaultSpec> parse_fault(std::string_view text) {
  FaultSpec out;
  const std::size_t colon = text.find(':');
  out.fault.kind = text.substr(0, colon);
  if (out.fault.kind.empty()) return fail(Errc::usage, "--fault ", text, ": has no kind; write KIND[:key=value,...]");
  std::string_view rest = colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
  while (!rest.empty()) {
    const std::string_view part = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    const std::size_t equals = part.find('=');
    double value = 0.0;
    if (equals == std::string_view::npos) return fail(Errc::usage, "--fault ", text, ": '", part, "' is no key=value");
    const std::string_view number = part.substr(equals + 1);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(value)) {
      return fail(Errc::usage, "--fault ", text, ": '", number, "' is no number");
    }
    out.fault.values[std::string(part.substr(0, equals))] = value;
  }
  for (const auto& [key, value] : out.fault.values) {
    const bool is_time = key == "at" || key == "for" || key == "every";
    if ((is_time || key == "rate") && value < 0.0) return fail(Errc::usage, "--fault ", text, ": ", key, " is negative");
  }
  out.at = out.fault.value("at", 0.0);
  if (out.fault.values.contains("for")) out.lasts = out.fault.value("for", 0.0);
  if (out.fault.values.contains("every")) out.every = std::max(0.001, out.fault.value("every", 1.0));
  out.jitter = std::clamp(out.fault.value("jitter", 0.0), 0.0, 1.0);
  if (!out.lasts && out.every && !is_moment(out.fault.kind)) out.lasts = *out.every / 10.0;
  return out;
}

FaultPlan::FaultPlan(std::vector<FaultSpec> specs, std::uint64_t seed) : random_(seed, 0, 77) {
  for (FaultSpec& spec : specs) {
    const std::int64_t first = nanoseconds(spec.at);
    entries_.push_back({std::move(spec), first, false});
  }
}

bool FaultPlan::is_of_port(std::string_view kind) {
  return std::find(kPortKinds.begin(), kPortKinds.end(), kind) != kPortKinds.end();
}

bool FaultPlan::next_change(std::int64_t now_ns, Change& change) {
  for (Entry& entry : entries_) {
    if (entry.next > now_ns) continue;
    const FaultSpec& spec = entry.spec;
    entry.holds = !entry.holds;
    change = {&spec.fault, entry.holds};
    if (entry.holds && (spec.lasts || is_moment(spec.fault.kind))) {
      entry.next += is_moment(spec.fault.kind) ? 0 : nanoseconds(*spec.lasts);
    } else if (!entry.holds && spec.every) {
      const double vary = 1.0 + spec.jitter * (2.0 * random_.uniform() - 1.0);
      entry.next += nanoseconds(std::max(0.001, *spec.every * vary - spec.lasts.value_or(0.0)));
    } else {
      entry.next = kNoTime;
    }
    return true;
  }
  return false;
}

std::int64_t FaultPlan::next_at() const {
  std::int64_t next = kNoTime;
  for (const Entry& entry : entries_) next = std::min(next, entry.next);
  return next;
}

bool FaultPlan::holds(std::string_view kind) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.holds && e.spec.fault.kind == kind; });
}

double FaultPlan::rate(std::string_view kind) const {
  double sum = 0.0;
  for (const Entry& entry : entries_) {
    if (entry.holds && entry.spec.fault.kind == kind) sum += entry.spec.fault.value("rate", 0.001);
  }
  return sum;
}

void FaultPlan::disturb(std::vector<std::uint8_t>& message) {
  if (chance(rate("lose"))) {
    message.clear();
    return;
  }
  if (std::exchange(halves_, false)) message.resize(message.size() / 2);
  const double flip = rate("flip");
  const double drop = rate("drop");
  const double insert = rate("insert");
  if (flip + drop + insert > 0.0) {
    scratch_.clear();
    for (std::uint8_t byte : message) {
      if (chance(drop)) continue;
      if (chance(insert)) scratch_.push_back(static_cast<std::uint8_t>(random_.below(256)));
      if (chance(flip)) byte = static_cast<std::uint8_t>(byte ^ (1U << random_.below(8)));
      scratch_.push_back(byte);
    }
    std::swap(message, scratch_);
  }
  if (chance(rate("duplicate"))) {
    const std::size_t size = message.size();
    message.resize(2 * size);
    std::copy_n(message.begin(), size, message.begin() + static_cast<std::ptrdiff_t>(size));
  }
}

std::vector<std::uint8_t> FaultPlan::garbage(const DeviceFault& fault) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(std::clamp(fault.value("count", 100.0), 1.0, 1e6)));
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random_.below(256));
  return bytes;
}

} // namespace scansion
