// The pipeline worker of one device: lines to groups to recordings.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/worker.hpp"

namespace scansion {
namespace {

/// The worker wakes at least this often, so that a beat that stays away means that it is stuck.
constexpr SteadyNs kBeat = 500 * kMillisecond;

/// How often the worker looks whether the device has been silent for long enough.
constexpr SteadyNs kLook = 20 * kMillisecond;

class Worker {
public:
  Worker(SessionShared& shared, const SessionSettings& settings, const JournalPorts& ports)
      : shared_(shared), settings_(settings), ports_(ports) {}

  void run() {
    QueueItem item;
    while (is_ending_ || !shared_.queue.drained()) {
      const SteadyNs deadline = next_deadline();
      // When stopping, the queue is emptied whatever the disk says: its bound is small, and the run's end tries once more.
      if (must_wait() && !shared_.stopping())
        static_cast<void>(shared_.sleep_until(deadline));
      else if (!is_ending_ && shared_.queue.pop(item, deadline))
        take(item);
      tick();
    }
    end_run();
    publish();
  }

private:
  /// Nothing more may be taken from the queue before the disk has taken what is pending.
  [[nodiscard]] bool must_wait() const { return recorder_ && (is_ending_ || recorder_->full()); }

  [[nodiscard]] SteadyNs next_deadline() const {
    SteadyNs deadline = shared_.clock.steady_ns() + kBeat;
    if (recorder_) deadline = std::min(deadline, recorder_->next_deadline());
    return std::min(deadline, group_deadline());
  }

  [[nodiscard]] SteadyNs group_deadline() const {
    if (builder_.empty() || !facts_.live) return kNever;
    const SteadyNs due = group_since_ + settings_.group_age;
    if (!group_begin_) return due;
    return std::max(due, shared_.clock.steady_ns() + kLook);
  }

  void take(QueueItem& item) {
    switch (item.kind) {
      case QueueItem::Kind::begin: begin_run(item.facts); break;
      case QueueItem::Kind::line: take_line(item); break;
      case QueueItem::Kind::gap: take_gap(item.gap); break;
      case QueueItem::Kind::end:
        note_rounding(item);
        close_group();
        is_ending_ = true;
        break;
    }
  }

  void begin_run(const DeviceFacts& facts) {
    end_run();
    facts_ = facts;
    builder_ = GroupBuilder();
    RecordingFacts recording;
    recording.device = shared_.config.name;
    recording.lattice = facts.lattice;
    recording.levels = settings_.levels;
    recording.level_count = settings_.levels.count;
    recording.stored_levels = settings_.levels.count + 1;
    recording.gap_mm = facts.gap_mm;
    recording.rounding_mm = facts.rounding_mm;
    RecorderSettings recorder = settings_.recorder;
    recorder.features = shared_.config.features;
    recorder_.emplace(ports_, shared_.clock, recorder, std::move(recording));
  }

  void note_rounding(const QueueItem& item) {
    if (recorder_) recorder_->note_rounding(item.rounding_mm);
  }

  void take_line(const QueueItem& item) {
    note_rounding(item);
    if (builder_.must_close_before(item.line) || is_older_than_group(item.line)) close_group();
    if (builder_.empty()) {
      group_since_ = item.since;
      group_begin_ = item.line.stamps.host_monotonic_ns;
    }
    builder_.add(item.line);
    if (builder_.full()) close_group();
  }

  /// Lines with stamps are grouped by these, so that a device and its raw transcript give the same groups.
  [[nodiscard]] bool is_older_than_group(const LineBuffer& line) const {
    const auto& stamp = line.stamps.host_monotonic_ns;
    return !builder_.empty() && group_begin_ && stamp && *stamp - *group_begin_ >= settings_.group_age;
  }

  /// No line that still belongs to the open group can come.
  [[nodiscard]] bool is_group_over() const {
    if (builder_.empty() || !facts_.live) return false;
    if (!group_begin_) return shared_.clock.steady_ns() >= group_deadline();
    // The horizon is read first: what was pushed before it moved is in the queue.
    return shared_.horizon >= *group_begin_ + settings_.group_age && shared_.queue.depth() == 0;
  }

  void take_gap(Gap& gap) {
    close_group();
    gap.first = builder_.next_line();
    builder_.skip(gap.count.value_or(0));
    if (recorder_) recorder_->add(std::move(gap));
  }

  void close_group() {
    if (builder_.empty() || !recorder_) return;
    builder_.take(group_);
    if (shared_.tail != nullptr) tell_lines(*shared_.tail, shared_.config.name, group_);
    recorder_->add(group_, group_since_);
    publish();
  }

  void end_run() {
    is_ending_ = false;
    close_group();
    if (!recorder_) return;
    recorder_->finish();
    add_totals(recorder_->status());
    recorder_.reset();
    publish();
  }

  void tick() {
    if (is_group_over()) close_group();
    if (recorder_ && shared_.clock.steady_ns() >= recorder_->next_deadline()) {
      recorder_->tick();
      publish();
    }
    // The run ends when its last group is written: a source that came to its end costs nothing to wait for.
    if (is_ending_ && (shared_.stopping() || !recorder_ || !recorder_->is_blocked())) end_run();
    SteadyNs oldest = builder_.empty() ? kNever : group_since_;
    if (recorder_) oldest = std::min(oldest, recorder_->oldest_unwritten());
    shared_.oldest_unwritten = oldest;
    shared_.worker_beat = shared_.clock.steady_ns();
  }

  /// Counters of earlier runs stay in the sum.
  void add_totals(const RecorderStatus& run) {
    before_.groups_written += run.groups_written;
    before_.lines_written += run.lines_written;
    before_.lost_lines += run.lost_lines;
    if (!run.last_path.empty()) before_.last_path = run.last_path;
  }

  void publish() {
    RecorderStatus now = before_;
    if (recorder_) {
      const RecorderStatus run = recorder_->status();
      now = run;
      now.groups_written += before_.groups_written;
      now.lines_written += before_.lines_written;
      now.lost_lines += before_.lost_lines;
      if (now.last_path.empty()) now.last_path = before_.last_path;
    }
    shared_.set_recorder(std::move(now));
  }

  SessionShared& shared_;
  const SessionSettings& settings_;
  const JournalPorts& ports_;
  DeviceFacts facts_;
  GroupBuilder builder_;
  LineGroup group_;
  SteadyNs group_since_ = 0;
  std::optional<SteadyNs> group_begin_; ///< stamp of its first line
  bool is_ending_ = false;              ///< the device's run is over, its recording not yet
  std::optional<RunRecorder> recorder_;
  RecorderStatus before_; ///< sums over the runs that ended
};

} // namespace

void record_lines(SessionShared& shared, const SessionSettings& settings, const JournalPorts& ports) {
  shared.worker_beat = shared.clock.steady_ns();
  Worker(shared, settings, ports).run();
  shared.set_worker_done();
}

} // namespace scansion
