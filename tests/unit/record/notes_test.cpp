// Messages about feature lines and patches: text and back, and in a recording through damage, cut and kill.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/notes.hpp"

#include "pipeline/record/findings.hpp"
#include "tests/unit/record/synthetic.hpp"

namespace scansion::synthetic {
namespace {

FeatureLine line_of(std::uint64_t id, std::int32_t piece, double x0, double x1) {
  FeatureLine line;
  line.id = id;
  line.piece = piece;
  line.type = FeatureType::step_bottom;
  line.level = 2;
  line.begins = FeatureEnd::border;
  line.ends = FeatureEnd::junction;
  line.vertices = {{{x0, 2.5, -1.0}, 7, 12}, {{x1, 2.5, -1.125}, 8, 13}};
  line.per_mm = 1000;
  line.length_mm = x1 - x0;
  line.scan_lines = 2;
  line.inner_angle = {151.5, 2.5};
  line.orientation = {-88.0, 0.5};
  line.turning = {28.5, 2.5};
  line.width = {3.5, 0.25};
  line.sharpness = 4.5;
  line.guided_share = 0.5;
  line.persistence = 1.5;
  line.across_mm = 0.125;
  line.elements[1] = 3;
  line.elements[16] = 9;
  line.partner = 41;
  line.junctions = {3, 5};
  return line;
}

FeatureReport full_report() {
  FeatureReport report;
  report.group = 5;
  report.lines = {line_of(1, 0, 0.0, 1.5), line_of(2, 0, 4.0, 9.25)};
  report.lines[1].partner.reset();
  report.lines[1].junctions.clear();
  report.lines[1].piece = -3;
  report.lines[1].begins = FeatureEnd::death;
  report.lines[1].begins_at = LineEnd{7, true};
  report.lines[1].met_by = {{4, false}, {6, true}};
  report.lines[1].closed_loop = true;
  report.runs = {{10, 0, 4, 0}, {10, 4, 3, 2}, {10, 9, 2, 1}, {11, 0, 5, 0}, {11, 5, 2, 2}, {11, 9, 1, 1}, {12, 3, 8, 7}};
  report.merges = {{2, 0}, {7, 2}};
  Patch patch;
  patch.id = 1;
  patch.label = FormKind::pocket;
  patch.shape = PatchShape::free_form;
  patch.samples = 33;
  patch.area_mm2 = 1.5;
  patch.centroid = {1.0, -2.0, 0.125};
  patch.normal = {0.0, 0.0, 1.0};
  patch.plane_residual_mm = 0.0125;
  patch.quadric_residual_mm = 0.0025;
  patch.neighbours = {0, 2};
  patch.doubtful = true;
  report.patches = {patch};
  report.forms = {{FormKind::slot, {1, 2}, 0.875}, {FormKind::hole, {1}, 0.75, HoleSize{{1.5, -2.0, 0.25}, 4.0, 3.5, 9.25, 2}}};
  report.backlash = Backlash{0.125, 0.0015, -0.125, 321};
  return report;
}

FeatureReport read_back(const FeatureReport& report) {
  FeatureReport back;
  for (const std::string& text : features_messages(report)) EXPECT_OK(parse_features_message(text, back));
  for (const std::string& text : patches_messages(report)) EXPECT_OK(parse_patches_message(text, back));
  return back;
}

TEST(Notes, GoThereAndBack) {
  EXPECT_EQ(read_back(full_report()), full_report());
  EXPECT_TRUE(features_messages({}).empty());
  EXPECT_TRUE(patches_messages({}).empty());
}

TEST(Notes, LongReportsComeInSeveralMessages) {
  FeatureReport report;
  for (std::uint64_t k = 0; k < 300; ++k) {
    FeatureLine line = line_of(k, 0, 0.0, 1.5);
    line.vertices.resize(1000, line.vertices.back());
    report.lines.push_back(std::move(line));
  }
  for (std::uint32_t k = 0; k < 200'000; ++k) report.runs.push_back({k / 4, 10 * (k % 4), 10 - k / 4 % 2, k % 4 + k / 50'000});
  EXPECT_GT(features_messages(report).size(), 2U);
  EXPECT_GT(patches_messages(report).size(), 1U);
  EXPECT_EQ(read_back(report), report);
}

TEST(Notes, WhatIsNoNumberIsWrittenAsZero) {
  FeatureReport report = full_report();
  report.lines[0].sharpness = std::numeric_limits<double>::quiet_NaN();
  report.lines[1].length_mm = std::numeric_limits<double>::infinity();
  const FeatureReport back = read_back(report);
  EXPECT_EQ(back.lines[0].sharpness, 0.0);
  EXPECT_EQ(back.lines[1].length_mm, 0.0);
}

TEST(Notes, DamagedTextIsRefused) {
  const std::string features = features_messages(full_report()).front();
  const std::string patches = patches_messages(full_report()).front();
  FeatureReport report;
  for (const char* bad : {"", "null", "[]", "{}", R"({"group":-1,"lines":[]})", R"({"group":1,"lines":[{}]})",
                          R"({"group":1,"lines":[],"backlash":{"along":1}})", R"({"group":1,"lines":[],"backlash":3})",
                          R"({"group":1,"lines":7})", R"({"group":1e300,"lines":[]})"}) {
    EXPECT_FALSE(parse_features_message(bad, report)) << bad;
  }
  for (const char* bad : {R"({"group":1,"runs":[[0,0,[1]]]})", R"({"group":1,"runs":[[0,0,[1],[1,2]]]})",
                          R"({"group":1,"merges":[[1]]})", R"({"group":1,"runs":[[0,4294967295,[9],[1]]]})",
                          R"({"group":1,"runs":[[0,0,[0],[1]]]})", R"({"group":1,"runs":[[1]]})",
                          R"({"group":1,"runs":[[0,0,[3],[1]],[-3]]})", R"({"group":1,"runs":[[0,0,[3],[1]],[1,1]]})",
                          R"({"group":1,"runs":[7]})", R"({"group":1,"forms":[{"kind":"crater","patches":[],"confidence":1}]})",
                          R"({"group":1,"forms":[{"kind":"hole","patches":[1],"confidence":1}]})"}) {
    EXPECT_FALSE(parse_patches_message(bad, report)) << bad;
  }
  for (const std::string* text : {&features, &patches}) { // no crash, whatever is cut off
    for (std::size_t size = 0; size < text->size(); ++size) {
      EXPECT_FALSE(parse_features_message(text->substr(0, size), report));
      EXPECT_FALSE(parse_patches_message(text->substr(0, size), report));
    }
  }
}

TEST(Findings, PiecesAreJoinedAndMergesFollowed) {
  FeatureReport report = full_report();
  FeatureLine later = line_of(1, 1, 1.5, 4.0);
  later.vertices.front() = report.lines[0].vertices.back();
  report.lines.push_back(later);
  report.lines[0].ends = FeatureEnd::open;
  const Findings found = assemble(report);
  ASSERT_EQ(found.lines.size(), 2U);
  EXPECT_EQ(found.lines[0].vertices.size(), 3U);
  EXPECT_EQ(found.lines[0].length_mm, 4.0);
  EXPECT_EQ(found.lines[0].scan_lines, 4U);
  EXPECT_EQ(found.lines[0].begins, FeatureEnd::border);
  EXPECT_EQ(found.lines[0].ends, FeatureEnd::junction);
  EXPECT_EQ(found.lines[0].elements[16], 18U);
  for (const PatchRun& run : found.runs) EXPECT_TRUE(run.patch == 0 || run.patch == 1) << run.patch;
  ASSERT_EQ(found.patches.size(), 1U);
  EXPECT_EQ(found.patches[0].neighbours, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(found.forms[0].patches, (std::vector<std::uint32_t>{1, 0}));
}

RecordingFacts with_features() {
  RecordingFacts f = facts();
  f.features = true;
  return f;
}

/// Two groups with a report behind each.
void record(const std::string& path, bool finish = true) {
  auto writer = RecordingWriter::create(path, with_features());
  ASSERT_OK(writer);
  for (std::uint32_t k = 0; k < 2; ++k) {
    append(writer.value(), group(with_features(), k, 64 * k, 64));
    FeatureReport report = full_report();
    report.lines.resize(1);
    report.lines[0].id = k;
    ASSERT_OK(writer.value().append(report, 1000));
    EXPECT_TRUE(report.empty());
  }
  if (finish) ASSERT_OK(writer.value().finish(std::nullopt, 0.0));
}

std::size_t lines_in(const std::string& path) {
  auto reader = RecordingReader::open(path);
  if (!reader) return 0;
  const auto found = read_findings(reader.value());
  return found ? found.value().lines.size() : 0;
}

TEST(RecordedNotes, AreReadAndSound) {
  const Folder folder;
  record(folder / "a");
  const auto report = verify_with(folder / "a", inspector());
  ASSERT_OK(report);
  EXPECT_TRUE(report.value().sound) << (report.value().findings.empty() ? "" : report.value().findings.front().what);
  EXPECT_EQ(lines_in(folder / "a"), 2U);
}

TEST(RecordedNotes, GroupsAreTheSameWithoutThem) {
  const Folder folder;
  record(folder / "with");
  make(folder / "without", {.groups = 2});
  auto with = RecordingReader::open(folder / "with");
  auto without = RecordingReader::open(folder / "without");
  ASSERT_TRUE(with && without);
  ASSERT_EQ(with.value().groups().size(), 2U);
  Bytes a;
  Bytes b;
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t k = 0; k < with.value().groups()[g].payloads.size(); ++k) {
      ASSERT_OK(with.value().read_payload(g, k, a));
      ASSERT_OK(without.value().read_payload(g, k, b));
      EXPECT_EQ(a, b);
    }
  }
}

TEST(RecordedNotes, NoFlippedByteGoesUnseen) {
  const Folder folder;
  record(folder / "a");
  const Bytes good = read_file(folder / "a");
  for (std::size_t at = 0; at < good.size(); ++at) {
    Bytes bad = good;
    bad[at] ^= std::byte{0x10};
    write_file(folder / "b", bad);
    const auto report = verify_with(folder / "b", inspector());
    ASSERT_OK(report);
    ASSERT_FALSE(report.value().sound) << at;
  }
}

TEST(RecordedNotes, RecoverKeepsThemAndTellsOfLostOnes) {
  const Folder folder;
  record(folder / "a");
  ASSERT_OK(recover_with(folder / "a", folder / "whole", inspector()));
  EXPECT_EQ(lines_in(folder / "whole"), 2U);
  Bytes bad = read_file(folder / "a");
  const std::string_view text(reinterpret_cast<const char*>(bad.data()), bad.size());
  const std::size_t note = text.find(R"({"group":5,"lines")");
  ASSERT_NE(note, std::string_view::npos);
  bad[note + 40] ^= std::byte{1};
  write_file(folder / "b", bad);
  const auto report = recover_with(folder / "b", folder / "c", inspector());
  ASSERT_OK(report);
  EXPECT_TRUE(report.value().notes_lost);
  EXPECT_TRUE(report.value().anything_lost());
  EXPECT_EQ(report.value().groups, 2U);
  EXPECT_EQ(lines_in(folder / "c"), 1U);
}

TEST(RecordedNotes, AKilledRecordingIsFinishedWithThem) {
  const Folder folder;
  record(folder / "whole", false);
  const Bytes whole = read_file(folder / "whole");
  for (std::size_t size = whole.size(); size > whole.size() - 600; size -= 7) {
    write_file(folder / "a", ByteView(whole).first(size));
    ASSERT_OK(finish_in_place_with(folder / "a", inspector()));
    const auto report = verify_with(folder / "a", inspector());
    ASSERT_OK(report);
    EXPECT_TRUE(report.value().sound) << size;
    EXPECT_EQ(lines_in(folder / "a"), size == whole.size() ? 2U : lines_in(folder / "a"));
    EXPECT_GE(lines_in(folder / "a"), 1U);
  }
}

TEST(RecordedNotes, ACutKeepsThem) {
  const Folder folder;
  record(folder / "a");
  ASSERT_OK(cut_to_level_with(folder / "a", 0, folder / "b", inspector()));
  EXPECT_EQ(lines_in(folder / "b"), 2U);
  EXPECT_TRUE(verify_with(folder / "b", inspector()).value().sound);
}

TEST(RecordedNotes, NeedTheirChannels) {
  const Folder folder;
  auto writer = RecordingWriter::create(folder / "a", facts());
  ASSERT_OK(writer);
  FeatureReport report = full_report();
  EXPECT_FALSE(writer.value().append(report, 0));
}

} // namespace
} // namespace scansion::synthetic
