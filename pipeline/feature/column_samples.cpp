// Between the samples beside each column: many columns at once where samples stand as densely as columns, one by one elsewhere.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/column_samples.hpp"

#include "pipeline/feature/passes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr std::uint32_t kBlock = passes::ColumnBlocks::kSize;
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
  [[nodiscard]] std::uint32_t take_blocks(std::uint32_t k, std::int64_t column, std::uint32_t most) noexcept;
  void take(std::uint32_t k, std::int64_t column) noexcept;

  const double* const s_;
  const double* const w_;
  const std::uint32_t* const samples_;
  const ColumnGrid grid_;
  float* const height_;
  std::uint32_t* const source_;
  const double widest_, jump_; // mm: between samples, up
};

// Takes blocks of columns as long as samples stand beside them one by one, and none of them at a wall. Returns how many
// columns these are.
std::uint32_t ColumnSampler::take_blocks(std::uint32_t k, std::int64_t column, std::uint32_t most) noexcept {
  const passes::ColumnBlocks blocks{static_cast<double>(column), grid_.pitch, grid_.base, widest_, jump_, kSlack * grid_.pitch};
  float* const height = height_ + (column - grid_.left);
  const std::size_t columns =
      kBlock * passes::sample_columns({s_ + k, w_ + k, samples_ + k}, blocks, most, height, source_ + (column - grid_.left));
  if (columns < std::size_t{most} * kBlock) std::fill_n(height + columns, kBlock, std::numeric_limits<float>::quiet_NaN());
  return static_cast<std::uint32_t>(columns);
}

void ColumnSampler::take(std::uint32_t k, std::int64_t column) noexcept {
  const double t = place(column) - s_[k], ds = s_[k + 1] - s_[k], dw = w_[k + 1] - w_[k];
  const std::uint32_t nearest = t < ds - t ? k : k + 1;
  source_[column - grid_.left] = samples_[nearest];
  if (ds > widest_) return;
  height_[column - grid_.left] = static_cast<float>((std::abs(dw) > jump_ ? w_[nearest] : w_[k] + dw * (t / ds)) - grid_.base);
}

void ColumnSampler::add_run(std::uint32_t begin, std::uint32_t end) noexcept {
  if (end - begin < 2) return;
  const auto last = static_cast<std::int64_t>(std::floor(s_[end - 1] / grid_.pitch));
  std::uint32_t k = begin, singly = 0; // columns to take before the next block is tried
  for (auto column = static_cast<std::int64_t>(std::ceil(s_[begin] / grid_.pitch)); column <= last;) {
    while (k + 2 < end && s_[k + 1] < place(column)) ++k;
    const auto blocks = static_cast<std::uint32_t>(std::min<std::int64_t>(end - 1 - k, last + 1 - column)) / kBlock;
    const std::uint32_t columns = singly == 0 && blocks > 0 ? take_blocks(k, column, blocks) : 0;
    if (columns > 0) {
      k += columns - 1;
      column += columns;
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
