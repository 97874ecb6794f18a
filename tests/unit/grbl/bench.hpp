// A session and a simulated controller joined by wires, in a time of their own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/grbl-probe/session.hpp"
#include "sim/device/grbl/firmware.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <gtest/gtest.h>
#include <random>
#include <utility>

namespace scansion::grbl::test {

using sim::grbl::Dialect;
using sim::grbl::Firmware;
using sim::grbl::FirmwareOptions;
using sim::grbl::Settings;

inline constexpr Ns kMs = 1'000'000;
inline constexpr Ns kS = 1000 * kMs;

inline double wavy(double x, double y) {
  return -6.0 + 1.7 * std::sin(x * 0.31) + 1.1 * std::cos(y * 0.23) + 0.01 * x;
}

inline RasterArea small_area() {
  RasterArea area;
  area.x_from = 2.0;
  area.x_to = 12.0;
  area.y_from = 3.0;
  area.y_to = 8.0;
  area.pitch = 2.5;
  area.spacing = 2.5;
  area.top = 0.0;
  area.bottom = -12.0;
  area.clearance = 1.5;
  return area;
}

struct BenchOptions {
  Dialect dialect = Dialect::grbl;
  RasterArea area = small_area();
  sim::grbl::Surface surface = wavy;
  std::uint32_t max_misses = 20;
  Ns wire = 0; ///< that each byte takes, either way
};

class Bench {
public:
  explicit Bench(BenchOptions options = {})
      : options_(std::move(options)), raster_(make_raster(options_.area)), heights_(raster_) {
    FirmwareOptions firmware;
    firmware.dialect = options_.dialect;
    firmware.surface = options_.surface;
    Settings settings;
    for (const int axis : {110, 111, 112}) settings.force(axis, 2000.0);
    for (const int axis : {120, 121, 122}) settings.force(axis, 200.0);
    firmware_.emplace(std::move(firmware), settings);
    firmware_->power_on(now_);
  }

  void connect(Progress progress = {}, bool trusts = false) {
    to_machine_.clear();
    to_session_.clear();
    SessionOptions session;
    session.trust_position = trusts;
    session.area = options_.area;
    session.feed = 240.0;
    session.max_misses = options_.max_misses;
    session_.emplace(session, raster_, heights_, progress, link_, now_);
  }

  /// One wake-up of driver or controller, whichever comes first.
  void step() {
    Ns next = std::min(session_->deadline(), firmware_->next_event());
    for (const Wire* wire : {&to_machine_, &to_session_}) {
      if (!wire->empty()) next = std::min(next, wire->front().first);
    }
    now_ = std::max(now_, next);
    firmware_->run_until(now_);
    deliver();
    if (now_ >= session_->deadline()) session_->tick(now_);
    transmit();
    while (auto row = session_->take_row()) rows_.push_back(*row);
  }

  template <class Until>
  [[nodiscard]] bool run(Until until, Ns limit = 3600 * kS) {
    const Ns end = now_ + limit;
    while (!until()) {
      if (now_ >= end || session_->failure()) return until();
      step();
    }
    return true;
  }
  [[nodiscard]] bool finish() {
    return run([&] { return session_->is_finished(); });
  }
  /// Until the controller has carried out the `count`-th line that begins so.
  [[nodiscard]] bool until_sent(std::string_view begin, std::size_t count = 1) {
    return run([&] { return sent_lines(begin) >= count; });
  }
  /// Time for the controller alone: nobody is connected.
  void leave_alone(Ns time) {
    now_ += time;
    firmware_->run_until(now_);
    firmware_->output().clear();
  }

  [[nodiscard]] std::size_t sent_lines(std::string_view begin) const {
    std::size_t count = 0;
    std::size_t at = 0;
    while ((at = log_.find(std::string(begin), at)) != std::string::npos) {
      if (at == 0 || log_[at - 1] == '\n' || log_[at - 1] == '?' || log_[at - 1] == '!' || log_[at - 1] == '~') ++count;
      ++at;
    }
    return count;
  }

  [[nodiscard]] Session& session() { return *session_; }
  [[nodiscard]] Firmware& firmware() { return *firmware_; }
  [[nodiscard]] const Raster& raster() const { return raster_; }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] const std::string& log() const { return log_; }
  [[nodiscard]] Ns now() const { return now_; }
  [[nodiscard]] std::string failure() const { return session_->failure() ? session_->failure()->context : std::string(); }

  /// Called with what the controller said, before the session sees it.
  std::function<void(std::string&)> spoil;

  void deliver() {
    if (!firmware_->output().empty()) to_session_.emplace_back(now_ + options_.wire, std::exchange(firmware_->output(), {}));
    while (!to_session_.empty() && to_session_.front().first <= now_) {
      std::string said = std::move(to_session_.front().second);
      to_session_.pop_front();
      if (spoil) spoil(said);
      if (!said.empty()) session_->received(std::as_bytes(std::span(said)), now_);
    }
  }
  void transmit() {
    std::string& out = session_->output();
    if (!out.empty()) {
      log_ += out;
      to_machine_.emplace_back(now_ + options_.wire, std::exchange(out, {}));
    }
    while (!to_machine_.empty() && to_machine_.front().first <= now_) {
      const std::string sent = std::move(to_machine_.front().second);
      to_machine_.pop_front();
      firmware_->receive({reinterpret_cast<const std::uint8_t*>(sent.data()), sent.size()}, now_);
    }
  }

  /// Every row there is, and each contact at most one step below the surface.
  void expect_whole_scan() const {
    ASSERT_EQ(rows_.size(), raster_.rows());
    for (std::uint32_t r = 0; r < raster_.rows(); ++r) {
      EXPECT_EQ(rows_[r].index, r);
      for (std::uint32_t c = 0; c < raster_.columns(); ++c) expect_contact(r, c);
    }
  }
  void expect_contact(std::uint32_t r, std::uint32_t c) const {
    const auto& point = rows_[r].points[c];
    ASSERT_TRUE(point) << r << ' ' << c;
    const double x = static_cast<double>((*point)[0]) / 1e4, y = static_cast<double>((*point)[1]) / 1e4;
    EXPECT_NEAR(x, static_cast<double>(raster_.x(c)) / 1000.0, 0.0021);
    EXPECT_NEAR(y, static_cast<double>(raster_.y(r)) / 1000.0, 0.0021);
    const double below = options_.surface(x, y) - static_cast<double>((*point)[2]) / 1e4;
    EXPECT_GE(below, -0.0006) << r << ' ' << c;
    EXPECT_LE(below, 0.0046) << r << ' ' << c;
  }

private:
  using Wire = std::deque<std::pair<Ns, std::string>>; ///< arrival, bytes

  static Raster make_raster(const RasterArea& area) {
    auto raster = Raster::create(area);
    EXPECT_TRUE(raster);
    return raster.assume_value();
  }

  BenchOptions options_;
  Raster raster_;
  HeightMap heights_;
  LinkCounters link_;
  std::optional<Firmware> firmware_;
  std::optional<Session> session_;
  Ns now_ = kS;
  std::vector<Row> rows_;
  std::string log_;
  Wire to_machine_, to_session_;
};

} // namespace scansion::grbl::test
