// A recording cut to its coarser levels: messages are copied, no payload byte changes.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/find_facts.hpp"
#include "pipeline/record/new_recording.hpp"
#include "pipeline/record/repair_steps.hpp"
#include "pipeline/record/walk.hpp"

namespace scansion {
namespace {

class Cutter final : public WalkVisitor {
public:
  Cutter(const std::string& input, Appender& output, const GroupInspector& count_lines)
      : input_(input), output_(output), count_lines_(count_lines) {}

  Result<void> on_group(const FoundGroup& group) override {
    if (!group.framed) return success(); // the damage it stands in is told next
    SCANSION_TRY(counts, count_lines_(group.payloads.first(1)));
    return output_.append_group(group.payloads.first(payloads_per_group(output_.facts())), group.lines.points, counts);
  }
  Result<void> on_gap(const Gap& gap, const ChunkEntry& entry) override { return output_.append_gap(gap, entry.time); }
  Result<void> on_note(const ChunkEntry& entry, ByteView text) override {
    return output_.append_note(entry.kind, text, entry.time);
  }
  Result<void> on_damage(const Damage& damage) override {
    return fail(Errc::damaged, input_, ": byte ", std::to_string(damage.at), ": ", damage.what,
                "; finish or recover the recording before it is cut to a level");
  }

private:
  const std::string& input_;
  Appender& output_;
  const GroupInspector& count_lines_;
};

} // namespace

Result<void> cut_to_level_with(const std::string& input, std::uint32_t level, const std::string& output,
                               const GroupInspector& count_lines) {
  SCANSION_TRY(file, File::open_read(input));
  SCANSION_TRY(size, file.size());
  Window window(file, size);
  SCANSION_TRY(head, read_head(window));
  if (level >= head.facts.stored_levels)
    return fail(Errc::usage, input, ": has no level ", std::to_string(level), "; its finest is ",
                std::to_string(head.facts.stored_levels - 1));
  RecordingFacts facts = head.facts;
  facts.stored_levels = level + 1;
  SCANSION_TRY(recording, NewRecording::create(output, facts));
  Cutter cutter(input, recording.appender(), count_lines);
  SCANSION_TRY(end, walk(window, head.facts, head.size, cutter));
  SCANSION_TRY(recording.appender().finish(end.end ? end.end->ended_ns : std::nullopt,
                                           end.end ? end.end->rounding_mm : facts.rounding_mm));
  return recording.commit();
}

} // namespace scansion
