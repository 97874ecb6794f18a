// The keys that say how a device is connected.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/options.hpp"

#include "drivers/transport/ports.hpp"
#include "drivers/transport/raw_tap.hpp"
#include "drivers/transport/transcript.hpp"

namespace scansion {
namespace {

Result<void> check_path(std::string_view text) {
  if (text.empty()) return fail(Errc::config, "is empty; name a path");
  if (text == "-") return fail(Errc::config, "is standard input, which a daemon does not have; name a path");
  return success();
}

Result<void> check_remote(std::string_view text) {
  SCANSION_TRY(address, parse_host_port(text));
  if (address.host.empty()) return fail(Errc::config, "has no host; write host:port");
  return success();
}

Result<void> check_local(std::string_view text) {
  SCANSION_TRY(parse_host_port(text));
  return success();
}

/// The names of the keys of which one must be given.
std::string choices(const TransportKinds& kinds) {
  std::string out;
  if (kinds.serial) out += "port, ";
  if (kinds.tcp) out += "tcp, ";
  if (kinds.udp) out += "udp, ";
  if (kinds.file) out += "file, ";
  return out + "transcript";
}

} // namespace

std::vector<Option> with_transport(std::span<const Option> own, const TransportKinds& kinds) {
  std::vector<Option> rows(own.begin(), own.end());
  bool has_way = false; // the first way to reach the device is the example, the others stand beside it
  if (kinds.serial) {
    rows.push_back({.key = "port",
                    .meaning = "serial port; /dev/serial/by-id names stay the same, see `scansion devices`",
                    .check = check_path,
                    .example = "\"/dev/serial/by-id/...\"",
                    .alternative = std::exchange(has_way, true)});
    rows.push_back({.key = "baud",
                    .type = OptionType::integer,
                    .standard = kinds.baud,
                    .meaning = "bit/s of a serial port; means nothing to a device on USB",
                    .min = 50,
                    .max = 20e6});
  }
  if (kinds.tcp) {
    rows.push_back({.key = "tcp",
                    .meaning = "host:port the device listens on",
                    .check = check_remote,
                    .example = "\"192.168.0.10:10940\"",
                    .alternative = std::exchange(has_way, true)});
  }
  if (kinds.udp) {
    rows.push_back({.key = "udp",
                    .meaning = "address:port to receive datagrams on, :port for any address",
                    .check = check_local,
                    .example = "\":5000\"",
                    .alternative = std::exchange(has_way, true)});
  }
  if (kinds.file) {
    rows.push_back({.key = "file",
                    .meaning = "file or FIFO to read the device's bytes from",
                    .check = check_path,
                    .example = "\"/run/digitizer\"",
                    .alternative = std::exchange(has_way, true)});
  }
  rows.push_back({.key = "transcript",
                  .meaning = "raw transcript to play instead of a device; it gives the recording that the device gave",
                  .check = check_path,
                  .example = "\"/var/lib/scansion/table-1.raw\"",
                  .alternative = true});
  rows.push_back({.key = "raw",
                  .meaning = "file to which all bytes from and to the device are written with their times, up to raw_limit_mb",
                  .check = check_path,
                  .example = "\"/var/lib/scansion/table-1.raw\"",
                  .alternative = true});
  rows.push_back({.key = "raw_limit_mb",
                  .type = OptionType::integer,
                  .standard = std::int64_t{1024},
                  .meaning = "MiB that the file of raw may grow to; what comes later is counted and left out",
                  .min = 1,
                  .max = 1e6,
                  .alternative = true});
  return rows;
}

Result<std::unique_ptr<Transport>> make_transport(const OptionValues& values, const TransportKinds& kinds,
                                                  std::shared_ptr<RawRing> ring) {
  std::unique_ptr<Transport> inner;
  int given = 0;
  const auto take = [&](std::string_view key, auto make) -> Result<void> {
    if (values.find(key) == nullptr) return success();
    ++given;
    return make(values.text(key));
  };
  SCANSION_TRY(take("port", [&](std::string path) -> Result<void> {
    inner = serial_transport(std::move(path), static_cast<int>(values.integer("baud")), kinds.keeps_dtr);
    return success();
  }));
  SCANSION_TRY(take("tcp", [&](const std::string& text) -> Result<void> {
    SCANSION_TRY(address, parse_host_port(text));
    inner = tcp_transport(address);
    return success();
  }));
  SCANSION_TRY(take("udp", [&](const std::string& text) -> Result<void> {
    SCANSION_TRY(address, parse_host_port(text));
    inner = udp_transport(address);
    return success();
  }));
  SCANSION_TRY(take("file", [&](std::string path) -> Result<void> {
    inner = file_transport(std::move(path));
    return success();
  }));
  SCANSION_TRY(take("transcript", [&](std::string path) -> Result<void> {
    inner = transcript_transport(std::move(path));
    return success();
  }));
  if (given != 1) {
    return fail(Errc::config,
                given == 0 ? "how to reach the device is missing" : "more than one way to reach the device is given",
                "; give exactly one of ", choices(kinds));
  }
  const auto limit = values.get<std::int64_t>("raw_limit_mb");
  const std::uint64_t bound = limit ? static_cast<std::uint64_t>(*limit) << 20U : UINT64_MAX;
  return std::unique_ptr<Transport>(std::make_unique<RawTap>(std::move(inner), std::move(ring), values.text("raw"), bound));
}

} // namespace scansion
