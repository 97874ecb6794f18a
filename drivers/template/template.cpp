// The example driver: copy this folder to begin a new one (docs/DRIVERS.md).
// SPDX-License-Identifier: Apache-2.0
#include "drivers/port/port_driver.hpp"
#include "drivers/template/decoder.hpp"

namespace scansion {
namespace {

constexpr TransportKinds kKinds{.serial = true, .tcp = true};
constexpr std::int64_t kAnswerNs = 1'000'000'000;

class TemplateDriver final : public PortDriver {
public:
  TemplateDriver(std::unique_ptr<Transport> transport, std::shared_ptr<RawRing> ring)
      : PortDriver(std::move(transport), std::move(ring)), decoder_(counters()) {}

private:
  Decoder& decoder() noexcept override { return decoder_; }

  Result<DeviceFacts> handshake() override {
    SCANSION_TRY(send("START\n"));
    SCANSION_TRY(answered, await_reply(now().monotonic_ns + kAnswerNs));
    if (!answered) return fail(Errc::unavailable, port_name(), ": no answer to START; is it the right device?");
    DeviceFacts facts;
    facts.lattice.resolution = {1, 1000}; // the device counts in micrometres
    return facts;
  }

  void farewell() noexcept override { static_cast<void>(send("STOP\n")); } // a lost device cannot be told

  TemplateDecoder decoder_;
};

std::span<const Option> schema() {
  static const std::vector<Option> rows = with_transport({}, kKinds);
  return rows;
}

Result<std::unique_ptr<Driver>> make(const OptionValues& values) {
  auto ring = std::make_shared<RawRing>();
  SCANSION_TRY(transport, make_transport(values, kKinds, ring));
  return std::unique_ptr<Driver>(std::make_unique<TemplateDriver>(std::move(transport), std::move(ring)));
}

} // namespace

const DriverInfo& template_driver() noexcept;
const DriverInfo& template_driver() noexcept {
  static const DriverInfo info{"template", "an example for writers of drivers", schema(), make};
  return info;
}

} // namespace scansion
