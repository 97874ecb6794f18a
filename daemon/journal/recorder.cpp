// Records one device run.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal/recorder.hpp"

#include "pipeline/codec/crc32c.hpp"

#include <spdlog/spdlog.h>

namespace scansion {
namespace {

constexpr std::uint32_t kMaxFileNumber = 1'000'000;

std::uint64_t memory_of(const LineGroup& group) {
  return group.points() * sizeof(std::int32_t) * 3 + group.ulp[0].size() * sizeof(std::int64_t) * 3 +
         group.lines.size() * sizeof(ScanLine) + group.runs.size() * sizeof(Run);
}

std::uint64_t invalid_of(const LineGroup& group) {
  std::uint64_t invalid = 0;
  for (const Run& run : group.runs) invalid += run.invalid_before;
  for (const ScanLine& line : group.lines) invalid += line.invalid_after;
  return invalid;
}

} // namespace

RunRecorder::RunRecorder(const JournalPorts& ports, Clock& clock, const RecorderSettings& settings, RecordingFacts facts)
    : ports_(ports), clock_(clock), settings_(settings), facts_(std::move(facts)) {
  if (!ports_.free_bytes) {
    ports_.free_bytes = [&directory = ports.directory] { return directory.free_bytes(); };
  }
}

Result<void> RunRecorder::check_space() const {
  SCANSION_TRY(free, ports_.free_bytes());
  if (free >= settings_.min_free_bytes) return success();
  return fail(Errc::io, ports_.directory.path(), ": ", std::to_string(free >> 20U),
              " MB free, less than min_free_mb = ", std::to_string(settings_.min_free_bytes >> 20U), "; free some space");
}

std::int64_t RunRecorder::first_line_time() const {
  const auto stamp_of = [](const LineGroup& group) -> std::optional<std::int64_t> {
    return group.lines.empty() ? std::nullopt : group.lines.front().stamps.host_realtime_ns;
  };
  if (const auto stamp = writing_ != nullptr ? stamp_of(*writing_) : std::nullopt) return *stamp;
  for (const Pending& pending : pending_) {
    if (const auto stamp = stamp_of(pending.group)) return *stamp;
  }
  return clock_.realtime_ns();
}

Result<void> RunRecorder::open_file() {
  const std::int64_t begun = first_line_time();
  for (; next_number_ <= kMaxFileNumber; ++next_number_) {
    const std::string path = ports_.directory.file_path(facts_.device, begun, next_number_);
    facts_.started_ns = begun;
    facts_.stream = crc32c(0, std::as_bytes(std::span(path).subspan(ports_.directory.path().size())));
    facts_.features = settings_.features.has_value();
    auto sink = ports_.open(path, facts_);
    if (!sink && sink.assume_error().code == Errc::exists) continue;
    if (!sink) return std::move(sink).assume_error();
    SCANSION_TRY(count_mm, resolution_mm(facts_.lattice));
    sink_ = std::move(sink).assume_value();
    pipeline_.emplace(facts_.levels, count_mm, facts_.stream);
    if (settings_.features) stage_.emplace(facts_.lattice, *settings_.features);
    is_encoded_ = false;
    groups_in_file_ = 0;
    opened_at_ = clock_.steady_ns();
    ++next_number_;
    status_.path = path;
    if (auto synced = ports_.directory.sync(); !synced) spdlog::warn("{}", synced.assume_error().context);
    spdlog::info("{}: recording into {}", facts_.device, path);
    return success();
  }
  return fail(Errc::cannot_create, ports_.directory.path(), ": no file name left for ", facts_.device,
              "; move recordings away");
}

Result<void> RunRecorder::write_group(LineGroup& group) {
  SCANSION_TRY(check_space());
  if (!sink_) {
    writing_ = &group;
    auto opened = open_file();
    writing_ = nullptr;
    SCANSION_TRY(std::move(opened));
  }
  if (!is_encoded_) {
    group.number = groups_in_file_;
    pipeline_->process(group, encoded_);
    is_encoded_ = true;
  }
  SCANSION_TRY(sink_->append(encoded_, group.points(), group.runs.size(), invalid_of(group)));
  note_written(group);
  find_features(group);
  return success();
}

/// The group is safe by now: what cannot be written here waits in the sink and is written with what is found next.
void RunRecorder::find_features(const LineGroup& group) {
  if (!stage_) return;
  found_.group = group.number;
  stage_->add(group, pipeline_->ranks().distance, found_);
  if (found_.empty()) return;
  if (auto written = sink_->append(found_, last_log_time_ns_); !written)
    spdlog::warn("{}: feature lines wait: {}", facts_.device, written.assume_error().context);
}

void RunRecorder::finish_features() {
  if (!stage_) return;
  stage_->finish(found_);
  if (auto written = sink_->append(found_, last_log_time_ns_); !written)
    spdlog::error("{}: the last feature lines are lost: {}", facts_.device, written.assume_error().context);
  stage_.reset();
}

void RunRecorder::note_written(const LineGroup& group) {
  is_encoded_ = false;
  ++groups_in_file_;
  last_log_time_ns_ = encoded_.last_time_ns;
  last_line_time_ = group.lines.back().stamps.host_realtime_ns;
  ++status_.groups_written;
  status_.lines_written += group.lines.size();
  if (sync_at_ == kNever) sync_at_ = clock_.steady_ns() + settings_.sync_interval;
}

Result<void> RunRecorder::write_front() {
  Pending& front = pending_.front();
  if (!front.group.lines.empty()) return write_group(front.group);
  SCANSION_TRY(check_space());
  if (!sink_) {
    SCANSION_TRY(open_file());
  }
  SCANSION_TRY(sink_->append(front.gap, last_log_time_ns_));
  if (stage_) stage_->skip(front.gap);
  if (sync_at_ == kNever) sync_at_ = clock_.steady_ns() + settings_.sync_interval;
  return success();
}

void RunRecorder::block(const Error& error) {
  retry_at_ = clock_.steady_ns() + settings_.retry;
  if (status_.blocked.empty()) spdlog::error("{}: recording is blocked: {}", facts_.device, error.context);
  status_.blocked = error.context;
}

void RunRecorder::unblock() {
  if (status_.blocked.empty()) return;
  spdlog::error("{}: recording goes on", facts_.device); // as loud as the loss, so that both are seen together
  status_.blocked.clear();
}

void RunRecorder::add(LineGroup& group, SteadyNs since) {
  if (pending_.empty()) {
    if (auto written = write_group(group)) {
      rotate_if_due();
      return;
    } else {
      block(written.assume_error());
    }
  }
  Pending pending;
  std::swap(pending.group, group);
  pending.since = since;
  pending.bytes = memory_of(pending.group);
  pending_bytes_ += pending.bytes;
  pending_.push_back(std::move(pending));
  if (status_.blocked.empty()) drain();
}

void RunRecorder::add(Gap gap) {
  Pending pending;
  pending.since = clock_.steady_ns();
  pending.bytes = sizeof(Pending) + gap.reason.size();
  pending.gap = std::move(gap);
  pending_bytes_ += pending.bytes;
  pending_.push_back(std::move(pending));
  if (status_.blocked.empty()) drain();
}

void RunRecorder::drain() {
  while (!pending_.empty()) {
    // Gaps before the first group wait for it: they alone make no recording.
    const bool has_group =
        std::any_of(pending_.begin(), pending_.end(), [](const Pending& p) { return !p.group.lines.empty(); });
    if (!sink_ && !has_group) return;
    if (auto written = write_front(); !written) {
      block(written.assume_error());
      return;
    }
    unblock();
    pending_bytes_ -= pending_.front().bytes;
    pending_.pop_front();
    rotate_if_due();
  }
}

void RunRecorder::tick() {
  const SteadyNs now = clock_.steady_ns();
  if (!status_.blocked.empty() && now >= retry_at_) drain();
  if (sink_ && now >= sync_at_) {
    sync_at_ = kNever;
    if (auto synced = sink_->sync(); !synced) {
      spdlog::error("{}: {}: {}; lines of the last {} ms may not be on the disk", facts_.device, status_.path,
                    synced.assume_error().context, settings_.sync_interval / kMillisecond);
      close_file("its sync failed");
    }
  }
  rotate_if_due();
}

void RunRecorder::rotate_if_due() {
  // A refused group belongs to the open file until it is written.
  if (!sink_ || groups_in_file_ == 0 || is_encoded_) return;
  if (sink_->bytes() >= settings_.rotate_bytes)
    close_file("it is full");
  else if (clock_.steady_ns() - opened_at_ >= settings_.rotate_age)
    close_file("it is old");
}

void RunRecorder::close_file(std::string_view why) {
  if (!sink_) return;
  finish_features();
  if (auto finished = sink_->finish(last_line_time_.value_or(clock_.realtime_ns()), rounding_mm_); !finished) {
    spdlog::error("{}: {} stays without its end: {}; the next start of the daemon completes it", facts_.device, status_.path,
                  finished.assume_error().context);
  } else {
    spdlog::info("{}: finished {}, {} groups, {} bytes: {}", facts_.device, status_.path, groups_in_file_, sink_->bytes(), why);
  }
  sink_.reset();
  pipeline_.reset();
  is_encoded_ = false;
  sync_at_ = kNever;
  status_.last_path = std::move(status_.path);
  status_.path.clear();
}

SteadyNs RunRecorder::next_deadline() const noexcept {
  SteadyNs next = sync_at_;
  if (!status_.blocked.empty()) next = std::min(next, retry_at_);
  if (sink_ && groups_in_file_ > 0) next = std::min(next, opened_at_ + settings_.rotate_age);
  return next;
}

SteadyNs RunRecorder::oldest_unwritten() const noexcept {
  return pending_.empty() ? kNever : pending_.front().since;
}

void RunRecorder::finish() {
  drain();
  std::uint64_t lost = 0;
  for (const Pending& pending : pending_) lost += pending.group.lines.size();
  if (lost > 0) {
    spdlog::error("{}: {} lines in {} groups are lost: {}", facts_.device, lost, pending_.size(), status_.blocked);
    status_.lost_lines += lost;
  }
  pending_.clear();
  pending_bytes_ = 0;
  status_.blocked.clear();
  close_file("the run ended");
}

RecorderStatus RunRecorder::status() const {
  RecorderStatus out = status_;
  out.pending_groups = pending_.size();
  out.bytes = sink_ ? sink_->bytes() : 0;
  return out;
}

} // namespace scansion
