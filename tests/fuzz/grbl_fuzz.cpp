// Any bytes as a controller's answers, any bytes as a host's commands to the simulated one, and both talking while any bytes
// disturb them.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/session.hpp"
#include "sim/device/grbl/firmware.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>

namespace {

using namespace scansion::grbl;

constexpr Ns kMs = 1'000'000;

/// The first byte chooses how the rest is cut and how much time goes by; the session must survive, and stay within its bounds.
void session(std::span<const std::uint8_t> bytes, std::size_t piece) {
  RasterArea area;
  area.x_to = area.y_to = 3.0;
  area.bottom = -5.0;
  const auto raster = Raster::create(area);
  HeightMap heights(raster.assume_value());
  scansion::LinkCounters counters;
  Session session({.area = area}, raster.assume_value(), heights, {}, counters, 0);
  Ns now = 0;
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(piece, bytes.size()));
    bytes = bytes.subspan(part.size());
    session.received(std::as_bytes(part), now);
    now += 30 * kMs * static_cast<Ns>(piece);
    session.tick(now);
    if (session.output().size() > 1024) std::abort();
    session.output().clear();
    while (session.take_row()) {
    }
  }
  session.leave(now);
}

/// However the bytes are cut, the answers are the same.
void cuts(std::span<const std::uint8_t> bytes, std::size_t piece) {
  const auto count = [&](std::size_t size) {
    scansion::LinkCounters counters;
    Answers answers(counters);
    std::uint64_t found = 0;
    for (std::size_t at = 0; at < bytes.size(); at += size) {
      auto part = std::as_bytes(bytes.subspan(at, std::min(size, bytes.size() - at)));
      while (const auto answer = answers.next(part)) found = found * 31 + static_cast<std::uint64_t>(answer->kind) + 1;
    }
    if (counters.bytes_in != 0) std::abort();
    return found * 1000 + counters.accepted + counters.rejected();
  };
  if (count(piece) != count(bytes.size())) std::abort();
}

void firmware(std::span<const std::uint8_t> bytes, std::size_t piece) {
  scansion::sim::grbl::FirmwareOptions options;
  options.surface = [](double x, double y) { return -2.0 + 0.1 * x - 0.05 * y; };
  scansion::sim::grbl::Firmware machine(options, scansion::sim::grbl::Settings());
  machine.power_on(0);
  Ns now = 0;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    machine.receive(bytes.subspan(at, std::min(piece, bytes.size() - at)), now);
    machine.output().clear();
    now += 100 * kMs;
  }
}

class Conversation {
public:
  explicit Conversation(std::span<const std::uint8_t> script) : script_(script), machine_(machine_options(), {}) {
    machine_.power_on(0);
    area_.x_to = area_.y_to = 1.0;
    area_.bottom = -5.0;
  }

  /// Each byte of the script does something to the next piece that the machine says.
  void run() {
    constexpr int kMostSteps = 150; // two or three points
    const auto raster = Raster::create(area_);
    HeightMap heights(raster.assume_value());
    scansion::LinkCounters counters;
    Session session({.area = area_}, raster.assume_value(), heights, {}, counters, 0);
    for (int step = 0; step < kMostSteps && !session.is_finished(); ++step) {
      now_ = std::max(now_, std::min(session.deadline(), machine_.next_event()));
      machine_.run_until(now_);
      std::string said = std::exchange(machine_.output(), {});
      if (!said.empty()) disturb(said);
      heard_alarm_ |= said.find("ALARM:4") != std::string::npos || said.find("ALARM:5") != std::string::npos;
      const bool had_failed = session.failure().has_value();
      session.received(std::as_bytes(std::span(said)), now_);
      if (now_ >= session.deadline()) session.tick(now_);
      check(session.output(), had_failed);
      send(std::exchange(session.output(), {}));
      while (session.take_row()) {
      }
    }
  }

private:
  static scansion::sim::grbl::FirmwareOptions machine_options() {
    scansion::sim::grbl::FirmwareOptions options;
    options.surface = [](double x, double y) { return -2.0 + 0.1 * x - 0.05 * y; };
    return options;
  }
  void send(std::string_view text) {
    machine_.receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, now_);
  }

  void disturb(std::string& said) {
    if (script_.empty()) return;
    const std::uint8_t byte = script_.front();
    script_ = script_.subspan(1);
    const std::uint8_t what = byte & 15U, how = byte >> 4U;
    switch (what) {
      case 8: said.clear(); break;
      case 9: said[how % said.size()] ^= static_cast<char>(1U << (how % 8U)); break;
      case 10: said += said; break;
      case 11: said.insert(0, "ok\r\n"); break;
      case 12: said += "ALARM:" + std::to_string(how) + "\r\n"; break;
      case 13: send(std::string_view("!~\x84\x18?\n", 6).substr(how % 6U, 1)); break;
      case 14: machine_.set_pin_stuck(how % 2U == 0); break;
      case 15: machine_.power_on(now_); break;
      default: break;
    }
  }

  /// Whatever is heard: it unlocks only after an alarm of probing, never homes, resets only after a feed hold, and is quiet
  /// after a failure.
  void check(std::string_view sent, bool had_failed) {
    const bool unlocks = sent.find("$X") != std::string_view::npos;
    if (unlocks && !std::exchange(heard_alarm_, false)) std::abort();
    if (sent.find("$H") != std::string_view::npos || sent.find('\x18') != std::string_view::npos) std::abort();
    if (had_failed && !sent.empty()) std::abort();
  }

  std::span<const std::uint8_t> script_;
  scansion::sim::grbl::Firmware machine_;
  RasterArea area_;
  Ns now_ = 0;
  bool heard_alarm_ = false;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const std::size_t piece = 1 + data[0] / 4;
  if (data[0] % 4 == 3) {
    Conversation(bytes).run();
    return 0;
  }
  session(bytes, piece);
  cuts(bytes, piece);
  firmware(bytes, piece);
  return 0;
}
