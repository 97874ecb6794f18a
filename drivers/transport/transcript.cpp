// A transcript played as the device it was taken from.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/transcript.hpp"

#include "drivers/transport/raw_event.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

namespace scansion {
namespace {

/// A played driver's timers may run this much later than then: its time stands still between events.
constexpr std::int64_t kSlackNs = 50'000'000;

class TranscriptTransport final : public Transport {
public:
  explicit TranscriptTransport(std::string path) : name_(std::move(path)) {}

  using Transport::write;
  Result<void> open() override {
    if (!file_.is_open()) {
      file_.open(name_, std::ios::binary);
      if (!file_) return system_error(name_, errno == 0 ? EIO : errno);
      SCANSION_TRY(advance());
    }
    // What the last run did not take (a driver that gave up earlier than it was given up then).
    while (event_ && event_->kind != RawEvent::Kind::opened) {
      SCANSION_TRY(advance());
    }
    if (!event_) {
      at_end_ = true;
      return success();
    }
    now_ = event_->at;
    is_begun_ = false;
    return advance();
  }

  Result<Arrival> read(std::span<std::uint8_t> to, std::int64_t deadline_ns) override {
    if (at_end_) return Arrival{0, now_, true};
    if (event_) {
      switch (event_->kind) {
        case RawEvent::Kind::received: return give(to);
        case RawEvent::Kind::lost: return lose();
        case RawEvent::Kind::ended: return Arrival{0, now_, true};
        case RawEvent::Kind::sent:
        case RawEvent::Kind::opened:
        case RawEvent::Kind::closed: break;
      }
    }
    if (!event_ || event_->kind == RawEvent::Kind::closed || event_->kind == RawEvent::Kind::opened) return stop();
    // The device waited for the driver, which sent this at its time at the latest.
    const std::int64_t latest_ns = event_->at.monotonic_ns + kSlackNs;
    if (now_.monotonic_ns < latest_ns) {
      now_ = shifted(std::min(std::max(deadline_ns, now_.monotonic_ns), latest_ns));
      return Arrival{0, now_, false};
    }
    if (!std::exchange(is_offered_, true)) return Arrival{0, now_, false};
    // The driver sends nothing by itself here: then it was told to stop, and this is its farewell.
    while (event_ && event_->kind != RawEvent::Kind::closed && event_->kind != RawEvent::Kind::opened) {
      SCANSION_TRY(advance());
    }
    return stop();
  }

  Result<void> write(std::span<const std::uint8_t> bytes, std::int64_t /*deadline_ns*/) override {
    while (!bytes.empty()) {
      if (at_end_) return success();
      if (event_ && event_->kind == RawEvent::Kind::lost) return lose().assume_error();
      if (!event_ || event_->kind == RawEvent::Kind::closed) return success(); // the farewell of a run that ended
      if (event_->kind != RawEvent::Kind::sent) return mismatch("bytes that came then are not read yet");
      const std::size_t shared = std::min(bytes.size(), event_->bytes.size() - taken_);
      const auto* then = event_->bytes.data() + taken_;
      if (!std::equal(then, then + shared, bytes.begin())) {
        // What a timer sends now and did not then: it was told to stop before, and the last thing sent is its farewell.
        return is_begun_ && taken_ == 0 ? skip_farewell() : mismatch("something else was sent then");
      }
      now_ = event_->at;
      is_begun_ = true;
      taken_ += shared;
      bytes = bytes.subspan(shared);
      if (taken_ == event_->bytes.size()) {
        SCANSION_TRY(advance());
      }
    }
    return success();
  }

  void close() noexcept override {}
  Moment now() const noexcept override { return now_; }
  const std::string& name() const noexcept override { return name_; }
  bool is_live() const noexcept override { return false; }
  bool is_over() const noexcept override { return at_end_; }

private:
  /// To the next event; none at the end of the file.
  Result<void> advance() {
    taken_ = 0;
    is_offered_ = false;
    while (std::getline(file_, text_)) {
      ++line_;
      if (text_.empty() || text_.front() == '#') continue;
      auto event = parse_event(text_);
      if (!event) return fail(Errc::undecodable, name_, ":", std::to_string(line_), ": ", event.assume_error().context);
      event_ = std::move(event).assume_value();
      return success();
    }
    event_.reset();
    return success();
  }

  Result<Arrival> give(std::span<std::uint8_t> to) {
    const std::size_t count = std::min(to.size(), event_->bytes.size() - taken_);
    std::copy_n(event_->bytes.data() + taken_, count, to.data());
    now_ = event_->at;
    is_begun_ = true;
    taken_ += count;
    if (taken_ == event_->bytes.size()) {
      SCANSION_TRY(advance());
    }
    return Arrival{count, now_, false};
  }

  Result<Arrival> lose() {
    const std::string why(event_->bytes.begin(), event_->bytes.end());
    now_ = event_->at;
    SCANSION_TRY(advance());
    return fail(Errc::unavailable, name_, ":", std::to_string(line_), ": then: ", why);
  }

  /// Fails when more than one thing was sent before the device was closed.
  Result<void> skip_farewell() {
    SCANSION_TRY(advance());
    while (event_ && event_->kind != RawEvent::Kind::closed && event_->kind != RawEvent::Kind::opened) {
      if (event_->kind == RawEvent::Kind::sent) return mismatch("something else was sent then");
      SCANSION_TRY(advance());
    }
    return success();
  }

  /// The driver was stopped or gave up here. Without a later run that is the end of the transcript.
  Result<Arrival> stop() {
    while (event_ && event_->kind == RawEvent::Kind::closed) {
      now_ = event_->at;
      SCANSION_TRY(advance());
    }
    if (event_) return fail(Errc::unavailable, name_, ":", std::to_string(line_), ": then the device was closed");
    at_end_ = true;
    return Arrival{0, now_, true};
  }

  Error mismatch(std::string_view reason) const {
    return make_error(Errc::undecodable, {name_, ":", std::to_string(line_), ": ", reason,
                                          "; was the transcript taken with the same configuration?"});
  }

  /// The moment `monotonic_ns`, on both clocks.
  Moment shifted(std::int64_t monotonic_ns) const noexcept {
    return {monotonic_ns, now_.realtime_ns + (monotonic_ns - now_.monotonic_ns)};
  }

  const std::string name_;
  std::ifstream file_;
  std::string text_;
  std::uint64_t line_ = 0;
  std::optional<RawEvent> event_; ///< the next one
  std::size_t taken_ = 0;         ///< of its bytes
  Moment now_;
  bool is_begun_ = false;   ///< something was sent or received since the device was opened
  bool is_offered_ = false; ///< the driver could have sent what it sent then, and did not
  bool at_end_ = false;
};

} // namespace

std::unique_ptr<Transport> transcript_transport(std::string path) {
  return std::make_unique<TranscriptTransport>(std::move(path));
}

} // namespace scansion
