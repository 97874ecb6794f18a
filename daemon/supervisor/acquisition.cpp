// The acquisition thread of one device.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/acquisition.hpp"

#include <spdlog/spdlog.h>

namespace scansion {
namespace {

/// When each line of a source with a pace is due.
class Pacer {
public:
  Pacer(std::optional<double> lines_per_second, SteadyNs now) : rate_(lines_per_second), start_(now) {}

  /// kNever: not paced.
  [[nodiscard]] SteadyNs due(SteadyNs now) noexcept {
    if (!rate_) return kNever;
    const SteadyNs at = start_ + static_cast<SteadyNs>(static_cast<double>(lines_) * 1e9 / *rate_);
    ++lines_;
    // After a wait on a full disk the schedule starts anew; a burst would not be what the device does.
    if (now - at > kSecond) {
      start_ = now;
      lines_ = 1;
      return now;
    }
    return at;
  }

private:
  std::optional<double> rate_;
  SteadyNs start_;
  std::uint64_t lines_ = 0;
};

class Acquisition {
public:
  Acquisition(SessionShared& shared, Driver& driver, const SessionPolicy& policy, const std::function<void()>& on_fault)
      : shared_(shared), driver_(driver), on_fault_(on_fault),
        machine_(policy, std::hash<std::string>()(shared.config.name) ^ static_cast<std::uint64_t>(shared.clock.steady_ns())) {}

  void run() {
    while (!shared_.stopping() && machine_.state() != SessionState::finished) {
      if (shared_.wanted() != Wanted::run && !wait_for_start()) break;
      auto done = attempt();
      if (!done && driver_.is_over()) {
        if (shared_.lines == 0) shared_.set_error(done.assume_error().context);
        finish();
      } else if (!done && shared_.wanted() == Wanted::run) {
        if (!after_failure(done.assume_error())) break;
      } else if (machine_.state() != SessionState::finished) {
        close(); // by command
      }
    }
    close();
    if (machine_.state() != SessionState::finished) machine_.closed();
    publish();
  }

private:
  /// False: the daemon ends.
  [[nodiscard]] bool wait_for_start() {
    machine_.stopped();
    publish();
    spdlog::warn("{}: stopped by command", shared_.config.name);
    if (!shared_.wait_until_wanted()) return false;
    spdlog::warn("{}: started by command", shared_.config.name);
    shared_.set_error({});
    return true;
  }

  /// False: there will be no other attempt.
  [[nodiscard]] bool after_failure(const Error& error) {
    if (on_fault_ && is_fault(error)) on_fault_();
    report(error);
    if (machine_.state() != SessionState::closed) return shared_.sleep_until(machine_.retry_at());
    if (error.code != Errc::attention) return false;
    // The port is free now, for whoever puts the machine right.
    if (!shared_.wait_until_wanted()) return false;
    spdlog::warn("{}: started by command", shared_.config.name);
    return true;
  }

  void close() {
    driver_.close();
    tell_condition();
  }

  /// What the driver says keeps it from delivering; as loud as a loss.
  void tell_condition() {
    std::string now = driver_.condition();
    if (now == condition_) return;
    if (!now.empty() && now != error_) spdlog::warn("{}: {}", shared_.config.name, now);
    if (!now.empty() || error_.empty()) shared_.set_error(now);
    condition_ = std::move(now);
  }

  /// An absent device is none.
  [[nodiscard]] bool is_fault(const Error& error) const {
    return machine_.state() == SessionState::streaming || machine_.state() == SessionState::stale ||
           machine_.state() == SessionState::held || (machine_.state() == SessionState::starting && error.context != error_);
  }

  void publish() { shared_.set_state(machine_.state()); }

  /// From opening to the end of the run. Without an error: finished, or asked to stop.
  Result<void> attempt() {
    machine_.opening();
    publish();
    SCANSION_TRY(driver_.open());
    machine_.starting();
    publish();
    SCANSION_TRY(facts, driver_.start());
    if (!begin_run(facts)) return success();
    auto ended = stream(facts);
    end_run();
    return ended;
  }

  [[nodiscard]] bool begin_run(const DeviceFacts& facts) {
    machine_.streaming(shared_.clock.steady_ns());
    publish();
    item_.kind = QueueItem::Kind::begin;
    item_.facts = facts;
    item_.rounding_mm = 0.0;
    return shared_.queue.push(item_);
  }

  void end_run() {
    item_.kind = QueueItem::Kind::end;
    item_.rounding_mm = driver_.rounding_mm();
    // Refused only by a closed queue, whose worker ends the run by itself.
    [[maybe_unused]] const bool taken = shared_.queue.push(item_);
  }

  Result<void> stream(const DeviceFacts& facts) {
    Pacer pacer(facts.pace, shared_.clock.steady_ns());
    for (;;) {
      const Wanted wanted = shared_.wanted();
      const bool must_close = wanted == Wanted::leave || (wanted == Wanted::hold && !driver_.can_hold());
      if (shared_.stopping() || must_close) return success();
      const SteadyNs asked = shared_.clock.steady_ns();
      SCANSION_TRY(delivery, driver_.next(item_.line, item_.gap));
      if (delivery == Delivery::nothing || delivery == Delivery::busy) shared_.horizon = asked;
      if (delivery == Delivery::end) {
        finish();
        return success();
      }
      if (delivery == Delivery::line) {
        const SteadyNs due = pacer.due(shared_.clock.steady_ns());
        if (due != kNever && !shared_.sleep_until(due)) return success();
      }
      if (!take(delivery)) return success();
    }
  }

  void finish() {
    machine_.finished();
    publish();
    spdlog::info("{}: finished, {} lines", shared_.config.name, shared_.lines.load());
  }

  /// False: the queue is closed.
  [[nodiscard]] bool take(Delivery delivery) {
    const SessionState before = machine_.state();
    const SteadyNs now = shared_.clock.steady_ns();
    bool taken = true;
    if (delivery == Delivery::nothing || delivery == Delivery::busy) {
      if (driver_.is_at_rest())
        machine_.held();
      else if (delivery == Delivery::busy)
        machine_.delivered(now);
      else
        machine_.silent(now);
      tell_condition();
    } else {
      machine_.delivered(now);
      taken = delivery == Delivery::line ? take_line() : take_gap();
    }
    if (machine_.state() != before) publish();
    return taken;
  }

  [[nodiscard]] bool take_line() {
    std::uint64_t invalid = item_.line.invalid_after;
    for (const Run& run : item_.line.runs) invalid += run.invalid_before;
    const std::uint64_t points = item_.line.points();
    item_.kind = QueueItem::Kind::line;
    item_.rounding_mm = driver_.rounding_mm();
    if (!shared_.queue.push(item_)) return false;
    if (!error_.empty()) recovered();
    shared_.lines += 1;
    shared_.points += points;
    shared_.invalid += invalid;
    shared_.last_line_ns = shared_.clock.realtime_ns();
    return true;
  }

  [[nodiscard]] bool take_gap() {
    item_.kind = QueueItem::Kind::gap;
    shared_.gaps += 1;
    return shared_.queue.push(item_);
  }

  void recovered() {
    spdlog::warn("{}: back, failed attempts before: {}", shared_.config.name, repeats_ + 1); // as loud as the loss
    error_.clear();
    repeats_ = 0;
    shared_.set_error({});
  }

  void report(const Error& error) {
    // Both before the state: who sees the state may ask why, and may start the device at once.
    shared_.set_error(error.context);
    if (error.code == Errc::attention) shared_.want(Wanted::leave);
    machine_.failed(error.code, shared_.clock.steady_ns());
    publish(); // lost, when it was streaming
    driver_.close();
    condition_ = driver_.condition(); // the error says it better
    machine_.settle(shared_.clock.steady_ns());
    if (error.context != error_) {
      spdlog::warn("{}: {}: {}", shared_.config.name, name(machine_.state()), error.context);
      repeats_ = 0;
    } else {
      ++repeats_;
      spdlog::debug("{}: {} (again, {} times)", shared_.config.name, error.context, repeats_);
    }
    error_ = error.context;
    publish();
  }

  SessionShared& shared_;
  Driver& driver_;
  const std::function<void()>& on_fault_;
  SessionMachine machine_;
  QueueItem item_; ///< buffers travel round through the queue
  std::string error_;
  std::string condition_;
  std::uint64_t repeats_ = 0;
};

} // namespace

void acquire(SessionShared& shared, Driver& driver, const SessionPolicy& policy, const std::function<void()>& on_fault) {
  Acquisition(shared, driver, policy, on_fault).run();
  shared.queue.close();
  shared.set_acquisition_done();
}

} // namespace scansion
