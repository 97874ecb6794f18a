// The commands of a SCIP 2 line scanner and its replies.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/scip/scip_device.hpp"

#include "drivers/hokuyo-scip/scip_text.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace scansion {
namespace {

constexpr std::size_t kLongestTag = 16;
constexpr std::int64_t kRebootNs = 1'000'000'000; ///< in which RB must be confirmed
constexpr std::size_t kMeasuringDigits = 13;      ///< of MD: start, end, cluster, skip, count
constexpr std::size_t kSingleDigits = 10;         ///< of GD: start, end, cluster
constexpr std::array<std::int32_t, 7> kRates{19200, 38400, 57600, 115200, 250000, 500000, 750000};

bool are_digits(std::string_view text) noexcept {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::int32_t digits_value(std::string_view text) noexcept {
  std::int32_t value = 0;
  for (const char c : text) value = value * 10 + (c - '0');
  return value;
}

bool is_tag_character(char c) noexcept {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
         std::string_view(" ._+@").find(c) != std::string_view::npos;
}

bool is_measuring(std::string_view symbol) noexcept {
  constexpr std::array<std::string_view, 10> kSymbols{"MD", "MS", "ME", "GD", "GS", "GE", "ND", "NE", "HD", "HE"};
  return std::find(kSymbols.begin(), kSymbols.end(), symbol) != kSymbols.end();
}

} // namespace

void ScipDevice::reply(const std::string& request, std::string_view status, std::string_view body) {
  std::string text = request + "\n";
  text.append(status);
  text += scip::sum_of(status);
  text += '\n';
  text.append(body);
  text += '\n';
  replies_.push_back(std::move(text));
}

void ScipDevice::reply_keys(const std::string& request, const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string body;
  for (const auto& [key, value] : rows) {
    std::string row = key;
    row.append(":").append(value);
    const char sum = scip::sum_of(row);
    body.append(row).append(";") += sum;
    body += '\n';
  }
  reply(request, "00", body);
}

void ScipDevice::take_request(const std::string& request, std::int64_t now_ns) {
  if (is_in_scip1_) {
    is_in_scip1_ = request != "SCIP2.0";
    replies_.push_back(request + (is_in_scip1_ ? "\nE\n\n" : "\n0\n\n"));
    return;
  }
  const std::size_t semicolon = request.find(';');
  const std::string_view command = std::string_view(request).substr(0, semicolon);
  const std::string_view tag =
      semicolon == std::string::npos ? std::string_view() : std::string_view(request).substr(semicolon);
  if (tag.size() > kLongestTag + 1) return reply(request, "0G");
  if (!tag.empty() && !std::all_of(tag.begin() + 1, tag.end(), is_tag_character)) return reply(request, "0H");
  const std::string_view symbol = command.substr(0, command.starts_with('%') ? 3 : 2);
  const std::string_view body = command.substr(symbol.size());
  if (is_measuring(symbol)) return take_measuring(request, body, tag, now_ns);
  if (symbol == "TM") return take_clock(request, body, now_ns);
  if (symbol == "SS" || symbol == "CR" || symbol == "HS") return take_setting(request, symbol, body);
  if (!body.empty() || !take_plain(symbol, request, now_ns)) reply(request, "0E");
}

void ScipDevice::take_setting(const std::string& request, std::string_view symbol, std::string_view body) {
  const std::size_t digits = symbol == "SS" ? 6 : symbol == "CR" ? 2 : 1;
  if (body.size() != digits) return reply(request, body.size() < digits ? "0C" : "0D");
  if (!are_digits(body)) return reply(request, "01");
  if (symbol != "SS") return reply(request, "00");
  if (plan_.stops_on_disconnect) return reply(request, "0E"); // Ethernet has no bit rate
  const std::int32_t rate = digits_value(body);
  if (rate == baud_) return reply(request, "03");
  if (std::find(kRates.begin(), kRates.end(), rate) == kRates.end()) return reply(request, "04");
  baud_ = rate;
  reply(request, "00");
}

bool ScipDevice::take_plain(std::string_view symbol, const std::string& request, std::int64_t now_ns) {
  const ScipModel& model = plan_.model;
  if (symbol == "VV") {
    reply_keys(request, {{"VEND", "Scansion simulator"},
                         {"PROD", "SOKUIKI Sensor " + model.name},
                         {"FIRM", "1.0.00(01/Jan./2026)"},
                         {"PROT", "SCIP 2.0"},
                         {"SERI", "S0000001"}});
  } else if (symbol == "PP") {
    reply_keys(request, {{"MODL", model.name},
                         {"DMIN", std::to_string(model.distance_min)},
                         {"DMAX", std::to_string(model.distance_max)},
                         {"ARES", std::to_string(model.steps_a_turn)},
                         {"AMIN", std::to_string(model.first)},
                         {"AMAX", std::to_string(model.last)},
                         {"AFRT", std::to_string(model.front)},
                         {"SCAN", std::to_string(model.turns_a_minute)}});
  } else if (symbol == "II") {
    char time[8];
    std::snprintf(time, sizeof time, "%06X", clock_at(now_ns));
    reply_keys(request, {{"MODL", model.name},
                         {"LASR", is_lit_ ? "ON" : "OFF"},
                         {"SCSP", "Initial(" + std::to_string(model.turns_a_minute) + "[rpm])"},
                         {"MESM", measuring_ ? "Measuring" : "Idle"},
                         {"SBPS", plan_.stops_on_disconnect ? "Ethernet 100 [Mbps]" : "USB Full Speed"},
                         {"TIME", time},
                         {"STAT", "Stable 000 no error."}});
  } else if (symbol == "BM") {
    take_light(request, now_ns);
  } else if (symbol == "QT") {
    if (is_in_clock_mode_) return false; // only TM2 leaves it
    put_out_light();
    sleeps_ = false;
    reply(request, "00");
  } else if (symbol == "RS" || symbol == "RT") {
    put_out_light();
    is_in_clock_mode_ = sleeps_ = false;
    power_up_ns_ = now_ns;
    scans_ = 0;
    clock_offset_ms_ = 0;
    if (symbol == "RS") baud_ = plan_.baud;
    reply(request, "00");
  } else if (symbol == "RB") {
    take_reboot(request, now_ns);
  } else if (symbol == "%ST") {
    const std::string code = state_code();
    reply(request, "00", code + scip::sum_of(code) + "\n");
  } else if (symbol == "%SL") {
    put_out_light();
    sleeps_ = true;
    reply(request, "00");
  } else {
    return false;
  }
  return true;
}

std::string ScipDevice::state_code() const {
  if (sleeps_) return "005";
  if (is_in_clock_mode_) return "002";
  if (measuring_) return "004";
  return is_lit_ ? "003" : "000";
}

void ScipDevice::take_light(const std::string& request, std::int64_t now_ns) {
  if (is_in_clock_mode_ || sleeps_) return reply(request, "10");
  if (is_lit_) return reply(request, "02");
  if (static_cast<double>(now_ns - power_up_ns_) < plan_.warm_up_s * 1e9) return reply(request, "01");
  is_lit_ = true;
  reply(request, "00");
}

void ScipDevice::take_reboot(const std::string& request, std::int64_t now_ns) {
  const bool is_confirmed = reboot_asked_ns_ >= 0 && now_ns - reboot_asked_ns_ <= kRebootNs;
  if (!is_confirmed) {
    reboot_asked_ns_ = now_ns;
    return reply(request, "01");
  }
  reboot_asked_ns_ = -1;
  power_up(now_ns);
  reply(request, "00");
  drops_link_ = true;
}

void ScipDevice::take_clock(const std::string& request, std::string_view body, std::int64_t now_ns) {
  if (body.size() != 1) return reply(request, body.empty() ? "0C" : "0D");
  if (body == "0") {
    if (is_in_clock_mode_) return reply(request, "02");
    put_out_light();
    is_in_clock_mode_ = true;
    return reply(request, "00");
  }
  if (body == "1") {
    if (!is_in_clock_mode_) return reply(request, "04");
    std::string time;
    scip::encode_number(time, clock_at(now_ns), 4);
    return reply(request, "00", time + scip::sum_of(time) + "\n");
  }
  if (body != "2") return reply(request, "01");
  if (!is_in_clock_mode_) return reply(request, "03");
  is_in_clock_mode_ = false;
  reply(request, "00");
}

std::string_view ScipDevice::parse_measuring(std::string_view body, Measuring& out) const {
  const std::string_view start = body.substr(0, 4);
  const std::string_view end = body.substr(4, 4);
  const std::string_view cluster = body.substr(8, 2);
  if (!are_digits(start)) return "01";
  if (!are_digits(end)) return "02";
  if (!are_digits(cluster)) return "03";
  out.start = digits_value(start);
  out.end = digits_value(end);
  out.cluster = std::max(1, digits_value(cluster));
  if (body.size() == kMeasuringDigits) {
    if (!are_digits(body.substr(10, 1))) return "06";
    if (!are_digits(body.substr(11, 2))) return "07";
    out.skip = digits_value(body.substr(10, 1));
    out.remaining = digits_value(body.substr(11, 2));
    out.is_endless = out.remaining == 0;
  }
  if (out.end > plan_.model.last || out.start < plan_.model.first) return "04";
  if (out.end < out.start) return "05";
  return {};
}

void ScipDevice::take_measuring(const std::string& request, std::string_view body, std::string_view tag, std::int64_t now_ns) {
  const bool is_single = request[0] == 'G' || request[0] == 'H';
  const bool has_echoes = request[0] == 'N' || request[0] == 'H';
  if ((has_echoes && !plan_.model.has_echoes) || (!is_single && plan_.is_single_only)) return reply(request, "0E");
  const std::size_t digits = is_single ? kSingleDigits : kMeasuringDigits;
  if (body.size() != digits) return reply(request, body.size() < digits ? "0C" : "0D");
  Measuring measuring;
  measuring.kind = request[1];
  measuring.has_echoes = has_echoes;
  if (const std::string_view refusal = parse_measuring(body, measuring); !refusal.empty()) return reply(request, refusal);
  if (is_in_clock_mode_ || sleeps_) return reply(request, "10");
  if (is_single) {
    if (!is_lit_) return reply(request, "10");
    if (!look_once(now_ns)) return reply(request, "0A");
    std::string scan;
    append_scan(scan, measuring, last_look_ns_);
    scan.pop_back(); // its empty line is the reply's
    return reply(request, "00", scan);
  }
  if (static_cast<double>(now_ns - power_up_ns_) < plan_.warm_up_s * 1e9) return reply(request, "0M");
  measuring.head = request.substr(0, request.size() - tag.size() - 2);
  measuring.tail = tag;
  measuring.next_ns = now_ns + period_ns();
  is_lit_ = true;
  measuring_ = std::move(measuring);
  reply(request, "00");
}

} // namespace scansion
