// Where scans come from: files, folders, archives, packed files, pipes; and inputs that cannot be read.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/import/support.hpp"

#include <chrono>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace scansion::test {
namespace {

using Points = std::vector<Point>;

std::vector<double> first_coordinates(const Imported& r) {
  std::vector<double> out;
  for (const Point& point : r.points()) out.push_back(point[0]);
  return out;
}

/// Files whose x tells their place in natural order, and two that are not read.
void write_tree(const Scratch& scratch) {
  scratch.write("tree/a2/p10.xyz", "3 0 0\n");
  scratch.write("tree/a2/p9.TXT", "2 0 0\n");
  scratch.write("tree/a10/p1.csv", "x,y,z\n4 ,0,0\n");
  scratch.write("tree/a1.asc", "1 0 0\n");
  scratch.write("tree/README.md", "hello\n");
  scratch.write("tree/a2/photo.jpg", "\xFF\xD8");
}

TEST(Inputs, FoldersInNaturalOrder) {
  const Scratch scratch;
  write_tree(scratch);
  const Imported r = import_all({scratch.path("tree")});
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_EQ(first_coordinates(r), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(r.lines.size(), 4U);
  ASSERT_EQ(r.notes.size(), 1U);
  EXPECT_NE(r.notes[0].find("README.md"), std::string::npos);
  EXPECT_NE(r.notes[0].find("photo.jpg"), std::string::npos);
}

TEST(Inputs, TarArchivesPackedOrNot) {
  const Scratch scratch;
  write_tree(scratch);
  ASSERT_TRUE(
      run_command("cd '" + scratch.path("tree") +
                  "' && tar cf ../t.tar README.md a2 a10 a1.asc && cd .. && xz -k t.tar && gzip -k t.tar && zstd -q t.tar"));
  for (const char* name : {"t.tar", "t.tar.xz", "t.tar.gz", "t.tar.zst"}) {
    const Imported r = import_all({scratch.path(name)});
    ASSERT_FALSE(r.error) << name << r.error->context;
    EXPECT_EQ(first_coordinates(r), (std::vector<double>{1, 2, 3, 4})) << name;
    EXPECT_EQ(r.notes.size(), 1U);
  }
}

TEST(Inputs, PackedMembersInFoldersAndArchives) {
  const Scratch scratch;
  scratch.write("tree/p2.xyz", "2 0 0\n");
  scratch.write("tree/p10.xyz", "3 0 0\n");
  scratch.write("tree/p1.csv", "1,0,5\n");
  ASSERT_TRUE(run_command("cd '" + scratch.path("tree") +
                          "' && gzip p2.xyz && xz p10.xyz && zstd -q --rm p1.csv && tar cf ../t.tar *"));
  for (const char* name : {"tree", "t.tar"}) {
    const Imported r = import_all({scratch.path(name)});
    ASSERT_FALSE(r.error) << name << ": " << r.error->context;
    EXPECT_EQ(first_coordinates(r), (std::vector<double>{1, 2, 3})) << name;
  }
}

TEST(Inputs, SinglePackedFilesAndSeveralInputs) {
  const Scratch scratch;
  scratch.write("a.xyz", "1 0 0\n");
  scratch.write("b.xyz", "2 0 0\n");
  scratch.write("c.csv", "x,z\n3,0\n");
  ASSERT_TRUE(run_command("cd '" + scratch.path() + "' && xz a.xyz && gzip b.xyz && zstd -q --rm c.csv"));
  const Imported r = import_all({scratch.path("c.csv.zst"), scratch.path("a.xyz.xz"), scratch.path("b.xyz.gz")});
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_EQ(first_coordinates(r), (std::vector<double>{3, 1, 2}));
  EXPECT_EQ(r.lines.size(), 3U);
}

TEST(Inputs, ErrorsInsideArchivesNameMemberAndRow) {
  const Scratch scratch;
  scratch.write("a/b.csv", "1,2\n3,4\n5,six\n");
  ASSERT_TRUE(run_command("cd '" + scratch.path() + "' && tar cJf scan.tar.xz a"));
  const Imported r = import_all({scratch.path("scan.tar.xz")});
  ASSERT_TRUE(r.error);
  EXPECT_NE(r.error->context.find("scan.tar.xz:a/b.csv:3: found \"six\""), std::string::npos) << r.error->context;
}

TEST(Inputs, DamagedAndEmptyArchives) {
  const Scratch scratch;
  std::string text;
  for (int i = 0; i < 20000; ++i) text += std::to_string(i * 7919 % 10007) + " 2 3\n";
  scratch.write("s.xyz", text);
  ASSERT_TRUE(run_command(
      "cd '" + scratch.path() +
      "' && for p in xz gzip 'zstd -q'; do $p -k s.xyz; done && for e in xz gz zst; do head -c 5000 s.xyz.$e > cut.xyz.$e; done"
      " && : > e.xyz && xz -k e.xyz && mkdir none && tar cf none.tar none && : > none/x.md && tar cf other.tar none"));
  for (const char* name : {"cut.xyz.xz", "cut.xyz.gz", "cut.xyz.zst"}) {
    const Imported r = import_all({scratch.path(name)});
    ASSERT_TRUE(r.error) << name;
    EXPECT_EQ(r.error->code, Errc::undecodable);
    EXPECT_NE(r.error->context.find(std::string(name) + ": cannot be unpacked"), std::string::npos) << r.error->context;
  }
  for (const char* name : {"e.xyz", "e.xyz.xz", "none.tar", "other.tar", "none"}) {
    const Imported r = import_all({scratch.path(name)});
    ASSERT_TRUE(r.error) << name;
    EXPECT_EQ(r.error->code, Errc::undecodable) << r.error->context;
    EXPECT_NE(r.error->context.find(name), std::string::npos) << r.error->context;
  }
}

TEST(Inputs, MissingAndForbidden) {
  const Imported missing = import_all({"/nowhere/scan.xyz"});
  ASSERT_TRUE(missing.error);
  EXPECT_EQ(missing.error->code, Errc::not_found);
  EXPECT_NE(missing.error->context.find("/nowhere/scan.xyz"), std::string::npos);
  EXPECT_EQ(import_all({}).error.value().code, Errc::usage);
  ImportOptions options;
  options.gap_mm = 0.0;
  EXPECT_EQ(import_all({"x"}, options).error.value().code, Errc::usage);
}

TEST(Inputs, PipesAreRead) {
  const Scratch scratch;
  const std::string pipe = scratch.path("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string text;
  for (int i = 0; i < 100000; ++i) text += std::to_string(i) + " 1 2\n";
  for (const bool packed : {false, true}) {
    const std::string file = scratch.write("big.xyz", text);
    std::thread writer([&] { EXPECT_TRUE(run_command((packed ? "xz -0 -c '" : "cat '") + file + "' > '" + pipe + "'")); });
    const Imported r = import_all({pipe});
    writer.join();
    ASSERT_FALSE(r.error) << r.error->context;
    EXPECT_EQ(r.counts.points, 100000U);
  }
}

/// Puts `fd` in the place of standard input while it lives.
class StandardInput {
public:
  explicit StandardInput(int fd) : kept_(::dup(STDIN_FILENO)) {
    EXPECT_EQ(::dup2(fd, STDIN_FILENO), STDIN_FILENO);
    ::close(fd);
  }
  ~StandardInput() {
    ::dup2(kept_, STDIN_FILENO);
    ::close(kept_);
  }
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

private:
  int kept_;
};

TEST(Inputs, StandardInputFromAFileAndAPipe) {
  const Scratch scratch;
  ImportOptions options;
  options.name_for_stdin = "<stdin>";
  const std::string file = scratch.write("scan", "0 0 0\n1 2 3\n");
  {
    const int fd = ::open(file.c_str(), O_RDONLY);
    ASSERT_EQ(::lseek(fd, 6, SEEK_SET), 6); // someone read the first row already
    const StandardInput input(fd);
    const Imported r = import_all({"-"}, options);
    ASSERT_FALSE(r.error) << r.error->context;
    EXPECT_EQ(r.points(), (Points{{1, 2, 3}}));
  }
  {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    ASSERT_EQ(::write(ends[1], "1 2 3\n4 5\n", 10), 10);
    ::close(ends[1]);
    const StandardInput input(ends[0]);
    const Imported r = import_all({"-"}, options);
    ASSERT_TRUE(r.error);
    EXPECT_NE(r.error->context.find("<stdin>:2: found 2 fields"), std::string::npos) << r.error->context;
  }
  {
    const StandardInput input(::open("/dev/null", O_RDONLY));
    EXPECT_EQ(import_all({"-"}, options).error.value().code, Errc::undecodable);
  }
}

TEST(Inputs, ASparseFileFailsAtOnce) {
  const Scratch scratch;
  for (const char* name : {"sparse.xyz", "sparse.csv", "sparse.ply", "sparse"}) {
    const std::string file = scratch.write(name, "");
    ASSERT_EQ(::truncate(file.c_str(), off_t{2} << 30U), 0);
    const auto start = std::chrono::steady_clock::now();
    const Imported r = import_all({file});
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1)) << name;
    ASSERT_TRUE(r.error);
    EXPECT_EQ(r.error->code, Errc::undecodable);
    EXPECT_NE(r.error->context.find(std::string(name) + ":1: binary data"), std::string::npos) << r.error->context;
  }
  const Imported zeros = import_all({"/dev/zero"});
  ASSERT_TRUE(zeros.error);
  EXPECT_EQ(zeros.error->code, Errc::undecodable);
}

TEST(Inputs, NoRoomForTheSpool) {
  const Scratch scratch;
  scratch.write("s.xyz", "1 2 3\n");
  ASSERT_TRUE(run_command("gzip '" + scratch.path("s.xyz") + "'"));
  const char* before = std::getenv("TMPDIR"); // NOLINT(concurrency-mt-unsafe)
  const std::string kept = before != nullptr ? before : "";
  ASSERT_EQ(::setenv("TMPDIR", "/nowhere", 1), 0); // NOLINT(concurrency-mt-unsafe)
  const Imported r = import_all({scratch.path("s.xyz.gz")});
  ASSERT_EQ(kept.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", kept.c_str(), 1), 0); // NOLINT(concurrency-mt-unsafe)
  ASSERT_TRUE(r.error);
  EXPECT_NE(r.error->context.find("set TMPDIR"), std::string::npos) << r.error->context;
}

TEST(Inputs, AFileThatShrinksIsAnError) {
  const Scratch scratch;
  std::string text;
  while (text.size() < (std::size_t{6} << 20U)) text += "1.5 2.5 3.5\n\n";
  const std::string file = scratch.write("scan.xyz", text);
  auto importer = Importer::open({file}, {}, {}).value();
  ASSERT_EQ(::truncate(file.c_str(), 1000), 0);
  LineBuffer line;
  for (;;) {
    const auto more = importer.next(line);
    if (more && more.value()) continue;
    ASSERT_FALSE(more);
    EXPECT_EQ(more.error().code, Errc::io);
    EXPECT_NE(more.error().context.find("became shorter"), std::string::npos);
    break;
  }
}

} // namespace
} // namespace scansion::test
