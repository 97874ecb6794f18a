// scansion compare: are two recordings the same, and if not, where do they begin to differ?
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/cli/line_cursor.hpp"
#include "daemon/cli/streams.hpp"
#include "pipeline/export/value_format.hpp"
#include "pipeline/record/findings.hpp"

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace scansion::cli {
namespace {

struct Options {
  std::string a, b, what = "all";
  double tolerance = 0.0;
  bool json = false;
};

/// What differs first, as text; empty: nothing.
using Difference = std::optional<std::string>;

class Comparison {
public:
  Comparison(const Options& options, const ValueFormat& a, const ValueFormat& b) : options_(options), a_(a), b_(b) {}

  Difference lines(const LineCursor& a, const LineCursor& b);
  std::uint64_t compared = 0; ///< lines
  double largest_mm = 0.0;    ///< difference of a coordinate that was accepted

private:
  Difference runs(const LineCursor& a, const LineCursor& b) const;
  Difference point(const DecodedGroup& a, std::uint32_t p, const DecodedGroup& b, std::uint32_t q);
  [[nodiscard]] bool wants(std::string_view what) const { return options_.what == "all" || options_.what == what; }

  const Options& options_;
  const ValueFormat& a_;
  const ValueFormat& b_;
};

Difference Comparison::point(const DecodedGroup& a, std::uint32_t p, const DecodedGroup& b, std::uint32_t q) {
  const bool known_a = a.width[p] != DecodedGroup::kUnknown;
  const bool known_b = b.width[q] != DecodedGroup::kUnknown;
  if (known_a != known_b) return known_a ? "is stored in the first recording only" : "is stored in the second recording only";
  if (!known_a) return {};
  if (wants("levels") && a.width[p] != b.width[q])
    return "has alpha-width " + std::to_string(a.width[p]) + " and " + std::to_string(b.width[q]);
  if (!wants("points")) return {};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double va = a_.value(axis, a.group.xyz[axis][p], ulp_of(a.group, axis, p));
    const double vb = b_.value(axis, b.group.xyz[axis][q], ulp_of(b.group, axis, q));
    const double difference = std::abs(va - vb);
    // Written so that a NaN counts as different.
    if (!(difference <= options_.tolerance))
      return std::string("has ") + "xyz"[axis] + " " + number(va) + " and " + number(vb) + " mm";
    largest_mm = std::max(largest_mm, difference);
  }
  return {};
}

Difference Comparison::runs(const LineCursor& a, const LineCursor& b) const {
  const auto of_a = a.decoded().group.runs_of(a.line());
  const auto of_b = b.decoded().group.runs_of(b.line());
  if (of_a.size() != of_b.size()) return "has " + std::to_string(of_a.size()) + " and " + std::to_string(of_b.size()) + " runs";
  for (std::size_t r = 0; r < of_a.size(); ++r) {
    if (of_a[r].count != of_b[r].count)
      return "has " + std::to_string(of_a[r].count) + " and " + std::to_string(of_b[r].count) + " points in run " +
             std::to_string(r);
    if (of_a[r].invalid_before != of_b[r].invalid_before)
      return "has different invalid samples before run " + std::to_string(r);
  }
  if (a.line().invalid_after != b.line().invalid_after) return "has different invalid samples at its end";
  return {};
}

Difference Comparison::lines(const LineCursor& a, const LineCursor& b) {
  ++compared;
  if (a.line().index != b.line().index)
    return "line " + std::to_string(a.line().index) + " stands where the other recording has line " +
           std::to_string(b.line().index);
  const std::string where = "line " + std::to_string(a.line().index);
  if (const Difference d = runs(a, b)) return where + " " + *d;
  const auto of_a = a.decoded().group.runs_of(a.line());
  const auto of_b = b.decoded().group.runs_of(b.line());
  for (std::size_t r = 0; r < of_a.size(); ++r)
    for (std::uint32_t i = 0; i < of_a[r].count; ++i)
      if (const Difference d = point(a.decoded(), of_a[r].first + i, b.decoded(), of_b[r].first + i))
        return where + " run " + std::to_string(r) + " point " + std::to_string(i) + " " + *d;
  return {};
}

/// Where the two say something else about feature lines or patches.
Difference findings_differ(const Findings& a, const Findings& b, double tolerance) {
  const auto count = [](std::size_t x, std::size_t y, const char* what) {
    return "the recordings have " + std::to_string(x) + " and " + std::to_string(y) + " " + what;
  };
  if (a.lines.size() != b.lines.size()) return count(a.lines.size(), b.lines.size(), "feature lines");
  for (std::size_t k = 0; k < a.lines.size(); ++k) {
    const FeatureLine& p = a.lines[k];
    const FeatureLine& q = b.lines[k];
    const std::string where = "feature line " + std::to_string(p.id);
    if (p.id != q.id || p.type != q.type) return where + " has another id or type";
    if (p.vertices.size() != q.vertices.size())
      return where + " has " + std::to_string(p.vertices.size()) + " and " + std::to_string(q.vertices.size()) + " vertices";
    for (std::size_t v = 0; v < p.vertices.size(); ++v) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(std::abs(p.vertices[v].position[axis] - q.vertices[v].position[axis]) <= tolerance))
          return where + " vertex " + std::to_string(v) + " lies elsewhere";
      }
    }
  }
  if (a.patches.size() != b.patches.size()) return count(a.patches.size(), b.patches.size(), "patches");
  if (a.runs != b.runs) return "samples lie on other patches";
  if (a.forms != b.forms) return "the recordings name other form features";
  return {};
}

Result<Difference> first_difference(const Options& o, RecordingReader& a, RecordingReader& b, Comparison& comparison) {
  if ((o.what == "all" || o.what == "levels") && a.facts().level_count != b.facts().level_count)
    return Difference("the recordings have " + std::to_string(a.facts().level_count) + " and " +
                      std::to_string(b.facts().level_count) + " tolerances");
  LineCursor of_a(a);
  LineCursor of_b(b);
  while (true) {
    SCANSION_TRY(more_a, of_a.next());
    SCANSION_TRY(more_b, of_b.next());
    if (!more_a && !more_b) break;
    if (more_a != more_b)
      return Difference("the " + std::string(more_a ? "second" : "first") + " recording ends before line " +
                        std::to_string((more_a ? of_a : of_b).line().index));
    if (Difference d = comparison.lines(of_a, of_b)) return d;
  }
  if (o.what == "features" || (o.what == "all" && a.facts().features && b.facts().features)) {
    SCANSION_TRY(found_a, read_findings(a));
    SCANSION_TRY(found_b, read_findings(b));
    return findings_differ(found_a, found_b, o.tolerance);
  }
  return Difference();
}

Result<int> run_compare(const Options& o) {
  SCANSION_TRY(path_a, readable_recording(o.a));
  SCANSION_TRY(path_b, readable_recording(o.b));
  SCANSION_TRY(a, RecordingReader::open(path_a));
  SCANSION_TRY(b, RecordingReader::open(path_b));
  SCANSION_TRY(values_a, ValueFormat::make(a.facts().lattice, Unit::mm, false));
  SCANSION_TRY(values_b, ValueFormat::make(b.facts().lattice, Unit::mm, false));
  Comparison comparison(o, values_a, values_b);
  SCANSION_TRY(difference, first_difference(o, a, b, comparison));
  if (o.json) {
    const nlohmann::ordered_json out = {
        {"same", !difference},
        {"lines_compared", comparison.compared},
        {"largest_accepted_mm", comparison.largest_mm},
        {"difference", difference ? nlohmann::ordered_json(*difference) : nlohmann::ordered_json()}};
    std::printf("%s\n", out.dump(2).c_str());
  } else if (difference) {
    std::printf("different: %s\n", difference->c_str());
  } else {
    std::printf("same: %llu lines\n", static_cast<unsigned long long>(comparison.compared));
  }
  return difference ? kBadAnswer : kDone;
}

} // namespace

Verb add_compare(CLI::App& root) {
  auto* app = root.add_subcommand("compare", "Compare two recordings; exit 0 same, 1 different");
  auto o = std::make_shared<Options>();
  app->add_option("a", o->a, "A recording")->required();
  app->add_option("b", o->b, "Another one")->required();
  app->add_option("--tolerance", o->tolerance, "Accept coordinates that differ by up to this many mm")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app->add_option("--what", o->what, "points: coordinates; levels: alpha-widths; features; all")
      ->check(CLI::IsMember({"points", "levels", "features", "all"}))
      ->capture_default_str();
  app->add_flag("--json", o->json, "Print JSON");
  return {app, [o] { return run_compare(*o); }};
}

} // namespace scansion::cli
