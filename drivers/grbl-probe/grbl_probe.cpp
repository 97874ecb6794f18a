// The grbl-probe device: a machine with a touch probe that scans an area row by row.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/driver.hpp"
#include "drivers/grbl-probe/options.hpp"
#include "drivers/grbl-probe/rows.hpp"

#include <utility>

namespace scansion {
namespace {

using namespace grbl;

constexpr Ns kMs = 1'000'000;
constexpr Ns kSendNs = 500 * kMs;
constexpr Ns kLeaveNs = 1000 * kMs; ///< of the time a daemon has to end
constexpr Ns kAliveNs = 1500 * kMs; ///< a controller that was heard within this is not silent
constexpr Ns kGreetingNs = 60'000 * kMs;

/// Session time is that of arrivals and of deadlines, never of a clock that is read in between: the same bytes at the same
/// times give the same commands, so that a transcript can be played.
class ProbeDriver final : public Driver {
public:
  ProbeDriver(const ProbeOptions& options, const Raster& raster, std::unique_ptr<Transport> transport,
              std::shared_ptr<RawRing> ring)
      : options_(options), raster_(raster), transport_(std::move(transport)), ring_(std::move(ring)), heights_(raster_),
        done_(raster_) {}
  ~ProbeDriver() override { close(); }

  void attach(DriverHost& host) override { host_ = &host; }
  bool can_hold() const noexcept override { return true; }
  bool is_at_rest() const noexcept override { return session_ && session_->is_held() && session_->is_at_rest(); }
  bool is_over() const noexcept override { return transport_->is_over(); }
  LinkView link() const override { return {counters_, ring_}; }

  std::string condition() const override {
    if (!left_.empty()) return left_;
    return session_ ? session_->condition() : std::string();
  }

  Result<void> open() override {
    left_.clear();
    SCANSION_TRY(transport_->open());
    is_open_ = true;
    return success();
  }

  Result<DeviceFacts> start() override {
    load_earlier_rows();
    heights_ = HeightMap(raster_);
    done_.put_heights(heights_);
    const bool has_begun = has_touched_ || !done_.is_empty();
    const Progress progress{done_.count(), has_begun, has_probed_, is_recorded_ && !has_probed_};
    session_.emplace(options_.session, raster_, heights_, progress, *counters_, transport_->now().monotonic_ns);
    const Ns give_up = transport_->now().monotonic_ns + kGreetingNs;
    while (!session_->is_ready()) {
      if (session_->failure()) return failed();
      if (wanted() != Wanted::run) return fail(Errc::unavailable, name(), ": stopped while it was starting");
      if (transport_->now().monotonic_ns > give_up) return fail(Errc::unavailable, name(), ": does not come to rest");
      SCANSION_TRY(work(transport_->now().monotonic_ns + DriverHost::kLookNs));
      if (is_at_end_) return fail(Errc::unavailable, name(), ": ended before the device had started");
    }
    const bool inches = session_->machine().reports_inches;
    if (!done_.is_empty() && done_.is_in_inches() != inches) {
      return fail(Errc::attention, name(),
                  ": the controller reports in another unit than when the raster began; set $13 as it was");
    }
    given_ = 0;
    is_gap_told_ = false;
    DeviceFacts facts;
    facts.lattice = report_lattice(inches);
    facts.live = transport_->is_live();
    return facts;
  }

  Result<Delivery> next(LineBuffer& line, Gap& gap) override {
    const Ns begin = transport_->now().monotonic_ns;
    for (;;) {
      if (given_ < done_.count()) {
        done_.fill(given_++, line);
        return Delivery::line;
      }
      if (session_->is_finished() || is_at_end_) return Delivery::end;
      if (session_->failure()) return lost_row(gap, session_->failure()->context) ? Result<Delivery>(Delivery::gap) : failed();
      const Ns now = transport_->now().monotonic_ns;
      if (now - begin >= kPatienceNs || wanted() == Wanted::leave) return idle(now);
      obey(now);
      if (auto worked = work(std::min(begin + kPatienceNs, now + DriverHost::kLookNs)); !worked) {
        if (!lost_row(gap, "the machine was lost")) return std::move(worked).assume_error();
        pending_ = std::move(worked).assume_error();
        return Delivery::gap;
      }
      SCANSION_TRY(collect());
    }
  }

  void close() noexcept override {
    if (std::exchange(is_open_, false) && session_) bring_to_rest();
    session_.reset();
    transport_->close();
  }

private:
  [[nodiscard]] const std::string& name() const noexcept { return transport_->name(); }
  [[nodiscard]] Wanted wanted() const noexcept { return host_ == nullptr ? Wanted::run : host_->wanted(); }

  Error failed() const { return make_error(session_->failure()->code, {name(), ": ", session_->failure()->context}); }

  Delivery idle(Ns now) const noexcept { return now - session_->last_heard() < kAliveNs ? Delivery::busy : Delivery::nothing; }

  void obey(Ns now) {
    if (wanted() == Wanted::hold && !session_->is_held()) session_->hold(now);
    if (wanted() == Wanted::run && session_->is_held()) session_->go_on();
  }

  /// Rows that a killed daemon had recorded. Only once: later runs know their rows themselves.
  void load_earlier_rows() {
    if (!std::exchange(wants_earlier_, false) || !options_.resume || host_ == nullptr || !transport_->is_live()) return;
    auto earlier = host_->earlier_scan(raster_.rows());
    if (!earlier || !earlier.assume_value()) return;
    const EarlierScan& scan = *earlier.assume_value();
    if (scan.lines.size() >= raster_.rows()) return; // that raster is whole: this is another
    // One that is not of this raster is left alone.
    if (auto taken = done_.take_over(scan.lattice, scan.lines); !taken) done_.clear();
    is_recorded_ = !done_.is_empty();
  }

  /// Sends what is to be sent, then lets bytes come until `until`, or the session wants to go on.
  Result<void> work(Ns until) {
    if (pending_) return std::move(*std::exchange(pending_, std::nullopt));
    SCANSION_TRY(transmit());
    const Ns deadline = session_->deadline();
    SCANSION_TRY(arrival, transport_->read(read_, std::min(until, deadline)));
    is_at_end_ = arrival.end;
    if (arrival.count > 0) {
      counters_->bytes_in.fetch_add(arrival.count, std::memory_order_relaxed);
      arrived_ = arrival.at;
      session_->received(std::as_bytes(std::span(read_).first(arrival.count)), arrival.at.monotonic_ns);
      if (arrival.at.monotonic_ns >= session_->deadline()) session_->tick(arrival.at.monotonic_ns);
    } else if (deadline <= until && !arrival.end) {
      session_->tick(deadline);
    }
    return transmit();
  }

  Result<void> transmit() {
    std::string& out = session_->output();
    if (out.empty()) return success();
    auto written = transport_->write(out, transport_->now().monotonic_ns + kSendNs);
    if (written) counters_->bytes_out.fetch_add(out.size(), std::memory_order_relaxed);
    out.clear();
    return written;
  }

  void remember() noexcept {
    has_touched_ |= session_->has_touched();
    has_probed_ |= session_->has_probed();
  }

  Result<void> collect() {
    remember();
    while (auto row = session_->take_row()) {
      Stamps stamps;
      stamps.host_monotonic_ns = arrived_.monotonic_ns;
      stamps.host_realtime_ns = arrived_.realtime_ns;
      SCANSION_TRY(done_.put(*row, session_->machine().reports_inches, stamps));
    }
    return success();
  }

  /// Once a run: the points of a row that will not become whole.
  bool lost_row(Gap& gap, std::string_view why) {
    if (is_gap_told_ || !session_->has_broken_row()) return false;
    is_gap_told_ = true;
    gap.count = 1;
    gap.reason = "a row was interrupted: ";
    gap.reason += why;
    return true;
  }

  void bring_to_rest() noexcept {
    remember();
    const Ns begin = transport_->now().monotonic_ns;
    session_->leave(begin);
    pending_.reset();
    Ns now = begin;
    while (!session_->is_at_rest() && now - begin < kLeaveNs && !is_at_end_) {
      if (!work(std::min(session_->deadline(), now + DriverHost::kLookNs))) return; // gone
      now = transport_->now().monotonic_ns;
    }
    if (!transmit()) return;
    if (session_->was_reset())
      left_ = name() + ": the machine was held and reset in the middle of its raster; home it before it is used again";
    else if (!session_->is_at_rest())
      left_ = name() + ": the machine was told to hold but did not say that it stands";
  }

  const ProbeOptions options_;
  const Raster raster_;
  std::unique_ptr<Transport> transport_;
  std::shared_ptr<RawRing> ring_;
  std::shared_ptr<LinkCounters> counters_ = std::make_shared<LinkCounters>();
  DriverHost* host_ = nullptr;
  bool wants_earlier_ = true;
  bool is_recorded_ = false; ///< the rows that this driver began with

  HeightMap heights_;
  DoneRows done_;
  bool has_touched_ = false, has_probed_ = false; ///< in any run of this raster
  std::optional<Session> session_;
  std::array<std::uint8_t, 4096> read_{};
  Moment arrived_;
  bool is_open_ = false, is_at_end_ = false;
  std::uint32_t given_ = 0; ///< rows delivered in this run; those of earlier runs come again, so that its recording is whole
  bool is_gap_told_ = false;
  std::optional<Error> pending_; ///< follows the gap that was delivered first
  std::string left_;
};

Result<std::unique_ptr<Driver>> make_probe(const OptionValues& values) {
  SCANSION_TRY(options, probe_options(values));
  SCANSION_TRY(raster, Raster::create(options.session.area));
  auto ring = std::make_shared<RawRing>();
  SCANSION_TRY(transport, make_transport(values, kTransports, ring));
  return std::unique_ptr<Driver>(std::make_unique<ProbeDriver>(options, raster, std::move(transport), std::move(ring)));
}

} // namespace

const DriverInfo& grbl_probe_driver() noexcept;
const DriverInfo& grbl_probe_driver() noexcept {
  static const DriverInfo info{"grbl-probe", "a Grbl or grblHAL machine with a touch probe", probe_schema(), make_probe};
  return info;
}

} // namespace scansion
