// The entry of digitizers that print points: a stream whose records the configuration describes.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/port/port_driver.hpp"
#include "drivers/stream/decoder.hpp"

#include <algorithm>

namespace scansion {
namespace {

constexpr TransportKinds kKinds{.serial = true, .tcp = true, .udp = true, .file = true};

class StreamDriver final : public PortDriver {
public:
  StreamDriver(std::unique_ptr<Transport> transport, std::shared_ptr<RawRing> ring, stream::Plan plan,
               stream::RecordReader reader)
      : PortDriver(std::move(transport), std::move(ring)), plan_(plan),
        decoder_(counters(), std::move(plan), std::move(reader)) {}

  double rounding_mm() const noexcept override { return decoder_.rounding() * count_mm(); }

private:
  Decoder& decoder() noexcept override { return decoder_; }

  [[nodiscard]] double count_mm() const noexcept { return plan_.resolution.value() * millimetres(plan_.unit).value(); }

  Result<DeviceFacts> handshake() override {
    if (!plan_.start.empty()) {
      SCANSION_TRY(send(plan_.start));
    }
    DeviceFacts facts;
    facts.lattice.resolution = plan_.resolution;
    facts.lattice.unit = plan_.unit;
    facts.gap_mm = plan_.gap_mm;
    facts.rounding_mm = count_mm() / 2;
    return facts;
  }

  Result<std::int64_t> attend(const Moment& now) override {
    return std::min(decoder_.look_for_pause(now), now.monotonic_ns + kPatienceNs);
  }

  void farewell() noexcept override {
    if (!plan_.stop.empty()) static_cast<void>(send(plan_.stop)); // a lost device cannot be told
  }

  const stream::Plan plan_;
  stream::StreamDecoder decoder_;
};

std::span<const Option> schema() {
  static const std::vector<Option> rows = with_transport(stream::rows(), kKinds);
  return rows;
}

Result<std::unique_ptr<Driver>> make(const OptionValues& values) {
  SCANSION_TRY(plan, stream::make_plan(values));
  SCANSION_TRY(reader, stream::RecordReader::create(plan));
  auto ring = std::make_shared<RawRing>();
  SCANSION_TRY(transport, make_transport(values, kKinds, ring));
  return std::unique_ptr<Driver>(
      std::make_unique<StreamDriver>(std::move(transport), std::move(ring), std::move(plan), std::move(reader)));
}

} // namespace

const DriverInfo& stream_driver() noexcept;
const DriverInfo& stream_driver() noexcept {
  static const DriverInfo info{"stream", "digitizers that send points as text or fixed records, described by the keys",
                               schema(), make};
  return info;
}

} // namespace scansion
