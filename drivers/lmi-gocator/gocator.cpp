// The entry of LMI Gocator laser profilers.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/lmi-gocator/decoder.hpp"
#include "drivers/port/port_driver.hpp"

#include <array>
#include <numeric>

namespace scansion {
namespace {

constexpr TransportKinds kKinds{.tcp = true};
constexpr std::int64_t kFirstProfileNs = 1'000'000'000;
constexpr std::int64_t kNmPerMm = 1'000'000;
constexpr std::array<std::string_view, 4> kSources{"top", "bottom", "top-left", "top-right"};

Result<std::optional<std::uint8_t>> parse_source(std::string_view text) {
  if (text == "any") return std::optional<std::uint8_t>();
  for (std::size_t i = 0; i < kSources.size(); ++i) {
    if (text == kSources[i]) return std::optional<std::uint8_t>(static_cast<std::uint8_t>(i));
  }
  return fail(Errc::config, "is none of any, top, bottom, top-left, top-right");
}

/// nm in a count, 0 for auto.
Result<std::int64_t> parse_count(std::string_view text) {
  if (text == "auto") return std::int64_t{0};
  auto mm = parse_rational(text);
  if (mm) mm = multiply(mm.assume_value(), Rational{kNmPerMm, 1});
  if (!mm || mm.assume_value().den != 1) {
    return fail(Errc::config, "is neither \"auto\" nor a decimal in mm of whole nanometres such as 0.001");
  }
  return mm.assume_value().num;
}

Result<void> check_source(std::string_view text) {
  SCANSION_TRY(parse_source(text));
  return success();
}
Result<void> check_count(std::string_view text) {
  SCANSION_TRY(parse_count(text));
  return success();
}

class GocatorDriver final : public PortDriver {
public:
  GocatorDriver(std::unique_ptr<Transport> transport, std::shared_ptr<RawRing> ring, GocatorChoice choice, LineSpacing spacing,
                std::int64_t count_nm)
      : PortDriver(std::move(transport), std::move(ring)), decoder_(counters(), choice, spacing), count_nm_(count_nm) {}

  double rounding_mm() const noexcept override {
    return static_cast<double>(decoder_.rounding_nm()) / static_cast<double>(kNmPerMm);
  }

private:
  Decoder& decoder() noexcept override { return decoder_; }

  /// The sensor sends by itself once it runs; nothing is asked.
  Result<DeviceFacts> handshake() override {
    const bool is_given = count_nm_ != 0;
    std::int64_t count_nm = count_nm_;
    decoder_.set_count_nm(count_nm, is_given);
    if (!is_given) {
      SCANSION_TRY(came, await_reply(now().monotonic_ns + kFirstProfileNs));
      if (!came) {
        return fail(Errc::unavailable, port_name(),
                    ": no profile came within a second; does the sensor run, is it triggered, and are profiles chosen for its "
                    "Ethernet output?");
      }
      SCANSION_TRY(refused());
      const gdp::Profile& profile = decoder_.profile();
      count_nm = std::gcd(std::gcd(std::int64_t{profile.x_nm}, std::int64_t{profile.z_nm}),
                          1000 * std::gcd(std::int64_t{profile.x_um}, std::int64_t{profile.z_um}));
      decoder_.set_count_nm(count_nm, false);
    }
    DeviceFacts facts;
    SCANSION_TRY(resolution, make_rational(count_nm, kNmPerMm));
    facts.lattice.resolution = resolution;
    facts.rounding_mm = is_given ? facts.lattice.resolution.value() / 2 : 0.0;
    return facts;
  }

  Result<void> on_reply(const Moment& /*at*/) override { return refused(); }

  Result<void> refused() const {
    if (decoder_.refusal().empty()) return success();
    return fail(Errc::undecodable, port_name(), ": ", decoder_.refusal());
  }

  GocatorDecoder decoder_;
  const std::int64_t count_nm_; ///< 0: as the sensor's scales say
};

std::span<const Option> schema() {
  static const std::vector<Option> rows = [] {
    std::vector<Option> own{
        {.key = "source",
         .standard = "any",
         .meaning = "whose profiles: any (there is one), top, bottom, top-left or top-right",
         .check = check_source},
        {.key = "camera",
         .type = OptionType::integer,
         .meaning = "number of the camera in a sensor whose cameras send profiles of their own",
         .min = 0,
         .max = 255,
         .example = "0"},
        {.key = "resolution",
         .type = OptionType::text_or_number,
         .standard = "auto",
         .meaning = "mm per count, or auto: the coarsest that holds the sensor's values exactly",
         .check = check_count},
    };
    const auto spacing = spacing_rows();
    own.insert(own.end(), spacing.begin(), spacing.end());
    return with_transport(own, kKinds);
  }();
  return rows;
}

Result<std::unique_ptr<Driver>> make(const OptionValues& values) {
  GocatorChoice choice;
  SCANSION_TRY(source, parse_source(values.text("source")));
  choice.source = source;
  if (const auto camera = values.get<std::int64_t>("camera")) choice.camera = static_cast<std::uint8_t>(*camera);
  SCANSION_TRY(count_nm, parse_count(values.text("resolution")));
  SCANSION_TRY(spacing, LineSpacing::create(values));
  auto ring = std::make_shared<RawRing>();
  SCANSION_TRY(transport, make_transport(values, kKinds, ring));
  return std::unique_ptr<Driver>(
      std::make_unique<GocatorDriver>(std::move(transport), std::move(ring), choice, spacing, count_nm));
}

} // namespace

const DriverInfo& lmi_gocator_driver() noexcept;
const DriverInfo& lmi_gocator_driver() noexcept {
  static const DriverInfo info{"lmi-gocator", "LMI Gocator laser profilers, by their Ethernet data channel", schema(), make};
  return info;
}

} // namespace scansion
