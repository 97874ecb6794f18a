// Between the samples beside each column: many columns at once where samples stand as densely as columns, one by one elsewhere.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/column_samples.hpp"

#include "pipeline/feature/passes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scansion {

namespace {

constexpr std::uint32_t kBlock = passes::ColumnBlock::kSize;
constexpr double kSlack = 0.05; // of a pitch: samples often stand on columns but for their rounding

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

// Takes a block of columns if samples stand beside them one by one, and none of them at a wall.
bool ColumnSampler::take_block(std::uint32_t k, std::int64_t column) noexcept {
  std::array<float, kBlock> height;
  std::array<std::uint32_t, kBlock> behind;
  const passes::ColumnBlock block{static_cast<double>(column), grid_.pitch, grid_.base, widest_, jump_, kSlack * grid_.pitch};
  if (!passes::sample_columns(s_ + k, w_ + k, block, height.data(), behind.data())) return false;
  std::copy(height.begin(), height.end(), height_ + (column - grid_.left));
  std::uint32_t* const source = source_ + (column - grid_.left);
  const std::uint32_t* const samples = samples_ + k;
  for (std::size_t i = 0; i < kBlock; ++i) source[i] = samples[i + behind[i]];
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
