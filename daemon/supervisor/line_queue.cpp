// The bounded queue between a device's acquisition thread and its pipeline worker.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/line_queue.hpp"

namespace scansion {
namespace {

/// Clears what is left of an item that was taken, and lets go of a buffer that one huge line blew up.
void recycle(QueueItem& item) {
  const std::size_t capacity = item.line.xyz[0].capacity();
  if (capacity > LineQueue::kKeptPoints || item.line.runs.capacity() > LineQueue::kKeptPoints) item.line = LineBuffer();
  item.line.clear();
  item.gap = Gap();
}

} // namespace

bool LineQueue::has_room(std::size_t points) const noexcept {
  return count_ < slots_.size() && (count_ == 0 || points_ + points <= kPoints);
}

bool LineQueue::push(QueueItem& item) {
  const std::size_t points = item.line.points();
  std::unique_lock lock(mutex_);
  while (!closed_ && !has_room(points)) clock_.wait_until(lock, changed_, kNever);
  if (closed_) return false;
  item.since = clock_.steady_ns();
  std::swap(slots_[(first_ + count_) % slots_.size()], item);
  ++count_;
  points_ += points;
  lock.unlock();
  changed_.notify_all();
  recycle(item);
  return true;
}

bool LineQueue::pop(QueueItem& item, SteadyNs deadline) {
  recycle(item);
  std::unique_lock lock(mutex_);
  while (count_ == 0 && !closed_ && clock_.steady_ns() < deadline) clock_.wait_until(lock, changed_, deadline);
  if (count_ == 0) return false;
  std::swap(item, slots_[first_]);
  first_ = (first_ + 1) % slots_.size();
  --count_;
  points_ -= item.line.points();
  lock.unlock();
  changed_.notify_all();
  return true;
}

void LineQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

bool LineQueue::drained() const {
  const std::lock_guard lock(mutex_);
  return closed_ && count_ == 0;
}

std::size_t LineQueue::depth() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

SteadyNs LineQueue::oldest() const {
  const std::lock_guard lock(mutex_);
  return count_ == 0 ? kNever : slots_[first_].since;
}

} // namespace scansion
