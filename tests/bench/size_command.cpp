// scansion_bench size: bits per point of recordings and of other ways to store the same points.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/commands.hpp"
#include "tests/bench/our_codec.hpp"
#include "tests/bench/packers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace scansion::bench {
namespace {

constexpr Bar kPlanes{0.88, 0.82};
constexpr Bar kPlanesAnySet{1.15, 1.05};
constexpr Bar kJpegXl{1.06, 1.00};
constexpr Bar kAboveFloor{0.20, 0.12};
constexpr Bar kProgressive{1.10, 1.05};
constexpr Bar kKeptPoint{11.5, 9.0};
constexpr Bar kKeptXz{0.927, 0.726}; // what the bars above are of the figure of xz that was measured with them, 12.4
constexpr Bar kContainer{0.015, 0.010};
constexpr double kNoise = 5.0;       // counts
constexpr double kKeptShare = 0.045; // of the points: the level that is compared with other programs
constexpr const char* kNoLaz = "not built: no package of Debian 12";

/// Entropy of normal noise in counts, bits.
double noise_floor(double sigma) {
  constexpr double kPi = 3.14159265358979323846;
  return std::log2(sigma * std::sqrt(2.0 * kPi * std::exp(1.0)));
}

double bits(std::uint64_t bytes, std::uint64_t points) {
  return 8.0 * static_cast<double>(bytes) / static_cast<double>(std::max<std::uint64_t>(points, 1));
}

std::string fixed(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", value);
  return text.data();
}

double quotient(std::uint64_t a, std::uint64_t b) {
  return static_cast<double>(a) / static_cast<double>(b);
}

/// The tolerance that keeps this share of all points, mm.
double tolerance_for(const OurCodec& codec, double share) {
  std::vector<double> all;
  for (const GroupRanks& ranks : codec.ranks()) all.insert(all.end(), ranks.distance.begin(), ranks.distance.end());
  const auto place = all.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(all.size()));
  std::nth_element(all.begin(), place, all.end(), std::greater<>());
  return std::isfinite(*place) ? *place : 0.0;
}

LevelSpec one_level(double tolerance_mm) {
  LevelSpec spec;
  spec.kind = LevelSpec::Kind::explicit_list;
  spec.count = 1;
  spec.explicit_tolerances = {tolerance_mm};
  return spec;
}

struct Measured {
  OurSize ours, plain_mode, kept; ///< three levels; end points alone; one level of kKeptShare
  bool has_kept = false;
  Packed planes, jpeg_xl, kept_xz;
};

class SizeTables {
public:
  explicit SizeTables(Report& report) : report_(report) {}
  Result<void> add(const LineSet& set);
  Result<void> add_ours_alone(const LineSet& set);
  void print();

private:
  void add_peers(const LineSet& set, const OurCodec& codec, Measured& m);
  void add_levels(const LineSet& set, const Measured& m);
  void add_targets(const LineSet& set, const Measured& m);
  void add_container(const std::string& name, const OurSize& ours);
  void judge(const std::string& what, double value, const Bar& bar);
  void skip(const std::string& what, const std::string& why) { targets_.add({what, why}); }

  Report& report_;
  Table peers_{
      "Bits per point, lossless",
      {"set", "lines", "points", "ours", "delta planes zstd -3", "xz -9", "zstd -19", "JPEG-LS", "JPEG XL -e 7", "AEC", "LAZ"},
      "ours: the whole recording with three levels. xz and zstd -19: of the shortest exact text. The others: groups of up "
      "to 64 lines, regular axes as first values and steps. None of them has levels."};
  Table levels_{
      "Levels of our recordings",
      {"set", "payload", "tolerance mm", "points", "share %", "bit per its point", "bit per point of the set", "read so far"},
      "4.5 %: a recording of its own with that one level."};
  Table targets_{"Sizes against their bars", {"what", "value", "must", "good", "mark"}};
};

Result<void> SizeTables::add(const LineSet& set) {
  std::fprintf(stderr, "scansion_bench: %s ...\n", set.name.c_str());
  Measured m;
  const LevelSpec levels;
  SCANSION_TRY(codec, OurCodec::make(set, levels));
  SCANSION_TRY(ours, our_size(set, codec, levels));
  m.ours = ours;
  const LevelSpec ends = one_level(1e9);
  SCANSION_TRY(plain_codec, OurCodec::make(set, ends));
  SCANSION_TRY(plain_mode, our_size(set, plain_codec, ends));
  m.plain_mode = plain_mode;
  if (const double tolerance = tolerance_for(codec, kKeptShare); tolerance > 0.0) {
    const LevelSpec one = one_level(tolerance);
    SCANSION_TRY(kept_codec, OurCodec::make(set, one));
    SCANSION_TRY(kept, our_size(set, kept_codec, one));
    m.kept = kept;
    m.has_kept = true;
    m.kept_xz = pack_kept_xz(kept_codec.groups(), kept_codec.ranks(), tolerance);
  }
  add_peers(set, codec, m);
  add_levels(set, m);
  add_targets(set, m);
  return success();
}

void SizeTables::add_peers(const LineSet& set, const OurCodec& codec, Measured& m) {
  std::vector<Cell> cells{set.name, Count{set.lines.size()}, Count{set.points}, Figure{bits(m.ours.file, set.points)}};
  const auto put = [&](const Packed& packed) {
    if (packed.skipped.empty()) {
      cells.emplace_back(Figure{bits(packed.bytes, set.points)});
    } else {
      cells.emplace_back(packed.skipped);
      std::fprintf(stderr, "scansion_bench: %s: a peer is skipped: %s\n", set.name.c_str(), packed.skipped.c_str());
    }
  };
  m.planes = pack_planes(codec.groups());
  m.jpeg_xl = pack_jpeg_xl(codec.groups());
  put(m.planes);
  const auto text = text_of(set);
  put(text ? pack_text_xz(text.value()) : Packed{0, "no text"});
  put(text ? pack_text_zstd(text.value()) : Packed{0, "no text"});
  put(pack_jpeg_ls(codec.groups()));
  put(m.jpeg_xl);
  put(pack_aec(codec.groups()));
  cells.emplace_back("not built");
  peers_.add(std::move(cells));
}

void SizeTables::add_levels(const LineSet& set, const Measured& m) {
  const auto total = static_cast<double>(set.points);
  std::uint64_t read = 0;
  const auto row = [&](const OurSize& size, std::size_t k, const std::string& name, bool sum) {
    if (sum) read += size.bytes[k];
    std::vector<Cell> cells{set.name, name};
    cells.emplace_back(k > 0 && k <= size.tolerances.size() ? Cell(Figure{size.tolerances[k - 1], 4}) : Cell());
    cells.emplace_back(k > 0 ? Cell(Count{size.points[k]}) : Cell());
    cells.emplace_back(k > 0 ? Cell(Figure{100.0 * static_cast<double>(size.points[k]) / total}) : Cell());
    cells.emplace_back(size.points[k] > 0 ? Cell(Figure{bits(size.bytes[k], size.points[k])}) : Cell());
    cells.emplace_back(Figure{bits(size.bytes[k], set.points), 3});
    cells.emplace_back(sum ? Cell(Figure{bits(read, set.points), 3}) : Cell());
    levels_.add(std::move(cells));
  };
  const std::size_t last = m.ours.bytes.size() - 1;
  row(m.ours, 0, "line tables", true);
  for (std::size_t k = 1; k < last; ++k) row(m.ours, k, "lod" + std::to_string(k - 1), true);
  row(m.ours, last, "rest", true);
  if (m.has_kept) row(m.kept, 1, "4.5 %", false);
}

void SizeTables::add_targets(const LineSet& set, const Measured& m) {
  const std::string name = set.name + ": ";
  // The bars were set on a part that is not ours; of ours ribs is packed by others as that one was.
  const bool part = set.path.empty() && (set.name == "part" || set.name == "ribs");
  const bool plane = set.path.empty() && set.name == "plane";
  judge(name + "ours / delta planes zstd -3", quotient(m.ours.file, m.planes.bytes), part ? kPlanes : kPlanesAnySet);
  if (part) {
    if (m.jpeg_xl.skipped.empty())
      judge(name + "ours / JPEG XL -e 7", quotient(m.ours.file, m.jpeg_xl.bytes), kJpegXl);
    else
      skip(name + "ours / JPEG XL -e 7", m.jpeg_xl.skipped);
    skip(name + "ours / LAZ", kNoLaz);
    judge(name + "three levels / end points alone as the only level", quotient(m.ours.file, m.plain_mode.file), kProgressive);
    if (m.has_kept)
      judge(name + "4.5 % level, bit per kept point (its payload)", bits(m.kept.bytes[1], m.kept.points[1]), kKeptPoint);
  }
  if (m.has_kept) {
    const std::string what = name + "4.5 % level / xz -9e of packed deltas";
    if (m.kept_xz.skipped.empty())
      judge(what + " (" + fixed(bits(m.kept_xz.bytes, m.kept.points[1])) + " bit per kept point)",
            quotient(m.kept.bytes[1], m.kept_xz.bytes), kKeptXz);
    else
      skip(what, m.kept_xz.skipped);
  }
  if (plane)
    judge(name + "bit per point above the noise floor of 4.37", bits(m.ours.file, set.points) - noise_floor(kNoise),
          kAboveFloor);
  add_container(name, m.ours);
}

void SizeTables::add_container(const std::string& name, const OurSize& ours) {
  judge(name + "container, share of the recording", quotient(ours.file - ours.payloads, ours.file), kContainer);
  targets_.add(
      {name + "container and payload headers", Figure{quotient(ours.file - ours.payloads + ours.headers, ours.file), 4}});
}

// A set for whose peers there is no time.
Result<void> SizeTables::add_ours_alone(const LineSet& set) {
  std::fprintf(stderr, "scansion_bench: %s, ours alone ...\n", set.name.c_str());
  const LevelSpec levels;
  SCANSION_TRY(codec, OurCodec::make(set, levels));
  SCANSION_TRY(ours, our_size(set, codec, levels));
  const std::string name = set.name + " (" + std::to_string(set.lines.size()) + " lines): ";
  targets_.add({name + "bit per point", Figure{bits(ours.file, set.points)}});
  add_container(name, ours);
  return success();
}

void SizeTables::judge(const std::string& what, double value, const Bar& bar) {
  std::vector<Cell> cells{what, Figure{value, value < 0.1 ? 4 : 3}};
  report_.judge(cells, value, bar);
  targets_.add(std::move(cells));
}

void SizeTables::print() {
  report_.print(peers_);
  report_.print(levels_);
  report_.print(targets_);
}

} // namespace

Result<void> run_size(const Options& options, Report& report) {
  SizeTables tables(report);
  for (const char* scene : {"part", "plane", "freeform", "steps", "pocket", "ribs"}) {
    SCANSION_TRY(set, scene_set(scene, 0, 0, kNoise));
    thin_out(set, options.lines, 0, kGroupLines);
    SCANSION_TRY(tables.add(set));
  }
  // A share of the container depends on the length of the recording.
  SCANSION_TRY(paper, scene_set("paper", 0, 0));
  thin_out(paper, options.lines, 0, kGroupLines);
  SCANSION_TRY(tables.add_ours_alone(paper));
  // One file after the other: a scan may be large.
  for (const std::string& file : options.files) {
    SCANSION_TRY(set, file_set(file));
    thin_out(set, options.lines, 0, kGroupLines);
    SCANSION_TRY(tables.add(set));
  }
  tables.print();
  return success();
}

} // namespace scansion::bench
