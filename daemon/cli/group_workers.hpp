// Ranks and encodes groups on several threads and hands them back in order, so that the bytes do not depend on the threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/pipeline.hpp"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <queue>
#include <thread>

namespace scansion::cli {

/// Processor time by stage, in ns, summed over threads.
struct StageTimes {
  std::int64_t read = 0, rank = 0, encode = 0, features = 0, write = 0;
};

/// Processor time of the calling thread in ns.
[[nodiscard]] std::int64_t thread_time_ns() noexcept;

/// Each thread has two groups of its own in memory; more threads would wait for the one that reads.
inline constexpr unsigned kMostThreads = 16;

/// Thread-bound to its creator except for its own workers. With one thread everything runs in the caller.
class GroupWorkers {
public:
  /// In the order of the groups, on the caller's thread.
  using Commit = std::function<Result<void>(const LineGroup&, const GroupRanks&, const EncodedGroup&)>;

  GroupWorkers(unsigned threads, const LevelSpec& levels, Rational resolution_mm, std::uint32_t stream, Commit commit);
  ~GroupWorkers();
  GroupWorkers(const GroupWorkers&) = delete;
  GroupWorkers& operator=(const GroupWorkers&) = delete;

  /// Takes the group (swapping an old buffer into `group`). Commits finished groups on the way; blocks while all slots are
  /// busy.
  [[nodiscard]] Result<void> push(LineGroup& group);
  /// Waits for all groups and commits them.
  [[nodiscard]] Result<void> drain();
  [[nodiscard]] const StageTimes& times() const noexcept { return times_; }

private:
  enum class State : std::uint8_t { free, ranking, ranked, encoding, encoded };
  struct Slot {
    State state = State::free;
    LineGroup group;
    GroupRanks ranks;
    AlphaSet alpha;
    EncodedGroup encoded;
    std::int64_t rank_ns = 0, encode_ns = 0;
  };

  void work();
  void rank(Slot& slot, Ranker& ranker) const;
  void encode(Slot& slot, GroupEncoder& encoder) const;
  /// Calibrates and commits what is ready, in order; waits until slot `need` is free when asked to.
  [[nodiscard]] Result<void> advance(const Slot* need, bool all);

  Rational resolution_;
  double floor_counts_;
  std::uint32_t stream_;
  Calibrator calibrator_;
  Commit commit_;
  StageTimes times_;

  std::vector<Slot> slots_;
  std::uint64_t pushed_ = 0, calibrated_ = 0, committed_ = 0; ///< groups so far; a group's slot is its number modulo the count

  std::mutex mutex_; ///< guards Slot::state, tasks_, stop_
  std::condition_variable task_ready_, slot_done_;
  std::queue<Slot*> tasks_;
  bool stop_ = false;
  std::vector<std::thread> threads_;

  Ranker own_ranker_; ///< used when there are no threads
  GroupEncoder own_encoder_;
};

} // namespace scansion::cli
