// Groups on several threads, handed back in order.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/group_workers.hpp"

#include <ctime>

namespace scansion::cli {

std::int64_t thread_time_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

GroupWorkers::GroupWorkers(unsigned threads, const LevelSpec& levels, Rational resolution_mm, std::uint32_t stream,
                           Commit commit)
    : resolution_(resolution_mm), floor_counts_(levels.floor.in_counts(resolution_mm)), stream_(stream), calibrator_(levels),
      commit_(std::move(commit)), slots_(threads > 1 ? 2 * threads + 1 : 1),
      own_ranker_(resolution_mm, RankUnit::automatic, floor_counts_) {
  for (unsigned i = 0; threads > 1 && i < threads; ++i) threads_.emplace_back([this] { work(); });
}

GroupWorkers::~GroupWorkers() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  task_ready_.notify_all();
  for (std::thread& t : threads_) t.join();
}

void GroupWorkers::rank(Slot& slot, Ranker& ranker) const {
  const std::int64_t start = thread_time_ns();
  rank_group(ranker, slot.group, slot.ranks);
  slot.rank_ns = thread_time_ns() - start;
}

void GroupWorkers::encode(Slot& slot, GroupEncoder& encoder) const {
  const std::int64_t start = thread_time_ns();
  encoder.encode(slot.group, slot.ranks, slot.alpha, stream_, slot.encoded);
  slot.encode_ns = thread_time_ns() - start;
}

void GroupWorkers::work() {
  Ranker ranker(resolution_, RankUnit::automatic, floor_counts_);
  GroupEncoder encoder;
  std::unique_lock lock(mutex_);
  while (true) {
    task_ready_.wait(lock, [&] { return stop_ || !tasks_.empty(); });
    if (stop_) return;
    Slot& slot = *tasks_.front();
    tasks_.pop();
    const bool ranking = slot.state == State::ranking;
    lock.unlock();
    if (ranking)
      rank(slot, ranker);
    else
      encode(slot, encoder);
    lock.lock();
    slot.state = ranking ? State::ranked : State::encoded;
    slot_done_.notify_one();
  }
}

Result<void> GroupWorkers::advance(const Slot* need, bool all) {
  std::unique_lock lock(mutex_);
  while (true) {
    Slot& to_calibrate = slots_[calibrated_ % slots_.size()];
    Slot& to_commit = slots_[committed_ % slots_.size()];
    if (calibrated_ < pushed_ && to_calibrate.state == State::ranked) {
      // The alpha-set depends on the groups before: here, in order, and nowhere else.
      to_calibrate.alpha = calibrator_.next(to_calibrate.group, to_calibrate.ranks, resolution_);
      to_calibrate.state = State::encoding;
      tasks_.push(&to_calibrate);
      task_ready_.notify_one();
      ++calibrated_;
    } else if (committed_ < calibrated_ && to_commit.state == State::encoded) {
      lock.unlock();
      const std::int64_t start = thread_time_ns();
      SCANSION_TRY(commit_(to_commit.group, to_commit.ranks, to_commit.encoded));
      times_.write += thread_time_ns() - start;
      times_.rank += to_commit.rank_ns;
      times_.encode += to_commit.encode_ns;
      lock.lock();
      to_commit.state = State::free;
      ++committed_;
    } else if ((need != nullptr && need->state != State::free) || (all && committed_ < pushed_)) {
      slot_done_.wait(lock);
    } else {
      return success();
    }
  }
}

Result<void> GroupWorkers::push(LineGroup& group) {
  Slot& slot = slots_[pushed_ % slots_.size()];
  if (threads_.empty()) {
    std::swap(slot.group, group);
    rank(slot, own_ranker_);
    slot.alpha = calibrator_.next(slot.group, slot.ranks, resolution_);
    encode(slot, own_encoder_);
    times_.rank += slot.rank_ns;
    times_.encode += slot.encode_ns;
    const std::int64_t start = thread_time_ns();
    SCANSION_TRY(commit_(slot.group, slot.ranks, slot.encoded));
    times_.write += thread_time_ns() - start;
    return success();
  }
  SCANSION_TRY(advance(&slot, false));
  std::swap(slot.group, group);
  {
    const std::scoped_lock lock(mutex_);
    slot.state = State::ranking;
    tasks_.push(&slot);
    ++pushed_;
  }
  task_ready_.notify_one();
  return advance(nullptr, false);
}

Result<void> GroupWorkers::drain() {
  return threads_.empty() ? Result<void>(success()) : advance(nullptr, true);
}

} // namespace scansion::cli
