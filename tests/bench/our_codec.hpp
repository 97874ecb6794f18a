// The one place where the benchmarks touch the project's codec and pipeline.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/pipeline.hpp"
#include "pipeline/record/layout.hpp"
#include "tests/bench/lines.hpp"

#include <cstdint>
#include <vector>

namespace scansion::bench {

/// A set, grouped, ranked and encoded before the clock runs. Thread-bound.
class OurCodec {
public:
  /// Fails when what comes back is not what went in.
  [[nodiscard]] static Result<OurCodec> make(const LineSet& set, const LevelSpec& levels);

  /// Whole groups to payloads; distances and tolerances are there already.
  void encode();
  /// All payloads to whole groups, checksums included.
  void decode();

  [[nodiscard]] const std::vector<LineGroup>& groups() const noexcept { return groups_; }
  [[nodiscard]] const std::vector<GroupRanks>& ranks() const noexcept { return ranks_; }
  [[nodiscard]] const std::vector<EncodedGroup>& encoded() const noexcept { return encoded_; }
  [[nodiscard]] const AlphaSet& alpha(std::size_t group) const noexcept { return alphas_[group]; }

private:
  OurCodec() = default;
  [[nodiscard]] Result<void> decode_group(std::size_t group);

  std::vector<LineGroup> groups_;
  std::vector<GroupRanks> ranks_;
  std::vector<AlphaSet> alphas_;
  std::vector<EncodedGroup> encoded_;
  GroupEncoder encoder_;
  GroupDecoder decoder_;
  EncodedGroup out_;
  DecodedGroup back_;
};

/// Lines in, checksummed groups ready to write out: grouping, ranking, calibration, encoding, the chunk around it.
class OurPipeline {
public:
  OurPipeline(const LineSet& set, const LevelSpec& levels) : set_(set), pipeline_(levels, set.resolution_mm, 1) {}
  void run();

private:
  void close();

  const LineSet& set_;
  Pipeline pipeline_;
  GroupBuilder builder_;
  LineGroup group_;
  EncodedGroup encoded_;
  std::vector<ByteView> payloads_;
  Block block_;
};

/// What a recording of a set costs.
struct OurSize {
  std::uint64_t file = 0;            ///< bytes of the whole recording
  std::uint64_t payloads = 0;        ///< bytes of all payloads, their headers included
  std::uint64_t headers = 0;         ///< bytes of the payload headers
  std::vector<std::uint64_t> bytes;  ///< of payloads: line tables, lod0 .. rest
  std::vector<std::uint64_t> points; ///< in them (line tables: 0)
  std::vector<double> tolerances;    ///< mm, of the first group
};
[[nodiscard]] Result<OurSize> our_size(const LineSet& set, const OurCodec& codec, const LevelSpec& levels);

} // namespace scansion::bench
