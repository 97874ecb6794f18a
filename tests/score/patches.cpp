// How well found patches and forms agree with the true ones.
// SPDX-License-Identifier: Apache-2.0
#include "tests/score/score.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
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

/// Samples that true and found patches share, as what each says of the other.
class Cover {
public:
  Cover(const std::vector<std::uint32_t>& truth, const std::vector<std::uint32_t>& found) {
    for (std::size_t k = 0; k < truth.size(); ++k) {
      if (found[k] == kNoPatch) continue;
      ++found_in_[truth[k]][found[k]];
      ++true_in_[found[k]][truth[k]];
    }
  }
  /// The found patch that covers most of a true one, and the other way round.
  [[nodiscard]] std::uint32_t found_at(std::uint32_t truth) const { return most(found_in_, truth); }
  [[nodiscard]] std::uint32_t true_at(std::uint32_t found) const { return most(true_in_, found); }

private:
  using Shared = std::unordered_map<std::uint32_t, std::map<std::uint32_t, std::size_t>>;
  [[nodiscard]] static std::uint32_t most(const Shared& shared, std::uint32_t patch) {
    const auto at = shared.find(patch);
    if (at == shared.end()) return kNoPatch;
    return std::ranges::max_element(at->second, {}, [](const auto& entry) { return entry.second; })->first;
  }
  Shared found_in_, true_in_;
};

bool holds(const std::vector<std::uint32_t>& patches, std::uint32_t patch) noexcept {
  return std::ranges::find(patches, patch) != patches.end();
}

bool is_own(const Truth& truth, const TrueForm& form, std::uint32_t patch) {
  return holds(form.patches, patch) && (form.kind == FormKind::step || truth.patches[patch].kind == form.kind);
}

double diameter(double area) noexcept {
  return 2.0 * std::sqrt(area / 3.141592653589793);
}

/// In its place and of its size, to the tolerance of curves.
bool is_hole(const Truth& truth, const TrueForm& form, const Form& said) {
  if (!form.hole || !said.hole) return false;
  const auto &at = form.hole->middle, &found = said.hole->middle;
  const double tolerance = 1.5 * std::max(truth.pitch_mm, truth.spacing_mm);
  return std::hypot(found[0] - at[0], found[1] - at[1], found[2] - at[2]) <= tolerance &&
         std::abs(said.hole->diameter_mm() - diameter(form.hole->area_mm2)) <= tolerance;
}

/// Is it such a form, there? Of a step both levels must be; of any other form a patch that lies mostly on a true patch of its
/// own kind.
bool is_right(const Truth& truth, const TrueForm& form, const Form& said, const Cover& cover) {
  if (said.kind != form.kind) return false;
  if (form.kind == FormKind::hole) return is_hole(truth, form, said);
  std::set<std::uint32_t> places;
  for (const std::uint32_t patch : said.patches) {
    const std::uint32_t place = cover.true_at(patch);
    if (place != kNoPatch && is_own(truth, form, place)) places.insert(place);
  }
  return places.size() >= (form.kind == FormKind::step ? 2U : 1U);
}

/// Does it name the form? It is right, and but for a step it holds the patch that covers most of the form's largest own patch.
bool names(const Truth& truth, const TrueForm& form, const Form& said, const Cover& cover) {
  if (!is_right(truth, form, said, cover)) return false;
  if (form.kind == FormKind::step || form.kind == FormKind::hole) return true;
  std::uint32_t main = form.patches.front();
  for (const std::uint32_t patch : form.patches) {
    const bool own = is_own(truth, form, patch), main_own = is_own(truth, form, main);
    if (own != main_own ? own : truth.patches[patch].samples > truth.patches[main].samples) main = patch;
  }
  const std::uint32_t id = cover.found_at(main);
  return holds(said.patches, id) && holds(form.patches, cover.true_at(id));
}

void judge_forms(const Truth& truth, const Found& found, const Cover& cover, FormCounts& counts) {
  for (const Form& said : found.forms) {
    FormCount& count = counts[static_cast<std::size_t>(said.kind)];
    ++count.said;
    count.right += std::ranges::any_of(truth.forms, [&](const TrueForm& form) { return is_right(truth, form, said, cover); });
  }
  for (const TrueForm& form : truth.forms) {
    FormCount& count = counts[static_cast<std::size_t>(form.kind)];
    ++count.there;
    count.named += std::ranges::any_of(found.forms, [&](const Form& said) { return names(truth, form, said, cover); });
  }
}

} // namespace

FormCount sum_of(const FormCounts& counts) noexcept {
  FormCount sum;
  for (const FormCount& count : counts) {
    sum.there += count.there;
    sum.named += count.named;
    sum.said += count.said;
    sum.right += count.right;
  }
  return sum;
}

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
  judge_forms(truth, found, Cover(a, b), score.forms);
}

} // namespace scansion::score
