// The one place where the benchmarks touch the project's codec and pipeline.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/our_codec.hpp"

#include "pipeline/record/writer.hpp"
#include "tests/bench/scratch.hpp"

namespace scansion::bench {

Result<OurCodec> OurCodec::make(const LineSet& set, const LevelSpec& levels) {
  OurCodec codec;
  codec.groups_ = groups_of(set);
  Ranker ranker(set.resolution_mm);
  Calibrator calibrator(levels);
  for (const LineGroup& group : codec.groups_) {
    GroupRanks& ranks = codec.ranks_.emplace_back();
    rank_group(ranker, group, ranks);
    const AlphaSet& alpha = codec.alphas_.emplace_back(calibrator.next(group, ranks, set.resolution_mm));
    codec.encoder_.encode(group, ranks, alpha, 1, codec.encoded_.emplace_back());
  }
  for (std::size_t g = 0; g < codec.groups_.size(); ++g) {
    SCANSION_TRY(codec.decode_group(g));
    if (codec.back_.group.xyz != codec.groups_[g].xyz || codec.back_.group.ulp != codec.groups_[g].ulp)
      return fail(Errc::bug, set.name, ": group ", std::to_string(g), " does not come back as it was");
  }
  return codec;
}

void OurCodec::encode() {
  for (std::size_t g = 0; g < groups_.size(); ++g) encoder_.encode(groups_[g], ranks_[g], alphas_[g], 1, out_);
}

Result<void> OurCodec::decode_group(std::size_t group) {
  const std::vector<Bytes>& payloads = encoded_[group].payloads;
  SCANSION_TRY(decoder_.begin(payloads[0], back_));
  for (std::size_t k = 1; k < payloads.size(); ++k) {
    SCANSION_TRY(decoder_.add(payloads[k], back_));
  }
  return success();
}

void OurCodec::decode() {
  // make() has seen every group come back whole.
  for (std::size_t g = 0; g < groups_.size(); ++g) static_cast<void>(decode_group(g));
}

void OurPipeline::run() {
  for (const LineBuffer& line : set_.lines) {
    if (builder_.must_close_before(line)) close();
    builder_.add(line);
  }
  if (!builder_.empty()) close();
}

void OurPipeline::close() {
  builder_.take(group_);
  pipeline_.process(group_, encoded_);
  payloads_.assign(encoded_.payloads.begin(), encoded_.payloads.end());
  block_.build_group(encoded_.number, encoded_.first_time_ns, payloads_);
}

Result<OurSize> our_size(const LineSet& set, const OurCodec& codec, const LevelSpec& levels) {
  RecordingFacts facts;
  facts.stream = 1;
  facts.lattice = set.lattice;
  facts.levels = levels;
  facts.level_count = levels.count;
  facts.stored_levels = levels.count + 1;
  const ScratchFolder folder;
  OurSize size;
  SCANSION_TRY(writer, RecordingWriter::create(folder.file("size.mcap"), facts, ChunkRule::many_groups));
  for (std::size_t g = 0; g < codec.groups().size(); ++g) {
    const EncodedGroup& encoded = codec.encoded()[g];
    SCANSION_TRY(writer.append(encoded, codec.groups()[g].points(), codec.groups()[g].runs.size(), 0));
    size.bytes.resize(encoded.payloads.size());
    size.points.resize(encoded.payloads.size());
    for (std::size_t k = 0; k < encoded.payloads.size(); ++k) {
      SCANSION_TRY(header, parse_payload_header(encoded.payloads[k]));
      size.bytes[k] += encoded.payloads[k].size();
      size.points[k] += k == 0 ? 0 : header.points;
      size.payloads += encoded.payloads[k].size();
      size.headers += header_size(header);
    }
  }
  SCANSION_TRY(writer.finish(std::nullopt, 0.0));
  size.file = writer.bytes();
  if (!codec.groups().empty()) size.tolerances = codec.alpha(0).tolerances;
  return size;
}

} // namespace scansion::bench
