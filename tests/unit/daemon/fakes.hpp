// Stand-ins with faults for the daemon's tests: a recording that can fail, a device that follows a script.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/journal/recorder.hpp"
#include "drivers/driver.hpp"

#include <atomic>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <mutex>
#include <thread>
#include <unistd.h>

namespace scansion::test {

/// A directory of its own that goes away with the test.
class TemporaryDirectory {
public:
  TemporaryDirectory() {
    std::string name = std::filesystem::temp_directory_path() / "scansion-test-XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

private:
  std::string path_;
};

/// What fake recordings saw, and which of their calls fail.
struct FakeDisk {
  struct File {
    std::string path;
    RecordingFacts facts;
    std::vector<std::uint64_t> groups;                          ///< numbers
    std::vector<std::pair<std::uint64_t, std::uint32_t>> lines; ///< first index, count
    std::vector<Gap> gaps;
    std::uint64_t points = 0;
    int syncs = 0;
    bool finished = false;
    double rounding_mm = 0.0;
  };
  std::mutex mutex;
  std::vector<File> files;
  std::atomic<bool> full{false}; ///< append and create fail
  std::atomic<bool> sync_fails{false};
  std::atomic<std::uint64_t> free{1ULL << 40U};
  std::atomic<std::uint64_t> bytes_per_group{100};

  [[nodiscard]] std::vector<File> seen() {
    const std::lock_guard lock(mutex);
    return files;
  }
  [[nodiscard]] std::uint64_t lines_seen() {
    std::uint64_t lines = 0;
    for (const File& file : seen()) {
      for (const auto& range : file.lines) lines += range.second;
    }
    return lines;
  }
};

class FakeSink final : public RecordingSink {
public:
  FakeSink(FakeDisk& disk, std::size_t file) : disk_(disk), file_(file) {}

  Result<void> append(const EncodedGroup& group, std::uint64_t points, std::uint64_t, std::uint64_t) override {
    if (disk_.full) return fail(Errc::io, "no space left");
    const std::lock_guard lock(disk_.mutex);
    auto& file = disk_.files[file_];
    file.groups.push_back(group.number);
    file.lines.emplace_back(group.first_line, group.line_count);
    file.points += points;
    bytes_ += disk_.bytes_per_group;
    return success();
  }
  Result<void> append(const Gap& gap, std::uint64_t) override {
    if (disk_.full) return fail(Errc::io, "no space left");
    const std::lock_guard lock(disk_.mutex);
    disk_.files[file_].gaps.push_back(gap);
    return success();
  }
  Result<void> append(FeatureReport& report, std::uint64_t /*time*/) override {
    report.clear();
    return success();
  }
  Result<void> sync() override {
    if (disk_.sync_fails) return fail(Errc::io, "sync failed");
    const std::lock_guard lock(disk_.mutex);
    ++disk_.files[file_].syncs;
    return success();
  }
  Result<void> finish(std::int64_t, double rounding_mm) override {
    const std::lock_guard lock(disk_.mutex);
    disk_.files[file_].finished = true;
    disk_.files[file_].rounding_mm = rounding_mm;
    return success();
  }
  std::uint64_t bytes() const noexcept override { return bytes_; }

private:
  FakeDisk& disk_;
  std::size_t file_;
  std::uint64_t bytes_ = 0;
};

inline JournalPorts fake_ports(const JournalDirectory& directory, FakeDisk& disk) {
  return {directory,
          [&disk](const std::string& path, const RecordingFacts& facts) -> Result<std::unique_ptr<RecordingSink>> {
            if (disk.full) return fail(Errc::io, "no space left");
            const std::lock_guard lock(disk.mutex);
            for (const auto& file : disk.files) {
              if (file.path == path) return fail(Errc::exists, path);
            }
            FakeDisk::File file;
            file.path = path;
            file.facts = facts;
            disk.files.push_back(std::move(file));
            return std::unique_ptr<RecordingSink>(std::make_unique<FakeSink>(disk, disk.files.size() - 1));
          },
          [&disk]() -> Result<std::uint64_t> { return disk.free.load(); }};
}

/// A zigzag of `points` points.
inline void fill_line(LineBuffer& line, std::uint32_t points) {
  line.clear();
  for (std::uint32_t i = 0; i < points; ++i) {
    line.xyz[0].push_back(static_cast<std::int32_t>(i));
    line.xyz[1].push_back(0);
    line.xyz[2].push_back(i % 2 == 0 ? 0 : 7);
  }
  if (points > 0) line.runs.push_back({0, points, 0});
}

inline DeviceFacts test_facts() {
  DeviceFacts facts;
  facts.lattice.resolution = {1, 100};
  return facts;
}

/// A device whose calls are functions. Without them: opens, starts, is silent.
class ScriptedDriver final : public Driver {
public:
  struct Script {
    std::function<Result<void>()> open;
    std::function<Result<DeviceFacts>()> start;
    std::function<Result<Delivery>(LineBuffer&, Gap&)> next;
    std::function<bool()> is_over;
    double rounding_mm = 0.0;
  };
  explicit ScriptedDriver(Script script) : script_(std::move(script)) {}

  Result<void> open() override { return script_.open ? script_.open() : Result<void>(success()); }
  Result<DeviceFacts> start() override { return script_.start ? script_.start() : Result<DeviceFacts>(test_facts()); }
  Result<Delivery> next(LineBuffer& line, Gap& gap) override {
    if (script_.next) return script_.next(line, gap);
    std::this_thread::yield();
    return Delivery::nothing;
  }
  bool is_over() const noexcept override { return script_.is_over && script_.is_over(); }
  void close() noexcept override {}
  double rounding_mm() const noexcept override { return script_.rounding_mm; }

private:
  Script script_;
};

/// Waits, in the machine's time and not for ever, until `condition` holds.
template <class Condition>
[[nodiscard]] bool eventually(Condition condition) {
  SystemClock clock;
  std::mutex mutex;
  std::condition_variable nobody;
  const SteadyNs deadline = clock.steady_ns() + 20 * kSecond;
  while (!condition()) {
    if (clock.steady_ns() > deadline) return false;
    std::unique_lock lock(mutex);
    clock.wait_until(lock, nobody, clock.steady_ns() + kMillisecond);
  }
  return true;
}

} // namespace scansion::test
