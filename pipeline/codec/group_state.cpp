// Shared state of encoder and decoder.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/group_state.hpp"

#include "pipeline/codec/kernels.hpp"

#include <algorithm>

namespace scansion {
namespace {

void places_of(std::span<const Run> runs, std::vector<RunPlace>& out) {
  out.clear();
  std::int64_t sample = 0;
  for (const Run& run : runs) {
    sample += run.invalid_before;
    out.push_back({&run, sample});
    sample += run.count;
  }
}

std::int64_t shift_between(const RunPlace& here, const RunPlace& above, const AxisScales& scales,
                           const GroupState& state) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!scales[axis].even || scales[axis].ruled) continue;
    const auto& u = state.u[axis];
    const std::int64_t step = even_step(*here.run, u);
    if (step == 0 || step != even_step(*above.run, u)) continue;
    const std::int64_t offset = std::int64_t{u[here.run->first]} - u[above.run->first];
    return nearest_steps(offset, step) + above.run->first - here.run->first;
  }
  return here.first_sample - above.first_sample + above.run->first - here.run->first;
}

} // namespace

void GroupState::begin_level() {
  vertices.clear();
  added.clear();
  run_vertices.assign(1, 0);
}

void GroupState::end_run(const Run& run, std::size_t& f, std::size_t& k) {
  const PointIndex end = run.first + run.count;
  std::size_t fresh_end = f;
  std::size_t known_end = k;
  while (fresh_end < fresh.size() && fresh[fresh_end].point < end) ++fresh_end;
  while (known_end < known.size() && known[known_end] < end) ++known_end;
  std::size_t v = vertices.size();
  vertices.resize(v + (fresh_end - f) + (known_end - k));
  added.resize(vertices.size());
  // Which of the two comes next nobody can tell, so there is no branch on it.
  while (f < fresh_end && k < known_end) {
    const PointIndex here = fresh[f].point;
    const bool is_fresh = here < known[k];
    vertices[v] = is_fresh ? here : known[k];
    added[v++] = is_fresh ? 1 : 0;
    f += is_fresh ? 1 : 0;
    k += is_fresh ? 0 : 1;
  }
  for (; f < fresh_end; ++v) {
    vertices[v] = fresh[f++].point;
    added[v] = 1;
  }
  for (; k < known_end; ++v) {
    vertices[v] = known[k++];
    added[v] = 0;
  }
  run_vertices.push_back(static_cast<std::uint32_t>(v));
}

void GroupState::pass_level(std::span<const Run> runs) {
  fresh.clear();
  begin_level();
  std::size_t f = 0;
  std::size_t k = 0;
  for (const Run& run : runs) end_run(run, f, k);
}

void align_runs(const LineGroup& group, const AxisScales& scales, GroupState& state) {
  std::vector<RunPlace>& here = state.places_here;
  std::vector<RunPlace>& above = state.places_above;
  above.clear();
  std::uint32_t above_run = 0;
  state.above.assign(group.runs.size(), {});
  for (const ScanLine& line : group.lines) {
    if (line.run_count == 0) continue;
    places_of(group.runs_of(line), here);
    std::size_t a = 0;
    for (std::size_t r = 0; r < here.size() && !above.empty(); ++r) {
      const std::int64_t middle = here[r].first_sample + here[r].run->count / 2;
      while (a + 1 < above.size() && above[a].first_sample + above[a].run->count <= middle) ++a;
      const Run& run = *above[a].run;
      state.above[line.first_run + r] = {above_run + static_cast<std::uint32_t>(a), run.first, run.first + run.count - 1,
                                         shift_between(here[r], above[a], scales, state), true};
      const RunAbove& at = state.above[line.first_run + r];
      for (const PointIndex i : {here[r].run->first, here[r].run->first + here[r].run->count - 1})
        state.beside[i] = at.beside(i);
    }
    above.swap(here);
    above_run = line.first_run;
  }
}

void fill_even(std::span<const Run> runs, std::span<std::int32_t> u) noexcept {
  for (const Run& run : runs) {
    const auto step = static_cast<std::uint32_t>(static_cast<std::uint64_t>(even_step(run, u)));
    const auto first = static_cast<std::uint32_t>(u[run.first]);
    // The last point stays: where hostile ends are not a whole number of steps apart, it is no sum of steps.
    if (run.count > 2) kernels::ramp(first, step, u.data() + run.first, run.count - 1);
  }
}

} // namespace scansion
