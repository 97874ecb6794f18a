// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/rises.hpp"

#include "pipeline/feature/passes/passes.hpp"

namespace scansion {

void note_rises(Profile& profile, double above, std::vector<std::uint32_t>& scratch) {
  profile.rises_above = above;
  const std::size_t n = profile.size();
  scratch.resize(n);
  const double* const w = profile.w.data();
  const std::size_t found = n == 0 ? 0 : passes::apart(w + 1, w, profile.rises_above, scratch.data(), n - 1);
  profile.rises.assign(scratch.begin(), scratch.begin() + static_cast<std::ptrdiff_t>(found));
}

std::span<const std::uint32_t> rises_of(std::span<const std::uint32_t> rises, std::uint32_t begin, std::uint32_t end) noexcept {
  if (rises.empty() || (rises.front() >= begin && rises.back() + 1 < end)) return rises;
  const auto first = std::lower_bound(rises.begin(), rises.end(), begin);
  return {first, std::lower_bound(first, rises.end(), end - 1)};
}

} // namespace scansion
