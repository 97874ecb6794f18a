// scansion view: a picture of a recording from above.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/cli/streams.hpp"
#include "pipeline/picture/top_view.hpp"

#include <filesystem>
#include <memory>

namespace scansion::cli {
namespace {

struct Options {
  std::string recording, output, format, shade = "height";
  std::optional<std::uint32_t> level;
  int size = 1200;
  bool force = false;
};

Result<PictureFormat> format_of(const Options& o) {
  if (!o.format.empty()) return parse_picture_format(o.format);
  if (o.output == "-") return PictureFormat::png;
  const std::string ending = std::filesystem::path(o.output).extension().string();
  return parse_picture_format(ending.empty() ? std::string() : ending.substr(1));
}

Result<ViewContent> content_of(const Options& o, RecordingReader& reader) {
  const RecordingFacts& facts = reader.facts();
  ViewContent content;
  content.shade = o.shade == "patch" ? Shade::patch : Shade::height;
  content.level = o.level;
  content.caption = std::filesystem::path(o.recording).filename().string();
  if (o.level && *o.level >= facts.stored_levels)
    return fail(Errc::usage, "level ", std::to_string(*o.level), " is not stored; the recording has levels 0 to ",
                std::to_string(facts.stored_levels - 1));
  if (content.shade == Shade::patch && !facts.features)
    return fail(Errc::usage, o.recording, ": was made without patches; compress the scan again with --features on");
  if (!facts.features) return content;
  SCANSION_TRY(findings, read_findings(reader, content.shade == Shade::patch ? FindingsPart::all : FindingsPart::lines));
  content.findings = std::move(findings);
  return content;
}

Result<int> run_view(const Options& o) {
  SCANSION_TRY(format, format_of(o));
  SCANSION_TRY(spares_inputs(o.output, {o.recording}));
  SCANSION_TRY(recording, readable_recording(o.recording));
  SCANSION_TRY(reader, RecordingReader::open(recording));
  SCANSION_TRY(content, content_of(o, reader));
  ProgressLine line("view");
  SCANSION_TRY(drawing, draw_top_view(reader, content, o.size,
                                      [&](std::uint64_t done, std::uint64_t total) { line.show(done, total); }));
  SCANSION_TRY(file, OutputFile::create(o.output, o.force, false));
  SCANSION_TRY(format == PictureFormat::png ? write_png(drawing, file) : write_svg(drawing, file));
  SCANSION_TRY(file.commit());
  if (!reader.complete())
    say(o.recording + " is unfinished: what follows its last whole group is not in the picture; see scansion verify");
  return kDone;
}

} // namespace

Verb add_view(CLI::App& root) {
  auto* app = root.add_subcommand("view", "Draw a recording from above, with its feature lines");
  auto o = std::make_shared<Options>();
  app->add_option("recording", o->recording, "The recording")->required();
  app->add_option("-o,--output", o->output, "The picture; - is standard output")->required();
  app->add_option("--format", o->format, "png or svg; default: by the ending of the output");
  app->add_option("--shade", o->shade, "Colours by height or by patch")
      ->check(CLI::IsMember({"height", "patch"}))
      ->capture_default_str();
  app->add_option("--level", o->level, "Mark the points of this stored level; 0 is the coarsest");
  app->add_option("--size", o->size, "Pixels of the longer edge at most")
      ->check(CLI::Range(kLeastPicture, kLargestPicture))
      ->capture_default_str();
  app->add_flag("--force", o->force, "Replace an existing output");
  return {app, [o] { return run_view(*o); }};
}

} // namespace scansion::cli
