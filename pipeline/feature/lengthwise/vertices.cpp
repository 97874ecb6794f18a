// Both neighbours of all points in one pass each with a stack of falling distances.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/lengthwise/vertices.hpp"

#include "pipeline/feature/passes/passes.hpp"

namespace scansion {

namespace {

constexpr double kLike = 0.5; // kappa: a neighbour's distance against the point's

/// Samples of falling distance, seen from where the search has come to: each hides what is nearer and lower.
class Hiding {
public:
  Hiding(const double* distance, std::uint32_t* samples, std::uint32_t first) : distance_(distance), samples_(samples) {
    samples_[0] = first; // the end of the run: it hides all beyond
  }

  /// The nearest sample before `k` that is ranked high enough; from now on `k` is looked at, and not what it hides.
  [[nodiscard]] std::uint32_t pass(std::uint32_t k) noexcept {
    const double d = distance_[k];
    while (top_ > 0 && distance_[samples_[top_]] < kLike * d) --top_;
    const std::uint32_t found = samples_[top_];
    while (top_ > 0 && distance_[samples_[top_]] <= d) --top_;
    samples_[++top_] = k;
    return found;
  }

private:
  const double* distance_;
  std::uint32_t* samples_;
  std::size_t top_ = 0;
};

} // namespace

void find_vertices(const Profile& profile, double least, std::vector<std::uint32_t>& scratch, std::vector<Vertex>& out) {
  out.clear();
  scratch.resize(profile.size());
  const double* distance = profile.distance.data();
  std::uint32_t first = 0;
  for (const std::uint32_t end : profile.ends) {
    const std::size_t inner = end - first > 2 ? end - first - 2 : 0;
    const std::size_t count = passes::reaching(distance + first + 1, least, scratch.data(), inner), begin = out.size();
    for (std::size_t i = 0; i < count; ++i) out.push_back({scratch[i] + first + 1, 0, 0});
    Hiding left(distance, scratch.data(), first);
    for (std::size_t i = begin; i < out.size(); ++i) out[i].before = left.pass(out[i].k);
    Hiding right(distance, scratch.data(), end - 1);
    for (std::size_t i = out.size(); i-- > begin;) out[i].after = right.pass(out[i].k);
    first = end;
  }
}

} // namespace scansion
