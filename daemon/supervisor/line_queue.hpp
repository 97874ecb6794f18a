// The bounded queue between a device's acquisition thread and its pipeline worker.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/clock/clock.hpp"
#include "drivers/driver.hpp"

#include <optional>
#include <vector>

namespace scansion {

/// What travels from the device to the worker, in this order: begin (line | gap)* end, begin ...
struct QueueItem {
  enum class Kind : std::uint8_t { begin, line, gap, end };
  Kind kind = Kind::line;
  DeviceFacts facts; ///< begin
  LineBuffer line;
  Gap gap;
  double rounding_mm = 0.0; ///< so far in this run
  SteadyNs since = 0;       ///< when it was pushed
};

/// One producer, one consumer. Bounds: kLines items and kPoints points, of which a single item may pass the latter. Policy: a
/// full queue makes the producer wait, nothing is dropped. Buffers travel round, so the steady state allocates nothing; a
/// buffer that grew beyond kKeptPoints is given back after use.
class LineQueue {
public:
  static constexpr std::size_t kLines = 128;
  static constexpr std::size_t kPoints = std::size_t{1} << 20U;
  static constexpr std::size_t kKeptPoints = std::size_t{1} << 15U;

  explicit LineQueue(Clock& clock) : clock_(clock), slots_(kLines) {}

  /// Swaps `item` in; it comes back with buffers to use again. Waits while the queue is full. False: the queue is closed and
  /// `item` was not taken.
  [[nodiscard]] bool push(QueueItem& item);
  /// Swaps the oldest item out. Waits until `deadline`; false: there is none. Items pushed before close() still come.
  [[nodiscard]] bool pop(QueueItem& item, SteadyNs deadline);
  /// No further push succeeds; both sides wake up.
  void close();
  /// Closed and empty: nothing will ever come.
  [[nodiscard]] bool drained() const;

  [[nodiscard]] std::size_t depth() const;
  /// When the oldest item was pushed; kNever: empty.
  [[nodiscard]] SteadyNs oldest() const;

private:
  [[nodiscard]] bool has_room(std::size_t points) const noexcept;

  Clock& clock_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<QueueItem> slots_; ///< ring
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::size_t points_ = 0;
  bool closed_ = false;
};

} // namespace scansion
