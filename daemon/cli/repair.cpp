// scansion verify, scansion recover: the truth about a recording, and what can be brought back.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/repair.hpp"

#include "daemon/cli/command.hpp"
#include "daemon/cli/streams.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace scansion::cli {
namespace {

struct Options {
  std::string recording, output;
  bool json = false, force = false;
};

nlohmann::ordered_json to_json(const std::vector<LineRange>& lost) {
  auto out = nlohmann::ordered_json::array();
  for (const auto& [first, last] : lost) out.push_back({first, last});
  return out;
}

Result<int> run_verify(const Options& o) {
  SCANSION_TRY(recording, readable_recording(o.recording));
  SCANSION_TRY(r, verify(recording));
  if (o.json) {
    auto findings = nlohmann::ordered_json::array();
    for (const Finding& f : r.findings) findings.push_back({{"offset", f.offset}, {"what", f.what}});
    const nlohmann::ordered_json out = {
        {"sound", r.sound},           {"finished", r.finished},  {"groups", r.groups},
        {"lines", r.lines},           {"points", r.points},      {"gaps", r.gaps},
        {"good_bytes", r.good_bytes}, {"lost", to_json(r.lost)}, {"finding_count", r.finding_count},
        {"findings", findings}};
    std::printf("%s\n", out.dump(2).c_str());
    return r.sound ? kDone : kBadAnswer;
  }
  const std::string counts =
      std::to_string(r.groups) + " groups, " + std::to_string(r.lines) + " lines, " + std::to_string(r.points) + " points";
  std::printf("%s: %s: %s\n", o.recording.c_str(),
              r.sound               ? "sound"
              : r.finding_count > 0 ? "DAMAGED"
                                    : "unfinished",
              counts.c_str());
  for (const Finding& f : r.findings)
    std::printf("  byte %llu: %s\n", static_cast<unsigned long long>(f.offset), f.what.c_str());
  if (r.finding_count > r.findings.size())
    std::printf("  and %llu more\n", static_cast<unsigned long long>(r.finding_count - r.findings.size()));
  if (!r.lost.empty()) std::printf("  lines missing or damaged: %s\n", ranges(r.lost).c_str());
  if (!r.sound) std::printf("  bring back what is whole with: scansion recover %s -o OUT.mcap\n", o.recording.c_str());
  return r.sound ? kDone : kBadAnswer;
}

Result<int> run_recover(const Options& o) {
  SCANSION_TRY(json_has_room(o.json, o.output));
  SCANSION_TRY(spares_inputs(o.output, {o.recording}));
  SCANSION_TRY(pending, RecordingOutput::create(o.output, o.force));
  SCANSION_TRY(recording, readable_recording(o.recording));
  SCANSION_TRY(r, recover(recording, pending.name()));
  SCANSION_TRY(pending.commit());
  if (o.json) {
    const nlohmann::ordered_json out = {{"groups", r.groups},         {"lines", r.lines},
                                        {"points", r.points},         {"bytes_skipped", r.bytes_skipped},
                                        {"lost", to_json(r.lost)},    {"tail_lost", r.tail_lost},
                                        {"notes_lost", r.notes_lost}, {"anything_lost", r.anything_lost()}};
    std::printf("%s\n", out.dump(2).c_str());
  } else {
    std::FILE* const out = pending.to_stdout() ? stderr : stdout;
    std::fprintf(out, "%s: %llu groups, %llu lines, %llu points brought back; the output is verified\n",
                 pending.to_stdout() ? "standard output" : o.output.c_str(), static_cast<unsigned long long>(r.groups),
                 static_cast<unsigned long long>(r.lines), static_cast<unsigned long long>(r.points));
    if (r.bytes_skipped > 0)
      std::fprintf(out, "  %llu bytes could not be used\n", static_cast<unsigned long long>(r.bytes_skipped));
    if (!r.lost.empty()) std::fprintf(out, "  lines lost: %s\n", ranges(r.lost).c_str());
    if (r.notes_lost && r.lost.empty() && !r.tail_lost)
      std::fprintf(out, "  no line is lost, but what was said about feature lines, patches or gaps is not complete\n");
    if (r.tail_lost) std::fprintf(out, "  lines after the last whole group are lost; their number cannot be known\n");
  }
  return r.anything_lost() ? kBadAnswer : kDone;
}

} // namespace

Verb add_verify(CLI::App& root) {
  auto* app = root.add_subcommand("verify", "Check every byte of a recording; exit 1 unless it is sound and finished");
  auto o = std::make_shared<Options>();
  app->add_option("recording", o->recording, "The recording")->required();
  app->add_flag("--json", o->json, "Print JSON");
  return {app, [o] { return run_verify(*o); }};
}

Verb add_recover(CLI::App& root) {
  auto* app =
      root.add_subcommand("recover", "Bring back every whole group of a damaged recording; exit 1 if anything was lost");
  auto o = std::make_shared<Options>();
  app->add_option("recording", o->recording, "The damaged recording; it is not changed")->required();
  app->add_option("-o,--output", o->output, "The new recording")->required();
  app->add_flag("--force", o->force, "Replace an existing output");
  app->add_flag("--json", o->json, "Print JSON");
  return {app, [o] { return run_recover(*o); }};
}

} // namespace scansion::cli
