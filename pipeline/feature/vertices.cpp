// Both neighbours of all points in one pass each with a stack of falling distances.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/vertices.hpp"

namespace scansion {

namespace {

constexpr double kLike = 0.5; // kappa: a neighbour's distance against the point's

// The nearest sample on the stack that is ranked high enough; drops what the sample itself hides.
std::uint32_t neighbour(const Profile& p, std::vector<std::uint32_t>& stack, std::uint32_t k) {
  std::size_t top = stack.size();
  while (top > 1 && p.distance[stack[top - 1]] < kLike * p.distance[k]) --top;
  const std::uint32_t found = stack[top - 1];
  while (stack.size() > 1 && p.distance[stack.back()] <= p.distance[k]) stack.pop_back();
  stack.push_back(k);
  return found;
}

} // namespace

void find_vertices(const Profile& profile, double least, std::vector<std::uint32_t>& stack, std::vector<Vertex>& out) {
  out.clear();
  std::uint32_t first = 0;
  for (const std::uint32_t end : profile.ends) {
    const std::size_t begin = out.size();
    for (std::uint32_t k = first + 1; k + 1 < end; ++k)
      if (profile.distance[k] >= least) out.push_back({k, 0, 0});
    stack.assign(1, first);
    for (std::size_t i = begin; i < out.size(); ++i) out[i].before = neighbour(profile, stack, out[i].k);
    stack.assign(1, end - 1);
    for (std::size_t i = out.size(); i-- > begin;) out[i].after = neighbour(profile, stack, out[i].k);
    first = end;
  }
}

} // namespace scansion
