// Between the samples beside each column: many columns at once where samples stand as densely as columns, one by one elsewhere.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/crosswise/column_samples.hpp"

#include "pipeline/feature/passes/column_passes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr std::uint32_t kBlock = passes::ColumnRun::kBlock;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

class ColumnSampler {
public:
  ColumnSampler(const Profile& profile, const Sampling& sampling, const ColumnSpan& columns, float* height,
                std::uint32_t* source) noexcept
      : profile_(profile), s_(profile.s.data()), columns_(columns), pitch_(profile.scale.pitch),
        origin_(profile.s.front() * (1.0 / pitch_)), height_(height), source_(source), widest_(3.5 * sampling.pitch),
        jump_(std::max(6.0 * sampling.noise, 1.5 * sampling.pitch)) {}

  /// Samples [begin, end) of the profile; runs come in order.
  void add_run(std::uint32_t begin, std::uint32_t end) noexcept;
  void finish() noexcept { leave_out(columns_.left + static_cast<std::int64_t>(columns_.width)); }

private:
  [[nodiscard]] double place(std::int64_t column) const noexcept { return static_cast<double>(column) * pitch_; }
  [[nodiscard]] std::uint32_t take_blocks(std::uint32_t k, std::int64_t column, std::uint32_t most) noexcept;
  void take(std::uint32_t k, std::int64_t column) noexcept;
  void leave_out(std::int64_t column) noexcept;

  const Profile& profile_;
  const double* const s_;
  const ColumnSpan columns_;
  const double pitch_, origin_; // mm; place of the first sample in pitches
  float* const height_;
  std::uint32_t* const source_; // samples of the profile
  const double widest_, jump_;  // mm: between samples, up
  std::size_t next_ = 0;        // column that has not been written to, from the left
};

// Takes blocks of columns as long as samples stand beside them one by one, and none of them at a wall. Returns how many
// columns these are.
std::uint32_t ColumnSampler::take_blocks(std::uint32_t k, std::int64_t column, std::uint32_t most) noexcept {
  constexpr float kSlack = 0.05F; // of a pitch: samples often stand on columns but for their rounding
  passes::ColumnRun run;
  run.shift = profile_.shift.data() + k;
  run.height = profile_.height.data() + k;
  run.ahead = static_cast<float>(static_cast<double>(column) - origin_ - k);
  run.slack = kSlack;
  run.widest = static_cast<float>(widest_ / pitch_);
  run.jump = static_cast<float>(jump_);
  const std::int64_t at = column - columns_.left;
  return static_cast<std::uint32_t>(kBlock * passes::sample_columns(run, k, most, height_ + at, source_ + at));
}

void ColumnSampler::take(std::uint32_t k, std::int64_t column) noexcept {
  const std::int64_t at = column - columns_.left;
  const double t = place(column) - s_[k], ds = s_[k + 1] - s_[k];
  const std::uint32_t nearest = t < ds - t ? k : k + 1;
  const float rise = profile_.height[k + 1] - profile_.height[k];
  const bool wall = static_cast<double>(std::abs(rise)) > jump_;
  source_[at] = nearest;
  height_[at] = ds > widest_ ? kNone : wall ? profile_.height[nearest] : profile_.height[k] + rise * static_cast<float>(t / ds);
}

// All before this column that no run reaches.
void ColumnSampler::leave_out(std::int64_t column) noexcept {
  const auto to = static_cast<std::size_t>(column - columns_.left);
  if (to <= next_) return;
  std::fill(height_ + next_, height_ + to, kNone);
  std::fill(source_ + next_, source_ + to, 0U);
  next_ = to;
}

void ColumnSampler::add_run(std::uint32_t begin, std::uint32_t end) noexcept {
  if (end - begin < 2) return;
  const auto last = static_cast<std::int64_t>(std::floor(s_[end - 1] / pitch_));
  auto column = static_cast<std::int64_t>(std::ceil(s_[begin] / pitch_));
  if (column > last) return;
  leave_out(column);
  next_ = static_cast<std::size_t>(last + 1 - columns_.left);
  for (std::uint32_t k = begin, singly = 0; column <= last;) { // singly: columns to take before the next block is tried
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

void sample_columns(const Profile& profile, const Sampling& sampling, const ColumnSpan& columns, float* height,
                    std::uint32_t* source) {
  ColumnSampler sampler(profile, sampling, columns, height, source);
  std::uint32_t begin = 0;
  for (const std::uint32_t end : profile.ends) {
    sampler.add_run(begin, end);
    begin = end;
  }
  sampler.finish();
  if (profile.source.empty()) return;
  for (std::size_t j = 0; j < columns.width; ++j) source[j] = profile.source[source[j]];
}

} // namespace scansion
