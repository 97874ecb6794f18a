// A transport that keeps what goes through it.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/raw_tap.hpp"

#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace scansion {
namespace {

constexpr std::string_view kFull = "# the bound of this transcript is reached; what came later is not here\n";

/// Whether an earlier process left it full.
bool ends_full(int fd, off_t end) {
  char last[kFull.size()];
  const auto size = static_cast<off_t>(kFull.size());
  return end >= size && ::pread(fd, last, kFull.size(), end - size) == size && std::string_view(last, kFull.size()) == kFull;
}

} // namespace

Result<void> RawTap::open_transcript() {
  if (path_.empty() || file_) return success();
  UniqueFd file(::open(path_.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NOCTTY, 0640));
  if (!file) return system_error(path_ + ": cannot write the transcript", errno);
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0)
    return fail(Errc::unavailable, path_, ": is being written by another device");
  const off_t end = ::lseek(file.get(), 0, SEEK_END);
  char last = '\n';
  if (end > 0 && ::pread(file.get(), &last, 1, end - 1) != 1) return system_error(path_ + ": cannot be read", errno);
  // A line torn by a power cut stays a line of its own; reading the transcript reports it.
  const std::string_view lead = end > 0 ? (last == '\n' ? std::string_view() : std::string_view("\n")) : kTranscriptHeading;
  size_ = static_cast<std::uint64_t>(end);
  is_full_ = ends_full(file.get(), end);
  file_ = std::move(file);
  return put(lead);
}

Result<void> RawTap::note(RawEvent::Kind kind, const Moment& at, std::span<const std::uint8_t> bytes) {
  ring_->push(kind, at, bytes);
  if (!file_) return success();
  line_.clear();
  append_event(line_, kind, at, bytes);
  if (!is_full_ && size_ + line_.size() <= bound_) return put(line_);
  ring_->note_dropped();
  if (std::exchange(is_full_, true)) return success();
  return put(kFull);
}

Result<void> RawTap::put(std::string_view text) {
  size_ += text.size();
  while (!text.empty()) {
    const ssize_t written = ::write(file_.get(), text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return system_error(path_ + ": writing the transcript failed", errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return success();
}

void RawTap::note_lost(const Error& error) {
  const std::string& why = error.context;
  // The device is lost already; a transcript that cannot take this line either changes nothing.
  static_cast<void>(note(RawEvent::Kind::lost, now(), {reinterpret_cast<const std::uint8_t*>(why.data()), why.size()}));
}

Result<void> RawTap::open() {
  close();
  SCANSION_TRY(open_transcript());
  SCANSION_TRY(inner_->open());
  is_open_ = true;
  return note(RawEvent::Kind::opened, now(), {});
}

Result<Arrival> RawTap::read(std::span<std::uint8_t> to, std::int64_t deadline_ns) {
  auto arrival = inner_->read(to, deadline_ns);
  if (!arrival) {
    note_lost(arrival.assume_error());
    return arrival;
  }
  const Arrival& got = arrival.assume_value();
  if (got.count > 0) {
    SCANSION_TRY(note(RawEvent::Kind::received, got.at, to.first(got.count)));
  } else if (got.end) {
    SCANSION_TRY(note(RawEvent::Kind::ended, got.at, {}));
  }
  return arrival;
}

Result<void> RawTap::write(std::span<const std::uint8_t> bytes, std::int64_t deadline_ns) {
  SCANSION_TRY(note(RawEvent::Kind::sent, now(), bytes));
  auto written = inner_->write(bytes, deadline_ns);
  if (!written) note_lost(written.assume_error());
  return written;
}

void RawTap::close() noexcept {
  if (std::exchange(is_open_, false)) static_cast<void>(note(RawEvent::Kind::closed, now(), {}));
  inner_->close();
}

} // namespace scansion
