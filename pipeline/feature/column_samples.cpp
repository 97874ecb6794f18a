// Between the samples beside each column: many columns at once where samples stand as densely as columns, one by one elsewhere.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/column_samples.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace scansion {

namespace {

constexpr std::uint32_t kBlock = 16; // columns at once
constexpr double kMidway = 0.5;      // between two samples; what stands there belongs to the second one
constexpr double kSlack = 0.05;      // of a pitch: samples often stand on columns but for their rounding

class ColumnSampler {
public:
  ColumnSampler(const Profile& profile, const Sampling& sampling, const ColumnGrid& grid, float* height,
                std::uint32_t* source) noexcept
      : s_(profile.s.data()), w_(profile.w.data()), samples_(profile.source.data()), grid_(grid), height_(height),
        source_(source), widest_(3.5 * sampling.pitch), jump_(std::max(6.0 * sampling.noise, 1.5 * sampling.pitch)) {}

  /// Samples [begin, end) of the profile.
  void add_run(std::uint32_t begin, std::uint32_t end) noexcept;

private:
  [[nodiscard]] double place(std::int64_t column) const noexcept { return static_cast<double>(column) * grid_.pitch; }
  [[nodiscard]] bool take_block(std::uint32_t k, std::int64_t column) noexcept;
  void take(std::uint32_t k, std::int64_t column) noexcept;

  const double* const s_;
  const double* const w_;
  const std::uint32_t* const samples_;
  const ColumnGrid grid_;
  float* const height_;
  std::uint32_t* const source_;
  const double widest_, jump_; // mm: between samples, up
};

// Takes a block of columns if samples stand beside them one by one, s[i] before column i and s[i + 1] behind it, or hardly on
// the other side of it, and none of them at a wall. Without branches: for all samples of all lines.
bool ColumnSampler::take_block(std::uint32_t k, std::int64_t column) noexcept {
  const double* const s = s_ + k;
  const double* const w = w_ + k;
  const double first = static_cast<double>(column), pitch = grid_.pitch, base = grid_.base, widest = widest_, jump = jump_;
  std::array<float, kBlock> height;
  std::array<std::int32_t, kBlock> beyond; // 1: the sample beyond the column is the nearer one
  std::int64_t outside = 0;                // in its sign
  const double slack = kSlack * pitch;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double at = (first + static_cast<std::int32_t>(i)) * pitch, ds = s[i + 1] - s[i], dw = w[i + 1] - w[i];
    const double share = (at - s[i]) / ds;
    outside |= std::bit_cast<std::int64_t>(at + slack - s[i]) | std::bit_cast<std::int64_t>(s[i + 1] + slack - at) |
               std::bit_cast<std::int64_t>(widest - ds) | std::bit_cast<std::int64_t>(jump - std::abs(dw));
    height[i] = static_cast<float>(w[i] + dw * share - base);
    beyond[i] = static_cast<std::int32_t>(share + kMidway);
  }
  if (outside < 0) return false;
  std::copy(height.begin(), height.end(), height_ + (column - grid_.left));
  std::uint32_t* const source = source_ + (column - grid_.left);
  const std::uint32_t* const samples = samples_ + k;
  for (std::size_t i = 0; i < kBlock; ++i) source[i] = samples[i + static_cast<std::size_t>(beyond[i])];
  return true;
}

void ColumnSampler::take(std::uint32_t k, std::int64_t column) noexcept {
  const double t = place(column) - s_[k], ds = s_[k + 1] - s_[k], dw = w_[k + 1] - w_[k];
  if (ds > widest_) return;
  const std::uint32_t nearest = t < ds - t ? k : k + 1;
  height_[column - grid_.left] = static_cast<float>((std::abs(dw) > jump_ ? w_[nearest] : w_[k] + dw * (t / ds)) - grid_.base);
  source_[column - grid_.left] = samples_[nearest];
}

void ColumnSampler::add_run(std::uint32_t begin, std::uint32_t end) noexcept {
  if (end - begin < 2) return;
  const auto last = static_cast<std::int64_t>(std::floor(s_[end - 1] / grid_.pitch));
  std::uint32_t k = begin, singly = 0; // columns to take before the next block is tried
  for (auto column = static_cast<std::int64_t>(std::ceil(s_[begin] / grid_.pitch)); column <= last;) {
    while (k + 2 < end && s_[k + 1] < place(column)) ++k;
    if (singly == 0 && k + kBlock < end && column + std::int64_t{kBlock} - 1 <= last && take_block(k, column)) {
      k += kBlock - 1;
      column += kBlock;
    } else {
      take(k, column++);
      singly = singly > 0 ? singly - 1 : kBlock / 2;
    }
  }
}

} // namespace

void sample_columns(const Profile& profile, const Sampling& sampling, const ColumnGrid& grid, float* height,
                    std::uint32_t* source) {
  ColumnSampler sampler(profile, sampling, grid, height, source);
  std::uint32_t begin = 0;
  for (const std::uint32_t end : profile.ends) {
    sampler.add_run(begin, end);
    begin = end;
  }
}

} // namespace scansion
