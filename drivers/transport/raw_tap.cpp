// A transport that keeps what goes through it.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/raw_tap.hpp"

#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace scansion {

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
  if (::write(file.get(), lead.data(), lead.size()) != static_cast<ssize_t>(lead.size())) {
    return system_error(path_ + ": cannot write the transcript", errno);
  }
  file_ = std::move(file);
  return success();
}

Result<void> RawTap::note(RawEvent::Kind kind, const Moment& at, std::span<const std::uint8_t> bytes) {
  ring_->push(kind, at, bytes);
  if (!file_) return success();
  line_.clear();
  append_event(line_, kind, at, bytes);
  std::string_view rest = line_;
  while (!rest.empty()) {
    const ssize_t put = ::write(file_.get(), rest.data(), rest.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return system_error(path_ + ": writing the transcript failed", errno);
    rest.remove_prefix(static_cast<std::size_t>(put));
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
