// PLY: range grids and line properties in all three encodings, and hostile headers.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/paged_table.hpp"
#include "tests/unit/import/support.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <random>

namespace scansion::test {
namespace {

using Points = std::vector<Point>;

Imported import_ply(std::string_view text, const ImportOptions& options = {}) {
  return import_text(text, options, "scan.ply");
}

/// Appends the bytes of a value.
template <class T>
void put(std::string& out, T value, bool big) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big == (std::endian::native == std::endian::little)) std::reverse(bytes.begin(), bytes.end());
  out.append(bytes.data(), bytes.size());
}

constexpr const char* kGridHeader =
    "obj_info num_cols 3\nobj_info num_rows 2\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar confidence\nelement range_grid 6\n"
    "property list uchar int vertex_indices\nend_header\n";
constexpr float kVertices[4][3] = {{0, 0, 0.5F}, {1, 0, 1.5F}, {0, 1, 2.5F}, {1, 1, 3.5F}};
constexpr int kCells[6] = {0, 1, -1, 2, 3, -1};

std::string ascii_grid() {
  std::string text = "ply\nformat ascii 1.0\ncomment x\n";
  text += kGridHeader;
  text += "0 0 0.5 9\n1 0 1.5 9\n0 1 2.5 9\n1 1 3.5 9\n1 0\n1 1\n0\n1 2\n1 3\n0 \n";
  return text;
}

std::string binary_grid(bool big) {
  std::string text = std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + kGridHeader;
  for (const auto& vertex : kVertices) {
    for (const float v : vertex) put(text, v, big);
    text += '\7';
  }
  for (const int cell : kCells) {
    text += cell < 0 ? '\0' : '\1';
    if (cell >= 0) put(text, cell, big);
  }
  return text;
}

TEST(ImportPly, GridColumnsAreLines) {
  for (const std::string& text : {ascii_grid(), binary_grid(false), binary_grid(true)}) {
    const Imported r = import_ply(text);
    ASSERT_FALSE(r.error) << r.error->context;
    ASSERT_EQ(r.lines.size(), 2U);
    EXPECT_EQ(r.lines[0].points, (Points{{0, 0, 0.5}, {0, 1, 2.5}}));
    EXPECT_EQ(r.lines[1].points, (Points{{1, 0, 1.5}, {1, 1, 3.5}}));
    EXPECT_EQ(r.counts.missing, 2U);
    EXPECT_EQ(r.counts.invalid, 0U);
    ASSERT_EQ(r.notes.size(), 1U);
    EXPECT_NE(r.notes[0].find("confidence"), std::string::npos);
  }
  EXPECT_EQ(import_ply(ascii_grid()).lattice.source, Source::decimal);
  EXPECT_EQ(import_ply(binary_grid(true)).lattice.source, Source::float32);
  EXPECT_FALSE(import_ply(binary_grid(true)).lattice.exact);
}

TEST(ImportPly, GridRowsOnRequestAndEmptyCellsDoNotSplit) {
  ImportOptions options;
  options.grid_rows = true;
  const Imported r = import_ply(ascii_grid(), options);
  ASSERT_EQ(r.lines.size(), 2U);
  EXPECT_EQ(r.lines[0].points, (Points{{0, 0, 0.5}, {1, 0, 1.5}}));
  std::string holes =
      "ply\nformat ascii 1.0\nobj_info num_cols 1\nobj_info num_rows 5\nelement range_grid 5\n"
      "property list uchar int i\nelement vertex 2\nproperty double z\nproperty int y\nproperty double x\nend_header\n"
      "1 0\n0\n0\n1 1\n0\n\n5 -2 0.25\nnan 0 0\n";
  const Imported h = import_ply(holes);
  ASSERT_FALSE(h.error) << h.error->context;
  EXPECT_EQ(h.points(), (Points{{0.25, -2, 5}}));
  EXPECT_EQ(h.counts.missing, 3U);
  EXPECT_EQ(h.counts.invalid, 1U);
  EXPECT_EQ(h.lines[0].invalid_after, 1U);
}

std::string line_list(bool big) {
  std::string text =
      std::string("ply\nformat binary_") + (big ? "big" : "little") +
      "_endian 1.0\nelement vertex 5\nproperty double x\nproperty ushort line\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const int lines[5] = {3, 3, 900, 900, 3};
  for (int i = 0; i < 5; ++i) {
    put(text, 0.1 * i, big);
    put(text, static_cast<std::uint16_t>(lines[i]), big);
    put(text, 2.0, big);
    put(text, i == 1 ? std::nan("") : -1.0 / 3.0, big);
  }
  return text; // the face is missing: nobody needs it
}

TEST(ImportPly, TheLinePropertySeparatesLines) {
  for (const bool big : {false, true}) {
    const Imported r = import_ply(line_list(big));
    ASSERT_FALSE(r.error) << r.error->context;
    ASSERT_EQ(r.lines.size(), 3U);
    EXPECT_EQ(r.lines[0].invalid_after, 1U);
    EXPECT_EQ(r.lines[1].points, (Points{{0.2, 2, -1.0 / 3.0}, {0.1 * 3, 2, -1.0 / 3.0}}));
    EXPECT_EQ(r.lines[2].points, (Points{{0.4, 2, -1.0 / 3.0}}));
    EXPECT_TRUE(r.lattice.exact); // thirds have no decimals
    EXPECT_EQ(r.lattice.source, Source::float64);
  }
  const Imported ascii =
      import_ply("ply\r\nformat ascii 1.0\r\nelement vertex 2\r\nproperty float x\r\nproperty float y\r\nproperty "
                 "float z\r\nproperty int line\r\nend_header\r\n1 2 3 -1\r\n\r\n4 5 6 7\r\n");
  ASSERT_FALSE(ascii.error) << ascii.error->context;
  EXPECT_EQ(ascii.lines.size(), 2U);
}

TEST(ImportPly, BinaryListsInVerticesAreWalked) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement skipped 2\nproperty list ushort double d\nelement vertex 2\nproperty "
      "list uchar int a\nproperty float x\nproperty float y\nproperty float z\nproperty char line\nend_header\n";
  put(text, std::uint16_t{2}, false);
  put(text, 1.0, false);
  put(text, 2.0, false);
  put(text, std::uint16_t{0}, false);
  for (int i = 0; i < 2; ++i) {
    text += static_cast<char>(i);
    for (int k = 0; k < i; ++k) put(text, 77, false);
    for (int k = 0; k < 3; ++k) put(text, static_cast<float>(k + i), false);
    text += '\1';
  }
  const Imported r = import_ply(text);
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_EQ(r.points(), (Points{{0, 1, 2}, {1, 2, 3}}));
}

TEST(ImportPly, ErrorsNameTheRowOrTheVertex) {
  const Imported ascii =
      import_ply("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
                 "z\nproperty int line\nend_header\n1 2 3 1\n1 2 1e300 1\n");
  ASSERT_TRUE(ascii.error);
  EXPECT_EQ(ascii.error->code, Errc::out_of_range);
  EXPECT_NE(ascii.error->context.find("scan.ply:10: z = 1e+300"), std::string::npos) << ascii.error->context;
  std::string binary = line_list(false);
  const double far = 1e13;
  std::memcpy(binary.data() + binary.find("end_header\n") + 11 + 2 * 26, &far, 8);
  const Imported r = import_ply(binary);
  ASSERT_TRUE(r.error);
  EXPECT_NE(r.error->context.find("scan.ply: vertex 2: x = 1e+13"), std::string::npos) << r.error->context;
}

constexpr const char* kXyz = "property float x\nproperty float y\nproperty float z\n";

TEST(ImportPly, HostileHeaders) {
  const std::string ascii = "ply\nformat ascii 1.0\n";
  const std::string xyz = kXyz;
  const std::string cells = "property list uchar int i\n";
  const std::pair<std::string, const char*> bad[] = {
      {"ply\nformat ascii 1.0\nelement vertex 1\n", "no end_header"},
      {"", "no end_header"},
      {"# scan\n", "where \"ply\" was expected"},
      {"ply\nend_header\n", "no format row"},
      {"ply\nformat klingon 1.0\nend_header\n", "unknown PLY format"},
      {ascii + "bogus\nend_header\n", "unknown PLY header row"},
      {ascii + "property float x\n", "before any element"},
      {ascii + "element vertex -1\n", "needs a name and a number"},
      {ascii + "element vertex 99999999999999999999999\n", "needs a name and a number"},
      {ascii + "element vertex 1\nproperty quaternion x\n", "unknown property type"},
      {ascii + "element vertex 1\nproperty list float int x\n", "unknown property type"},
      {ascii + "element vertex 1\nelement vertex 1\n", "there twice"},
      {ascii + "element face 1\nend_header\n", "no element vertex"},
      {ascii + "element vertex 1\nproperty float x\nend_header\n1\n", "no x, y and z"},
      {ascii + "element vertex 1\n" + xyz + "end_header\n1 2 3\n", "neither a range_grid nor"},
      {ascii + "element vertex 1\n" + xyz + "property float line\nend_header\n1 2 3 4\n", "neither a range_grid nor"},
      {ascii + "element vertex 1000000000000000000\n" + xyz + "property int line\nend_header\n1 2 3 4\n",
       "claims 1000000000000000000"},
      {ascii + "element empty 1000000000000000000\nelement vertex 1\n" + xyz + "property int line\nend_header\n1 2 3 4\n",
       "has no properties"},
      {"ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + xyz + "property int line\nend_header\n0123456789ABCDEF",
       "claims 3 rows"},
      {ascii + "element vertex 3\n" + xyz + "property int line\nend_header\n1 2 3 4\n", "ends after 1 of 3"},
      {ascii + "element vertex 2\n" + xyz + "property int line\nend_header\n1 2 3 4\n1 2 3\n", "scan.ply:10: found \"\""},
      {ascii + "element vertex 1\n" + xyz + "element range_grid 1\n" + cells + "end_header\n1 2 3\n1 0\n",
       "num_cols and num_rows"},
      {ascii + "obj_info num_cols 2\nobj_info num_rows 2\nelement vertex 1\n" + xyz + "element range_grid 1\n" + cells +
           "end_header\n1 2 3\n1 0\n",
       "2 columns of 2"},
      {ascii + "obj_info num_cols 4294967296\nobj_info num_rows 4294967296\nelement vertex 1\n" + xyz +
           "element range_grid 0\n" + cells + "end_header\n1 2 3\n",
       "correct the header"},
      {ascii + "obj_info num_cols 1000000000000000000\nobj_info num_rows 0\nelement vertex 1\n" + xyz +
           "element range_grid 0\n" + cells + "end_header\n1 2 3\n",
       "no cells"},
      {ascii + "obj_info num_cols 1\nobj_info num_rows 1\nelement vertex 1\n" + xyz + "element range_grid 1\n" + cells +
           "end_header\n1 2 3\n1 1\n",
       "does not name one of the 1 vertices"},
      {ascii + "obj_info num_cols 1\nobj_info num_rows 1\nelement vertex 1\n" + xyz + "element range_grid 1\n" + cells +
           "end_header\n1 2 3\n1 -1\n",
       "does not name one of the 1 vertices"},
      {ascii + "obj_info num_cols 1\nobj_info num_rows 1\nelement vertex 1\n" + xyz + "element range_grid 1\n" + cells +
           "end_header\n1 2 3\n2 0 0\n",
       "does not name one of the 1 vertices"},
      {ascii + "obj_info num_cols 1\nobj_info num_rows 1\nelement vertex 1\n" + xyz + "element range_grid 1\n" + cells +
           "end_header\n1 2 3\n99 0\n",
       "found \"\""},
      {ascii + "obj_info num_cols 1\nobj_info num_rows 1\nelement vertex 1\n" + xyz +
           "element range_grid 1\nproperty int i\nend_header\n1 2 3\n0\n",
       "no list of vertex indices"},
  };
  for (const auto& [text, says] : bad) {
    const Imported r = import_ply(text);
    ASSERT_TRUE(r.error) << text;
    EXPECT_EQ(r.error->code, Errc::undecodable) << r.error->context;
    EXPECT_NE(r.error->context.find(says), std::string::npos) << r.error->context << "\nfor\n" << text;
    EXPECT_NE(r.error->context.find("scan.ply"), std::string::npos) << r.error->context;
  }
}

TEST(ImportPly, HugeListLengthsAllocateNothing) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint double i\nelement vertex 1\n" +
                     std::string(kXyz) + "property int line\nend_header\n";
  put(text, 0xFFFFFFFFU, false);
  text += std::string(64, 'x');
  const Imported r = import_ply(text);
  ASSERT_TRUE(r.error);
  EXPECT_NE(r.error->context.find("cut off"), std::string::npos) << r.error->context;
}

TEST(PagedTable, ComesBackFromMemoryAndFromDisk) {
  struct Row {
    std::uint64_t a;
    std::uint32_t b, c;
  };
  for (const std::uint64_t count : {std::uint64_t{1000}, PagedTable<Row>::kMemory / sizeof(Row), std::uint64_t{5000003}}) {
    PagedTable<Row> table;
    for (std::uint64_t i = 0; i < count; ++i) ASSERT_TRUE(table.append({i, static_cast<std::uint32_t>(i * 7), 5}));
    ASSERT_TRUE(table.seal());
    ASSERT_EQ(table.size(), count);
    std::mt19937_64 random(1);
    for (int k = 0; k < 20000; ++k) {
      const std::uint64_t i = k % 2 == 0 ? random() % count : (static_cast<std::uint64_t>(k) * 4096) % count;
      const auto row = table.at(i);
      ASSERT_TRUE(row);
      ASSERT_EQ(row.value()->a, i);
      ASSERT_EQ(row.value()->b, static_cast<std::uint32_t>(i * 7));
    }
    ASSERT_EQ(table.at(count - 1).value()->a, count - 1);
  }
}

} // namespace
} // namespace scansion::test
