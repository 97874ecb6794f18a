// The keys of the configuration's own tables.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/schema.hpp"

#include "drivers/registry.hpp"
#include "pipeline/model/alpha_set.hpp"

namespace scansion {
namespace {

/// sun_path of a Unix socket address, less the closing zero.
constexpr std::size_t kMaxSocketPath = 107;
constexpr std::size_t kMaxDeviceName = 64;

Result<void> check_directory(std::string_view text) {
  if (text.empty()) return fail(Errc::config, "is empty; name a directory");
  return success();
}

Result<void> check_socket(std::string_view text) {
  if (text.empty() || text.size() > kMaxSocketPath) return fail(Errc::config, "must be a path of 1 to 107 bytes");
  return success();
}

Result<void> check_levels(std::string_view text) {
  auto spec = parse_level_spec(text);
  if (!spec) return fail(Errc::config, "is not a choice of levels: ", spec.assume_error().context);
  return success();
}

Result<void> check_floor(std::string_view text) {
  auto floor = parse_floor(text);
  if (!floor) return fail(Errc::config, "is no floor: ", floor.assume_error().context);
  return success();
}

Result<void> check_name(std::string_view text) {
  const auto allowed = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
  };
  // A leading dot would hide the recordings.
  if (text.empty() || text.size() > kMaxDeviceName || text.front() == '.' || !std::all_of(text.begin(), text.end(), allowed)) {
    return fail(Errc::config, "must be 1 to 64 letters, digits, '.', '_' or '-', not starting with '.'");
  }
  return success();
}

Result<void> check_linking(std::string_view text) {
  if (text == "soft" || text == "paper") return success();
  return fail(Errc::config, "is none of soft, paper");
}

Result<void> check_backlash(std::string_view text) {
  if (text == "report" || text == "correct") return success();
  return fail(Errc::config, "is none of report, correct");
}

Result<void> check_driver(std::string_view text) {
  if (find_driver(text) != nullptr) return success();
  std::string known;
  for (const DriverInfo* driver : drivers()) known.append(known.empty() ? "" : ", ").append(driver->name);
  return fail(Errc::config, "is no driver of this build; there are: ", known);
}

} // namespace

const Section& recording_section() noexcept {
  static const Option rows[] = {
      {.key = "directory",
       .standard = "/var/lib/scansion",
       .meaning = "where recordings are written; made when missing",
       .check = check_directory},
      {.key = "sync_interval_ms",
       .type = OptionType::integer,
       .standard = std::int64_t{100},
       .meaning = "a power cut loses at most this much and the open group",
       .min = 1,
       .max = 60'000},
      {.key = "group_ms",
       .type = OptionType::integer,
       .standard = std::int64_t{250},
       .meaning = "a group of lines closes after this time, or when it is full (64 lines or 262144 points)",
       .min = 1,
       .max = 60'000},
      {.key = "min_free_mb",
       .type = OptionType::integer,
       .standard = std::int64_t{1024},
       .meaning = "recording stops, and waits, when less than this is free on the disk",
       .min = 0,
       .max = 1e9},
      {.key = "rotate_mb",
       .type = OptionType::integer,
       .standard = std::int64_t{256},
       .meaning = "a new file is started at this size ...",
       .min = 1,
       .max = 1e6},
      {.key = "rotate_minutes",
       .type = OptionType::integer,
       .standard = std::int64_t{60},
       .meaning = "... or at this age",
       .min = 1,
       .max = 525'600},
  };
  static const Section section{"recording", "Where and how recordings are written.", rows};
  return section;
}

const Section& control_section() noexcept {
  static const Option rows[] = {
      {.key = "socket",
       .meaning =
           "Unix socket for `scansion status`; without it control.sock in $RUNTIME_DIRECTORY, in /run/scansion for root, "
           "or in $XDG_RUNTIME_DIR/scansion",
       .check = check_socket,
       .example = "\"/run/scansion/control.sock\""},
  };
  static const Section section{"control", "How other programs talk to the daemon.", rows};
  return section;
}

const Section& pipeline_section() noexcept {
  static const Option rows[] = {
      {.key = "levels",
       .standard = "geometric:3",
       .meaning = "levels of detail: geometric:N[:RATIO], uniform:N[:DMAX] or explicit:T1,T2,... (mm)",
       .check = check_levels},
      {.key = "floor",
       .standard = "off",
       .meaning = "rank no finer than this: off, half (a count) or mm as text, \"0.01\"; stated in the recording",
       .check = check_floor},
  };
  static const Section section{"pipeline", "How lines are divided into levels of detail.", rows};
  return section;
}

const Section& device_section() noexcept {
  static const Option rows[] = {
      {.key = "name",
       .meaning = "unique; part of file and channel names",
       .required = true,
       .check = check_name,
       .example = "\"table-1\""},
      {.key = "driver", .meaning = "how to talk to the device", .required = true, .check = check_driver},
      {.key = "features",
       .type = OptionType::flag,
       .standard = true,
       .meaning = "look for feature lines and patches while recording"},
      {.key = "linking",
       .standard = "soft",
       .meaning = "how points are linked to feature lines: soft, or paper (equality of all classes)",
       .check = check_linking},
      {.key = "backlash",
       .standard = "report",
       .meaning = "of lines to and fro: report, or correct where features are looked for (points stay as they are)",
       .check = check_backlash},
      {.key = "noise",
       .type = OptionType::number,
       .meaning = "sigma of the heights in mm, measured once on a flat target; without it estimated line by line",
       .min = 1e-6,
       .max = 1e6,
       .example = "0.02"},
      {.key = "noise_correlation",
       .type = OptionType::number,
       .standard = 1.0,
       .meaning = "the estimate of the noise is multiplied by this; 3 for laser triangulation",
       .min = 0.1,
       .max = 100},
      {.key = "least_turning",
       .type = OptionType::number,
       .standard = 7.0,
       .meaning = "degrees: an edge that turns less is none",
       .min = 2,
       .max = 90},
      {.key = "least_step",
       .type = OptionType::number,
       .standard = 0.09,
       .meaning = "mm: a lower step is none; below 8 sigma of the noise none is found",
       .min = 1e-6,
       .max = 1e6},
      {.key = "largest_arc",
       .type = OptionType::number,
       .standard = 3.0,
       .meaning = "mm: an arc of a larger radius is a smooth surface and no rounded edge; at least 6 pitches or spacings",
       .min = 1e-6,
       .max = 1e6},
      {.key = "shortest_line",
       .type = OptionType::number,
       .standard = 0.0,
       .meaning = "mm: shorter feature lines part patches, but are not recorded",
       .min = 0,
       .max = 1e6},
  };
  static const Section section{"device", "One table a device.", rows};
  return section;
}

} // namespace scansion
