// Residuals of the rest back to values, run by run in two steps: neither then has more to carry from point to point than
// processors have registers.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/rest_coder.hpp"

#include <utility>

namespace scansion {
namespace {

// The tables of small doubts without the way through logarithms, which the next residual but one would wait for.
class TableChoice {
public:
  explicit TableChoice(const SymbolReader::Cursor& cursor) noexcept {
    for (std::uint32_t doubt = 1; doubt < kSmall; ++doubt) tables_[doubt] = &cursor.table(rest_context(doubt));
  }
  [[nodiscard]] const RansDecodeTable& of(std::uint32_t doubt, const SymbolReader::Cursor& cursor) const noexcept {
    return doubt < kSmall ? *tables_[doubt] : cursor.table(rest_context(doubt));
  }

private:
  static constexpr std::uint32_t kSmall = 512;
  std::array<const RansDecodeTable*, kSmall> tables_{};
};

/// One run as both steps see it.
struct RunToTake {
  std::span<const PointIndex> vertices;
  std::span<const Chord> chords; ///< from each vertex but the last
  const std::int32_t* beside;    ///< sizes of the line before; null without one
  const std::int64_t* sum;       ///< what the line before adds
};

// Reads the residuals into the places of the values. Where kSize, `size` gets what the next line asks for.
template <bool kBeside, bool kSize>
void take_residuals(const RunToTake& run, std::int32_t* size, std::int32_t* u, const TableChoice& tables,
                    SymbolReader::Cursor& from) noexcept {
  SymbolReader::Cursor cursor = from;
  std::int32_t size1 = 0; // of the points to the left
  std::int32_t size2 = 0;
  std::int32_t size3 = 0;
  const auto move_on = [&](std::size_t i, std::int32_t now) {
    size3 = std::exchange(size2, std::exchange(size1, now));
    if constexpr (kSize) size[i] = now;
  };
  for (std::size_t v = 0; v < run.chords.size(); ++v) {
    std::size_t i = run.vertices[v];
    const std::size_t end = run.vertices[v + 1];
    move_on(i, size_of_rise(run.chords[v].rise()));
    std::int32_t near = size1; // a vertex speaks for the points before it, too
    std::int32_t far = size1;
    for (++i; i < end; ++i) {
      const std::uint32_t doubt = rest_doubt(near, far, kBeside ? run.beside[i] : 0, kBeside);
      const std::uint32_t folded = cursor.next<kLongStates>(tables.of(doubt, cursor));
      u[i] = unfold(folded);
      move_on(i, folded < kDirectTokens ? static_cast<std::int32_t>((folded + 1) / 2) : size_of_folded(folded));
      near = size2;
      far = size3;
    }
  }
  if constexpr (kSize) size[run.vertices.back()] = 0;
  cursor.hold();
  from = cursor;
}

// Adds to the residuals what is predicted. Where kAbove, `deviation` gets what the next line asks for.
template <bool kAbove>
void add_predictions(const RunToTake& run, const Weights& weights, std::int32_t* deviation, std::int32_t* u) noexcept {
  std::array<std::int64_t, kLineWeights> w; // as wide as the sums: nothing is widened point by point
  std::copy_n(weights.begin(), w.size(), w.begin());
  std::array<std::int64_t, kLeft> weighed{}; // what the points to the left add to the next, the one after it, ...
  const std::int64_t rounding = RunningMeans::rounding(weights);
  RunningMeans means;
  const auto move_on = [&](std::size_t i, std::int64_t now) {
    for (std::size_t k = 0; k + 1 < kLeft; ++k) weighed[k] = weighed[k + 1] + w[k] * now;
    weighed[kLeft - 1] = w[kLeft - 1] * now;
    if constexpr (kAbove) deviation[i] = static_cast<std::int32_t>(now);
  };
  for (std::size_t v = 0; v < run.chords.size(); ++v) {
    std::size_t i = run.vertices[v];
    const std::size_t end = run.vertices[v + 1];
    const std::int64_t step = run.chords[v].step;
    std::int64_t on_chord = std::int64_t{u[i]} * (std::int64_t{1} << Chord::kStepBits);
    move_on(i, 0);
    for (++i; i < end; ++i) {
      const std::int64_t others = (kAbove ? run.sum[i] : 0) + rounding + w[kLeft] * means.fast + w[kLeft + 1] * means.slow;
      const std::int32_t off = wrap(((others + weighed[0]) >> kWeightBits) + u[i]); // what is known last comes last
      on_chord += step;
      u[i] = wrap((on_chord >> Chord::kStepBits) + off);
      means.add(off);
      move_on(i, off);
    }
  }
  if constexpr (kAbove) deviation[run.vertices.back()] = 0;
}

// The vertices of the first of some runs, and the chords between them.
std::span<const PointIndex> first_run(std::span<const PointIndex> vertices, PointIndex last, std::span<const std::int32_t> u,
                                      std::vector<Chord>& chords) {
  chords.clear();
  for (; vertices[chords.size()] != last;) {
    const std::size_t v = chords.size();
    chords.emplace_back(u, vertices[v], vertices[v + 1]);
  }
  return vertices.first(chords.size() + 1);
}

} // namespace

void take_fitted(const LineGroup& group, std::span<const PointIndex> vertices, const Neighbours* neighbours,
                 const Weights& weights, std::span<std::int32_t> u, RestAxis& axis, SymbolReader& from) {
  SymbolReader::Cursor cursor = from.cursor();
  const TableChoice tables(cursor);
  std::size_t line = 0;
  RunToTake here{};
  for (const Run& run : group.runs) {
    if (neighbours != nullptr && line < neighbours->lines.size() && neighbours->lines[line].first == run.first) {
      const RestLine& at = neighbours->lines[line++];
      axis.weigh_above(at, *neighbours, u, weights);
      here.sum = axis.above_sum.data() - at.first;
      here.beside = at.has_above ? axis.above_size.data() - at.first : nullptr;
    }
    here.vertices = first_run(vertices, run.first + run.count - 1, u, axis.run_chords);
    here.chords = axis.run_chords;
    vertices = vertices.subspan(here.vertices.size());
    if (neighbours == nullptr) {
      take_residuals<false, false>(here, nullptr, u.data(), tables, cursor);
      add_predictions<false>(here, weights, nullptr, u.data());
      continue;
    }
    if (here.beside == nullptr)
      take_residuals<false, true>(here, axis.size.data(), u.data(), tables, cursor);
    else
      take_residuals<true, true>(here, axis.size.data(), u.data(), tables, cursor);
    add_predictions<true>(here, weights, axis.deviation.data(), u.data());
  }
  from.set(cursor);
}

} // namespace scansion
