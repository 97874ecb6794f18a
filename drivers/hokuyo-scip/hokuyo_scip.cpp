// Hokuyo line scanners: the handshake, the watch over a running sensor, the entry.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/hokuyo-scip/scip_decoder.hpp"
#include "drivers/hokuyo-scip/scip_options.hpp"
#include "drivers/hokuyo-scip/scip_text.hpp"
#include "drivers/port/port_driver.hpp"

#include <cstdio>

namespace scansion {
namespace {

using scip::Frame;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kRetryNs = 500 * kMs;    ///< a QT is sometimes passed over
constexpr std::int64_t kStopNs = 2'000 * kMs;   ///< for the echo of QT
constexpr int kMostStopReplies = 16;            ///< of before QT, and those on the way out of other modes
constexpr std::int64_t kAnswerNs = 1'000 * kMs; ///< for that of anything else
constexpr std::int64_t kFarewellNs = 300 * kMs; ///< for QT when leaving
constexpr int kMostProbes = 3;                  ///< unanswered: the sensor is gone
constexpr std::int64_t kIdleNs = 10'000 * kMs;  ///< answers, but measures nothing: it is started anew
constexpr std::int64_t kPollNs = 200 * kMs;     ///< after a period, for a scan that was asked for
constexpr int kClockReadings = 5;

std::string number(std::int32_t value, int width) {
  char text[16];
  std::snprintf(text, sizeof text, "%0*d", width, value);
  return text;
}

class HokuyoScip final : public PortDriver {
public:
  HokuyoScip(const scip::Options& options, std::unique_ptr<Transport> transport, std::shared_ptr<RawRing> ring)
      : PortDriver(std::move(transport), std::move(ring)), options_(options), decoder_(counters(), options.spacing) {}

private:
  Decoder& decoder() noexcept override { return decoder_; }

  Result<DeviceFacts> handshake() override {
    SCANSION_TRY(reach());
    SCANSION_TRY(exchange("VV")); // a person finds it in the transcript
    SCANSION_TRY(answered, exchange("PP"));
    if (!answered) return fail(Errc::unavailable, port_name(), ": no answer to PP");
    SCANSION_TRY(sensor, named(scip::read_sensor(decoder_.reply().body)));
    sensor_ = sensor;
    SCANSION_TRY(exchange("II"));
    SCANSION_TRY(read_clock());
    SCANSION_TRY(light());
    SCANSION_TRY(measure());
    DeviceFacts facts;
    facts.lattice = scip::ScanGeometry::lattice(options_.height_mm);
    facts.gap_mm = options_.gap_mm;
    facts.rounding_mm = 0.5 / scip::kCountsPerMm;
    return facts;
  }

  template <class T>
  Result<T> named(Result<T> result) const {
    if (result) return result;
    return make_error(result.assume_error().code, {port_name(), ": ", result.assume_error().context});
  }

  /// Finds the sensor at one of its bit rates and brings it to the one that is wanted. A sensor that was reset is back at its
  /// own rate, one that was not is still at the other.
  Result<void> reach() {
    if (!options_.change_baud) return stop_measuring();
    const int rates[] = {is_fast_ ? *options_.change_baud : options_.baud, is_fast_ ? options_.baud : *options_.change_baud};
    SCANSION_TRY(change_rate(rates[0]));
    if (auto first = stop_measuring(); !first) {
      SCANSION_TRY(change_rate(rates[1]));
      if (!stop_measuring()) return first;
      is_fast_ = !is_fast_;
    }
    return is_fast_ ? Result<void>(success()) : raise_rate();
  }

  /// The reply comes at the old rate. A refusal does no harm: a link without a bit rate, or one that has it already.
  Result<void> raise_rate() {
    SCANSION_TRY(answered, exchange("SS" + number(*options_.change_baud, 6)));
    if (!answered || decoder_.reply().status != "00") return success();
    SCANSION_TRY(change_rate(*options_.change_baud));
    is_fast_ = true;
    return stop_measuring();
  }

  /// Never waits for silence: a sensor whose host died goes on measuring.
  Result<void> stop_measuring() {
    SCANSION_TRY(send("\nQT\n"));
    const std::int64_t deadline = now().monotonic_ns + kStopNs;
    std::int64_t retry = now().monotonic_ns + kRetryNs;
    for (int replies = 0; replies < kMostStopReplies;) {
      SCANSION_TRY(answered, await_reply(std::min(retry, deadline)));
      if (answered) {
        ++replies;
        SCANSION_TRY(is_stopped, take_stop_reply());
        if (is_stopped) return success();
        continue;
      }
      if (now().monotonic_ns >= deadline) {
        return fail(Errc::unavailable, port_name(), ": no answer to QT; is it a SCIP 2 sensor, and the bit rate right?");
      }
      retry = now().monotonic_ns + kRetryNs;
      SCANSION_TRY(send("QT\n"));
    }
    return fail(Errc::unavailable, port_name(), ": QT does not stop the sensor; its last answer was ", decoder_.reply().status);
  }

  /// True: the sensor rests. Else the command that leaves its mode was sent.
  Result<bool> take_stop_reply() {
    const Frame& frame = decoder_.reply();
    if (frame.status == "E") { // SCIP 1.1 knows nothing but this
      SCANSION_TRY(send("SCIP2.0\n"));
    } else if (frame.echo == "QT") {
      if (frame.status == "00") return true;
      if (frame.status == "0L") return fail(Errc::unavailable, port_name(), ": the sensor reports an abnormal state (0L)");
      SCANSION_TRY(send("TM2\n")); // in clock mode
    } else if (frame.echo == "TM2" || frame.echo == "SCIP2.0") {
      SCANSION_TRY(send("QT\n"));
    }
    return false;
  }

  /// Sends a command and waits for the reply with its echo, which is then decoder_.reply(). Refusals are replies too. False: no
  /// answer, as from sensors that do not know the command.
  Result<bool> exchange(std::string_view command) {
    for (int attempt = 0; attempt < 2; ++attempt) {
      SCANSION_TRY(send(std::string(command) + "\n"));
      const std::int64_t deadline = now().monotonic_ns + kAnswerNs;
      for (;;) {
        SCANSION_TRY(answered, await_reply(deadline));
        if (!answered) break;
        if (decoder_.reply().echo == command) return true;
      }
    }
    return false;
  }

  /// Where the sensor's clock stands, from the quickest of some exchanges. Sensors without clock mode do without.
  Result<void> read_clock() {
    clock_offset_ms_.reset();
    SCANSION_TRY(known, exchange("TM0"));
    if (!known || (decoder_.reply().status != "00" && decoder_.reply().status != "02")) return success();
    std::int64_t quickest = kAnswerNs;
    for (int i = 0; i < kClockReadings; ++i) {
      const std::int64_t asked = arrived().monotonic_ns;
      SCANSION_TRY(answered, exchange("TM1"));
      if (!answered) continue;
      std::string_view body = decoder_.reply().body;
      const auto text = scip::take_summed(body);
      const auto clock = text && text->size() == 4 ? scip::decode_number(*text) : std::nullopt;
      const std::int64_t round_trip = arrived().monotonic_ns - asked;
      if (!clock || round_trip >= quickest) continue;
      quickest = round_trip;
      clock_offset_ms_ = (asked + round_trip / 2) / kMs - *clock;
    }
    SCANSION_TRY(left, exchange("TM2"));
    return left ? Result<void>(success()) : fail(Errc::unavailable, port_name(), ": no answer to TM2");
  }

  /// A cold laser is no error of the configuration: the session tries again. A sensor that does not know BM lights its laser
  /// when it is told to measure.
  Result<void> light() {
    SCANSION_TRY(answered, exchange("BM"));
    const std::string_view status = answered ? decoder_.reply().status : "";
    if (!answered || status == "00" || status == "02" || is_unknown(status)) return success();
    return fail(Errc::unavailable, port_name(), ": the laser cannot be lit yet (warming up, or a fault), status ", status);
  }

  /// The documents do not agree on the letter of a command that does not exist.
  static bool is_unknown(std::string_view status) noexcept { return status[0] == '0' && status[1] >= 'C' && status[1] <= 'F'; }

  Result<void> measure() {
    ScipDecoder::Expected expected;
    scip::ScanPlan& plan = expected.plan;
    plan = options_.plan;
    plan.start = options_.start.value_or(sensor_.first);
    plan.end = options_.end.value_or(sensor_.last);
    if (plan.start < sensor_.first || plan.end > sensor_.last || plan.end < plan.start) {
      return fail(Errc::config, port_name(), ": start and end must lie from ", std::to_string(sensor_.first), " to ",
                  std::to_string(sensor_.last), ", the steps of this ", sensor_.model);
    }
    expected.sensor = sensor_;
    expected.gap_mm = options_.gap_mm;
    // A sensor that kept its clock counts what was lost better than the host.
    expected.kept_clock = clock_offset_ms_ && last_offset_ms_ && std::abs(*clock_offset_ms_ - *last_offset_ms_) < 1000;
    const std::string steps =
        plan.kind + number(plan.start, 4) + number(plan.end, 4) + number(plan.cluster == 1 ? 0 : plan.cluster, 2);
    expected.head = (plan.has_echoes ? "N" : "M") + steps + number(plan.skip, 1);
    // No other session has this tag; made of recorded time, so that a transcript has it too.
    char tag[16];
    std::snprintf(tag, sizeof tag, ";s%08llx", static_cast<unsigned long long>(arrived().monotonic_ns / 1000) & 0xFFFF'FFFFULL);
    expected.tail = tag;
    const std::string request = expected.head + "00" + expected.tail;
    period_ns_ = plan.period_ns(sensor_);
    heard_ns_ = arrived().monotonic_ns;
    probes_ = unanswered_ = 0;
    poll_.clear();
    polled_ns_ = 0;
    is_polled_ = false;
    decoder_.expect(expected);
    SCANSION_TRY(send(request + "\n"));
    const std::int64_t deadline = now().monotonic_ns + kAnswerNs;
    for (;;) {
      SCANSION_TRY(answered, await_reply(deadline));
      if (!answered) return fail(Errc::unavailable, port_name(), ": no answer to ", request);
      if (decoder_.reply().echo == request) break;
    }
    const std::string_view status = decoder_.reply().status;
    heard_ns_ = arrived().monotonic_ns;
    if (status == "00") return success();
    if (!is_unknown(status)) return refused(request, status);
    // A sensor without continuous measuring: scans are asked for one by one.
    expected.plan.is_polled = true;
    expected.plan.skip = 0;
    period_ns_ = expected.plan.period_ns(sensor_);
    expected.head = (plan.has_echoes ? "H" : "G") + steps;
    poll_ = expected.head + expected.tail + "\n";
    decoder_.expect(std::move(expected));
    return success();
  }

  Error refused(std::string_view request, std::string_view status) const {
    return make_error(Errc::unavailable, {port_name(), ": the sensor refuses ", request, " with status ", status});
  }

  /// Asks for the next scan twice a period, so that none is missed; the decoder knows one that comes again. When to look again.
  Result<std::int64_t> poll(const Moment& moment) {
    const std::int64_t due = polled_ns_ + (is_polled_ ? period_ns_ + kPollNs : period_ns_ / 2);
    if (moment.monotonic_ns < due) return due;
    SCANSION_TRY(send(poll_));
    polled_ns_ = moment.monotonic_ns;
    is_polled_ = true;
    return polled_ns_ + period_ns_ / 2;
  }

  /// Three periods and a little without a scan: ask; three questions without an answer: gone.
  Result<std::int64_t> attend(const Moment& moment) override {
    const std::int64_t line_ns = line_at() ? line_at()->monotonic_ns : 0;
    if (line_ns > heard_ns_) {
      heard_ns_ = line_ns;
      probes_ = unanswered_ = 0; // it measures, whatever became of the answers
      is_polled_ = false;
    }
    if (probes_ == 0) started_waiting_ns_ = heard_ns_;
    std::int64_t next_poll = INT64_MAX;
    if (!poll_.empty()) {
      SCANSION_TRY(at, poll(moment));
      next_poll = at;
    }
    const std::int64_t patience = probes_ == 0 ? 3 * period_ns_ + 200 * kMs : kAnswerNs;
    const std::int64_t due = (probes_ == 0 ? heard_ns_ : asked_ns_) + patience;
    if (moment.monotonic_ns < due) return std::min(due, next_poll);
    if (unanswered_ >= kMostProbes) return fail(Errc::unavailable, port_name(), ": lost, the sensor is silent");
    if (moment.monotonic_ns - started_waiting_ns_ > kIdleNs) {
      return fail(Errc::unavailable, port_name(), ": the sensor answers but measures nothing; starting it anew");
    }
    SCANSION_TRY(send("II\n"));
    ++probes_;
    ++unanswered_;
    asked_ns_ = moment.monotonic_ns;
    return std::min(asked_ns_ + kAnswerNs, next_poll);
  }

  Result<void> on_reply(const Moment& at) override {
    const Frame& frame = decoder_.reply();
    unanswered_ = 0;
    if (!decoder_.is_expected(frame.echo)) return success();
    // Behind the reply to the request only scans or news about them come under its echo.
    heard_ns_ = at.monotonic_ns;
    probes_ = 0;
    is_polled_ = false;
    const bool is_fault = frame.status >= "50" && frame.status <= "97" && frame.status[0] >= '5' && frame.status[0] <= '9';
    if (is_fault) return fail(Errc::unavailable, port_name(), ": the sensor stopped with hardware fault ", frame.status);
    if (!poll_.empty() && frame.status != "00") return refused(frame.echo, frame.status);
    return success();
  }

  /// Laser off, on every way out.
  void farewell() noexcept override {
    if (!send("QT\n")) return;
    const std::int64_t deadline = now().monotonic_ns + kFarewellNs;
    for (;;) {
      auto answered = await_reply(deadline);
      if (!answered || !answered.assume_value() || decoder_.reply().echo == "QT") return;
    }
  }

  void closing() noexcept override {
    if (clock_offset_ms_) last_offset_ms_ = clock_offset_ms_;
  }

  const scip::Options options_;
  ScipDecoder decoder_;
  scip::Sensor sensor_;
  std::int64_t period_ns_ = 25 * kMs;
  std::int64_t heard_ns_ = 0;           ///< when the sensor last showed that it measures
  std::int64_t started_waiting_ns_ = 0; ///< for the next scan
  std::int64_t asked_ns_ = 0;
  int probes_ = 0;                                               ///< since the last scan
  int unanswered_ = 0;                                           ///< of these, in a row
  std::string poll_;                                             ///< the request for one scan; empty: scans come by themselves
  bool is_polled_ = false;                                       ///< and is not answered yet
  std::int64_t polled_ns_ = 0;                                   ///< when it was last sent
  bool is_fast_ = false;                                         ///< the sensor was last seen at change_baud
  std::optional<std::int64_t> clock_offset_ms_, last_offset_ms_; ///< host less sensor; in the run before
};

Result<std::unique_ptr<Driver>> make(const OptionValues& values) {
  SCANSION_TRY(options, scip::read_options(values));
  auto ring = std::make_shared<RawRing>();
  SCANSION_TRY(transport, make_transport(values, scip::kScipKinds, ring));
  return std::unique_ptr<Driver>(std::make_unique<HokuyoScip>(options, std::move(transport), std::move(ring)));
}

} // namespace

const DriverInfo& hokuyo_scip_driver() noexcept;
const DriverInfo& hokuyo_scip_driver() noexcept {
  static const DriverInfo info{"hokuyo-scip", "Hokuyo line scanners that speak SCIP 2", scip::schema(), make};
  return info;
}

} // namespace scansion
