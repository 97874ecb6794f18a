// Answers of a controller, whole, in pieces, and spoiled; rows into scan lines and back.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/rows.hpp"

#include <gtest/gtest.h>

namespace scansion::grbl::test {
namespace {

struct Heard {
  std::vector<AnswerKind> kinds;
  std::vector<int> numbers;
  StatusReport status;
  ProbeReport probe;
  LinkCounters counters;
};

void hear(std::string_view text, std::size_t piece, Heard& heard) {
  Answers answers(heard.counters);
  for (std::size_t at = 0; at < text.size(); at += piece) {
    auto bytes = std::as_bytes(std::span(text.substr(at, piece)));
    while (const auto answer = answers.next(bytes)) {
      heard.kinds.push_back(answer->kind);
      heard.numbers.push_back(answer->number);
      if (answer->kind == AnswerKind::status) heard.status = answer->status;
      if (answer->kind == AnswerKind::probe) heard.probe = answer->probe;
    }
  }
}

TEST(GrblAnswers, AreTheSameInAnyPieces) {
  const std::string_view text =
      "\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\nok\r\nerror:9\r\nALARM:5\r\n"
      "[PRB:-1.5,2.0000,-0.125,7.000:1]\r\n<Hold:1|WPos:1.000,2.000,3.000|Bf:1,2|Pn:PZ|WCO:0,0,-1.5|Q:9>\r\n"
      "$13=0\r\n[VER:1.1h.20190830:]\r\n[OPT:V,15,128]\r\n>G20:ok\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n"
      "Grbl 3.7 [FluidNC v3.7.0 (wifi) '$' for help]\r\n";
  for (const std::size_t piece : {1U, 2U, 3U, 7U, 64U, 1000U}) {
    Heard heard;
    hear(text, piece, heard);
    using enum AnswerKind;
    EXPECT_EQ(heard.kinds, (std::vector{banner, message, ok, error, alarm, probe, status, setting, version, options, start_up,
                                        banner, banner}));
    EXPECT_EQ(heard.numbers[3], 9);
    EXPECT_EQ(heard.probe, (ProbeReport{{-15000, 20000, -1250}, true}));
    EXPECT_EQ(heard.status.state, MachineState::hold);
    EXPECT_EQ(heard.status.substate, 1);
    EXPECT_TRUE(heard.status.probe_closed);
    EXPECT_EQ(heard.status.offset, (Position{0, 0, -15000}));
    EXPECT_FALSE(heard.status.machine);
    EXPECT_EQ(heard.counters.accepted, 13U);
    EXPECT_EQ(heard.counters.rejected(), 0U);
  }
}

TEST(GrblAnswers, SpoiledLinesAreCountedByCauseAndNeverBelieved) {
  Heard heard;
  const std::string text =
      "o\xFFk\r\nerror:x\r\n[PRB:1,2:1]\r\n[PRB:1,2,3:7]\r\n[PRB:1,2,1e9:1]\r\n<Idle|MPos:1,2>\r\n<Idle\r\nALARM:\r\n" +
      std::string(5000, 'x') + "\r\nok\r\n";
  hear(text, 11, heard);
  EXPECT_EQ(heard.kinds, std::vector{AnswerKind::ok});
  EXPECT_EQ(heard.counters.rejected(Reject::framing), 1U);
  EXPECT_EQ(heard.counters.rejected(Reject::overlong), 1U);
  EXPECT_EQ(heard.counters.rejected(Reject::value), 7U);
}

TEST(GrblAnswers, NumbersAreExactOrRefused) {
  EXPECT_EQ(parse_ticks("-0.001"), -10);
  EXPECT_EQ(parse_ticks("12"), 120000);
  EXPECT_EQ(parse_ticks("1.23450"), 12345);
  for (const char* bad : {"", "-", ".", "1.2.3", "1.23451", "nan", "+1", "1e3", "999999999", " 1"})
    EXPECT_FALSE(parse_ticks(bad)) << bad;
}

Raster raster() {
  return Raster::create({.x_from = 0, .x_to = 3, .y_from = 0, .y_to = 1, .pitch = 1, .spacing = 1, .top = 0, .bottom = -9})
      .assume_value();
}

TEST(GrblRows, GoIntoLinesAndBack) {
  const Raster grid = raster();
  DoneRows rows(grid);
  Row row;
  row.points = {std::nullopt, Position{10000, 0, -12340}, Position{20000, 0, -20000}, std::nullopt};
  ASSERT_TRUE(rows.put(row, false, {}));
  LineBuffer line;
  rows.fill(0, line);
  ASSERT_EQ(line.runs.size(), 1U);
  EXPECT_EQ(line.runs[0], (scansion::Run{0, 2, 1}));
  EXPECT_EQ(line.invalid_after, 1U);
  EXPECT_EQ(line.xyz[2], (std::vector<std::int32_t>{-1234, -2000}));
  ASSERT_TRUE(line.plane);

  DoneRows again(grid);
  ASSERT_TRUE(again.take_over(report_lattice(false), {line}));
  LineBuffer copy;
  again.fill(0, copy);
  EXPECT_EQ(copy.xyz, line.xyz);
  EXPECT_EQ(copy.runs, line.runs);

  auto moved = line;
  for (auto& y : moved.xyz[1]) y += 700;
  EXPECT_FALSE(again.take_over(report_lattice(false), {moved})) << "another raster's row";
  EXPECT_TRUE(again.is_empty());
  auto short_line = line;
  short_line.invalid_after = 0;
  EXPECT_FALSE(again.take_over(report_lattice(false), {short_line}));
  EXPECT_FALSE(again.take_over(Lattice{}, {line})) << "another resolution";
  EXPECT_FALSE(again.take_over(report_lattice(false), {line, line, line})) << "more rows than the raster";
}

TEST(GrblRaster, LiftsOverWhatIsKnownAndToTheTopWhereNothingIs) {
  const Raster grid = raster();
  HeightMap map(grid);
  EXPECT_EQ(map.safe_height(0, 0, 1), grid.top());
  map.put(0, 0, -4000);
  EXPECT_EQ(map.safe_height(0, 0, 1), -3000); // clearance 1 mm
  map.put(0, 1, -1500);
  EXPECT_EQ(map.safe_height(1, 0, 3), -500);
  map.put(0, 2, -200);
  EXPECT_EQ(map.safe_height(1, 0, 3), grid.top()) << "never above it";
}

TEST(GrblRaster, RefusesAreasThatMakeNone) {
  EXPECT_FALSE(Raster::create({.x_from = 1, .x_to = 0, .y_to = 1, .top = 1}));
  EXPECT_FALSE(Raster::create({.x_to = 1, .y_to = 1, .top = 0, .bottom = 0}));
  EXPECT_FALSE(Raster::create({.x_to = 1000, .y_to = 1000, .pitch = 0.1, .spacing = 0.1, .top = 1}));
  EXPECT_EQ(Raster::create({.x_to = 0.3, .y_to = 0, .pitch = 0.1, .top = 1}).assume_value().columns(), 4U);
}

} // namespace
} // namespace scansion::grbl::test
