// Transport + decoder + handshake = driver. A new device on a port derives from this and adds a decoder and an entry.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/driver.hpp"
#include "drivers/port/decoder.hpp"
#include "drivers/transport/options.hpp"

namespace scansion {

/// Thread-bound like every driver. It reads bytes, hands them to the decoder, puts host times on lines that have none, and
/// reports what was lost while the device was away. Derived classes say how a device is started, watched and left.
class PortDriver : public Driver {
public:
  Result<void> open() final;
  Result<DeviceFacts> start() final;
  Result<Delivery> next(LineBuffer& line, Gap& gap) final;
  void close() noexcept final;
  [[nodiscard]] bool is_over() const noexcept final { return transport_->is_over(); }
  [[nodiscard]] LinkView link() const final { return {counters_, ring_}; }

protected:
  /// `ring` is the one that `transport` was made with.
  PortDriver(std::unique_ptr<Transport> transport, std::shared_ptr<RawRing> ring)
      : transport_(std::move(transport)), ring_(std::move(ring)), read_(kReadBytes) {}

  // What a derived driver says.

  [[nodiscard]] virtual Decoder& decoder() noexcept = 0;
  /// Makes the device send lines. Uses send() and await().
  [[nodiscard]] virtual Result<DeviceFacts> handshake() = 0;
  /// Looks after a running device: called when there is nothing to decode, before waiting. May send. Returns when it wants to
  /// be called again at the latest (monotonic ns). An error ends the run.
  [[nodiscard]] virtual Result<std::int64_t> attend(const Moment& now) { return now.monotonic_ns + kPatienceNs; }
  /// The decoder gave a reply while lines were awaited.
  [[nodiscard]] virtual Result<void> on_reply(const Moment& /*at*/) { return success(); }
  /// Leaves the device in a safe state (laser off). Called once before an open port is closed, also after an error; must not
  /// take longer than a few 100 ms.
  virtual void farewell() noexcept {}
  /// The port is about to be closed, lost or not.
  virtual void closing() noexcept {}

  // What a derived driver may use.

  /// Sends all of `text` within a second.
  [[nodiscard]] Result<void> send(std::string_view text);
  [[nodiscard]] Result<void> change_rate(int baud) { return transport_->change_rate(baud); }
  /// Decodes until a reply comes or `deadline_ns` is there (false). Lines and gaps on the way are passed over: before the
  /// start they belong to nobody. Fails when the device is lost.
  [[nodiscard]] Result<bool> await_reply(std::int64_t deadline_ns);
  [[nodiscard]] Moment now() const noexcept { return transport_->now(); }
  [[nodiscard]] const std::string& port_name() const noexcept { return transport_->name(); }
  [[nodiscard]] bool is_live() const noexcept { return transport_->is_live(); }
  /// When the bytes came that are being decoded. Unlike now() it is the same when a transcript is played.
  [[nodiscard]] const Moment& arrived() const noexcept { return arrived_; }
  [[nodiscard]] LinkCounters& counters() noexcept { return *counters_; }
  /// When the last byte of the newest line came; empty before the first line of this run.
  [[nodiscard]] const std::optional<Moment>& line_at() const noexcept { return line_at_; }

private:
  static constexpr std::size_t kReadBytes = std::size_t{64} << 10U;

  /// Brings bytes in; nothing at the deadline.
  [[nodiscard]] Result<void> fill(std::int64_t deadline_ns);
  [[nodiscard]] Decoder::Step decode(LineBuffer& line, Gap& gap);
  [[nodiscard]] Delivery deliver(LineBuffer& line, Gap& gap);

  std::unique_ptr<Transport> transport_;
  std::shared_ptr<RawRing> ring_;
  std::shared_ptr<LinkCounters> counters_ = std::make_shared<LinkCounters>();
  std::vector<std::uint8_t> read_;
  std::size_t begin_ = 0, end_ = 0; ///< bytes of read_ that are not decoded yet
  Moment arrived_;                  ///< of those
  bool is_open_ = false;
  bool at_end_ = false;
  bool is_finished_ = false;      ///< the decoder was told of the end
  std::optional<Error> lost_;     ///< the port's error, while the decoder gives what it still has
  std::optional<Moment> line_at_; ///< in this run
  bool was_away_ = false;         ///< lines came in a run before, none yet in this one
  LineBuffer held_;               ///< the first line after a loss, while its gap is delivered
  bool is_held_ = false;
  LineBuffer passed_line_; ///< for await_reply
  Gap passed_gap_;
};

} // namespace scansion
