// The decoder of the example device.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/template/decoder.hpp"

#include <charconv>

namespace scansion {
namespace {

/// The number up to the next comma or the end, which is cut off `text` with it.
template <class Number>
bool take_number(std::string_view& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (text.empty()) return true;
  if (text.front() != ',') return false;
  text.remove_prefix(1);
  return !text.empty();
}

/// Cuts "*HH" off; false when it is missing or not the exclusive or of the bytes before it.
bool take_sum(std::string_view& text) {
  if (text.size() < 3 || text[text.size() - 3] != '*') return false;
  unsigned said = 0;
  const auto [end, error] = std::from_chars(text.data() + text.size() - 2, text.data() + text.size(), said, 16);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  text.remove_suffix(3);
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  return sum == said;
}

} // namespace

bool TemplateDecoder::take_profile(std::string_view text) {
  // From the outside in: what is no frame at all is not asked for its sum, and values are trusted after it only.
  if (!text.starts_with("P,")) {
    counters_.reject(Reject::framing);
    return false;
  }
  if (!take_sum(text)) {
    counters_.reject(Reject::checksum);
    return false;
  }
  text.remove_prefix(2);
  std::uint64_t index = 0;
  std::uint32_t points = 0;
  LineBuffer& line = held_.buffer();
  line.clear();
  if (!take_number(text, index) || !take_number(text, points)) {
    counters_.reject(Reject::value);
    return false;
  }
  std::int32_t x = 0;
  std::int32_t z = 0;
  while (!text.empty() && take_number(text, x) && take_number(text, z)) {
    line.xyz[0].push_back(x);
    line.xyz[1].push_back(0);
    line.xyz[2].push_back(z);
  }
  if (!text.empty() || line.points() != points) {
    counters_.reject(Reject::count);
    return false;
  }
  if (points > 0) line.runs.push_back({0, points, 0});
  index_ = index;
  counters_.accept();
  return true;
}

Decoder::Step TemplateDecoder::decode(std::span<const std::uint8_t> bytes, const Moment& /*at*/, LineBuffer& line, Gap& gap) {
  Step step;
  while (!held_.is_ready()) {
    const auto text = text_.next(bytes, step.used);
    if (!text) return step;
    if (*text == "OK") {
      counters_.accept();
      step.what = Decoded::reply;
      return step;
    }
    if (!take_profile(*text)) continue;
    held_.ready();
    const std::uint64_t expected = next_index_.value_or(index_);
    next_index_ = index_ + 1;
    if (index_ > expected) return HeldLine::tell(step, gap, index_ - expected, "profiles are missing");
  }
  return held_.give(step, line);
}

} // namespace scansion
