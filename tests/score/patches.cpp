// How well found patches and forms agree with the true ones.
// SPDX-License-Identifier: Apache-2.0
#include "tests/score/score.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>

namespace scansion::score {
namespace {

double pairs(double n) noexcept {
  return 0.5 * n * (n - 1.0);
}

std::vector<std::uint32_t> true_labels(const Truth& truth) {
  std::vector<std::uint32_t> labels;
  for (const auto& line : truth.lines) {
    for (const TrueRun& run : line) labels.insert(labels.end(), run.count, run.patch);
  }
  return labels;
}

/// Points that the other side has too many or too few are as good as unlabelled.
std::vector<std::uint32_t> found_labels(const Truth& truth, const Found& found) {
  std::vector<std::uint32_t> labels;
  for (std::size_t k = 0; k < truth.lines.size(); ++k) {
    std::size_t size = 0;
    for (const TrueRun& run : truth.lines[k]) size += run.count;
    const std::size_t begin = labels.size();
    if (k < found.patches.size()) labels.insert(labels.end(), found.patches[k].begin(), found.patches[k].end());
    labels.resize(begin + size, kNoPatch);
  }
  return labels;
}

/// A form counts as named when a form of its kind holds the found patch that covers most of its largest own patch.
void judge_forms(const Truth& truth, const Found& found, const std::vector<std::uint32_t>& a,
                 const std::vector<std::uint32_t>& b, Score& score) {
  std::vector<std::map<std::uint32_t, std::size_t>> covers(truth.patches.size());
  for (std::size_t k = 0; k < a.size(); ++k) ++covers[a[k]][b[k]];
  const auto cover = [&](std::uint32_t patch) {
    const auto& counts = covers[patch];
    const auto most = std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; });
    return most == counts.end() ? kNoPatch : most->first;
  };
  for (const TrueForm& form : truth.forms) {
    std::uint32_t main = form.patches.front();
    const auto own = [&](std::uint32_t patch) { return form.kind == FormKind::step || truth.patches[patch].kind == form.kind; };
    for (const std::uint32_t patch : form.patches) {
      const bool better = own(patch) != own(main) ? own(patch) : truth.patches[patch].samples > truth.patches[main].samples;
      if (better) main = patch;
    }
    ++score.forms;
    const std::uint32_t id = cover(main);
    score.forms_named += std::ranges::any_of(found.forms, [&](const Form& other) {
      return other.kind == form.kind && std::ranges::find(other.patches, id) != other.patches.end();
    });
  }
}

} // namespace

double adjusted_rand_index(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::unordered_map<std::uint64_t, std::uint64_t> both;
  std::unordered_map<std::uint32_t, std::uint64_t> in_a;
  std::unordered_map<std::uint32_t, std::uint64_t> in_b;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ++both[std::uint64_t{a[k]} << 32U | b[k]];
    ++in_a[a[k]];
    ++in_b[b[k]];
  }
  const auto sum = [](const auto& counts) {
    double total = 0.0;
    for (const auto& [key, count] : counts) total += pairs(static_cast<double>(count));
    return total;
  };
  const double index = sum(both);
  const double rows = sum(in_a);
  const double columns = sum(in_b);
  const double all = pairs(static_cast<double>(a.size()));
  const double expected = all > 0.0 ? rows * columns / all : 0.0;
  const double most = 0.5 * (rows + columns);
  return most - expected == 0.0 ? 1.0 : (index - expected) / (most - expected); // both one patch, or each sample its own
}

void judge_patches(const Truth& truth, const Found& found, Score& score) {
  if (found.patches.empty()) return;
  const auto a = true_labels(truth);
  const auto b = found_labels(truth, found);
  score.has_patches = true;
  score.rand_index = adjusted_rand_index(a, b);
  judge_forms(truth, found, a, b, score);
}

} // namespace scansion::score
