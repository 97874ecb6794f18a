// Any bytes as a controller's answers, and any bytes as a host's commands to the simulated one.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/session.hpp"
#include "sim/device/grbl/firmware.hpp"

#include <cstdlib>

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

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const std::size_t piece = 1 + data[0] / 4;
  session(bytes, piece);
  cuts(bytes, piece);
  firmware(bytes, piece);
  return 0;
}
