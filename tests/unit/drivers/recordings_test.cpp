// Every transcript in tests/recordings/drivers/<driver>/NAME.raw, played through its driver, gives NAME.golden.
// Options of the device stand in the transcript's head, one `#! key = value` a line.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/drivers/recordings_test.hpp"

#include "drivers/port/link_counters.hpp"
#include "drivers/registry.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

namespace scansion {

const DriverInfo& template_driver() noexcept;

namespace test {
namespace {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Defaults of the schema, then what the transcript's head says.
OptionValues options_of(const DriverInfo& info, const fs::path& transcript) {
  OptionValues values;
  const auto set = [&](const Option& row, const std::string& text) {
    switch (row.type) {
      case OptionType::integer: values.set(row.key, std::int64_t{std::stoll(text)}); break;
      case OptionType::number: values.set(row.key, std::stod(text)); break;
      case OptionType::flag: values.set(row.key, text == "true"); break;
      default: values.set(row.key, text); break;
    }
  };
  for (const Option& row : info.options) {
    if (const auto* flag = std::get_if<bool>(&row.standard)) values.set(row.key, *flag);
    if (const auto* whole = std::get_if<std::int64_t>(&row.standard)) values.set(row.key, *whole);
    if (const auto* real = std::get_if<double>(&row.standard)) values.set(row.key, *real);
    if (const auto* text = std::get_if<std::string_view>(&row.standard)) values.set(row.key, std::string(*text));
  }
  std::ifstream file(transcript);
  for (std::string line; std::getline(file, line) && line.starts_with('#');) {
    const std::size_t equals = line.find(" = ");
    if (!line.starts_with("#! ") || equals == std::string::npos) continue;
    const std::string key = line.substr(3, equals - 3);
    for (const Option& row : info.options) {
      if (row.key == key) set(row, line.substr(equals + 3));
    }
  }
  values.set("transcript", transcript.string());
  return values;
}

void print_stamp(std::ostream& out, const char* name, const std::optional<std::int64_t>& stamp) {
  if (stamp) out << ' ' << name << ' ' << *stamp;
}

void print_line(std::ostream& out, const LineBuffer& line) {
  out << "line";
  print_stamp(out, "device_ns", line.stamps.device_ns);
  print_stamp(out, "encoder", line.stamps.encoder);
  print_stamp(out, "host_ns", line.stamps.host_monotonic_ns);
  if (line.plane) out << " plane " << (*line.plane)[0] << ' ' << (*line.plane)[1] << ' ' << (*line.plane)[2];
  out << '\n';
  for (const Run& run : line.runs) {
    out << "  run of " << run.count << " after " << run.invalid_before << " invalid:";
    for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
      out << ' ' << line.xyz[0][i] << ',' << line.xyz[1][i] << ',' << line.xyz[2][i];
    }
    out << '\n';
  }
  if (line.invalid_after > 0) out << "  " << line.invalid_after << " invalid at the end\n";
}

/// One session after the other, as the daemon does it, until the transcript ends.
void play(Driver& driver, std::ostream& out) {
  LineBuffer line;
  for (int session = 0; session < 100; ++session) {
    if (auto opened = driver.open(); !opened) {
      out << "not opened\n";
      return;
    }
    auto facts = driver.start();
    if (facts) {
      const Lattice& lattice = facts.assume_value().lattice;
      out << "started, resolution " << lattice.resolution.num << '/' << lattice.resolution.den << '\n';
    }
    bool failed = !facts;
    if (failed) out << "not started: " << explain(facts.assume_error().code) << '\n';
    while (!failed) {
      line.clear();
      Gap gap;
      auto delivery = driver.next(line, gap);
      if (!delivery) {
        out << "lost: " << explain(delivery.assume_error().code) << '\n';
        failed = true;
      } else if (delivery.assume_value() == Delivery::line) {
        print_line(out, line);
      } else if (delivery.assume_value() == Delivery::gap) {
        out << "gap of " << (gap.count ? std::to_string(*gap.count) : "unknown") << ": " << gap.reason << '\n';
      } else if (delivery.assume_value() == Delivery::end) {
        driver.close();
        return;
      }
    }
    driver.close();
    // The end of the transcript while starting: nothing more can come.
    if (!facts && facts.assume_error().context.find("ended before") != std::string::npos) return;
  }
}

std::string played(const DriverInfo& info, const fs::path& transcript) {
  std::ostringstream out;
  auto driver = info.make(options_of(info, transcript));
  if (!driver) return "not made: " + driver.assume_error().context + "\n";
  play(*driver.assume_value(), out);
  const LinkView link = driver.assume_value()->link();
  out << "accepted " << link.counters->accepted;
  for (std::size_t i = 0; i < kRejects; ++i) {
    out << ", " << name(static_cast<Reject>(i)) << ' ' << link.counters->rejects[i];
  }
  out << '\n';
  return out.str();
}

TEST(DriverRecordings, GiveTheirGoldenLines) {
  std::vector<const DriverInfo*> all(drivers().begin(), drivers().end());
  all.push_back(&template_driver());
  const fs::path root = SCANSION_DRIVER_RECORDINGS;
  for (const DriverInfo* info : all) {
    if (info->name == "replay") continue; // has no bytes
    const fs::path folder = root / info->name;
    int transcripts = 0;
    if (fs::is_directory(folder)) {
      for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() != ".raw") continue;
        ++transcripts;
        fs::path golden = entry.path();
        golden.replace_extension(".golden");
        const std::string now = played(*info, entry.path());
        if (update_golden) std::ofstream(golden, std::ios::binary) << now;
        EXPECT_EQ(now, read_file(golden)) << golden << "; if that is wanted: driver_recordings_test --update";
      }
    }
    EXPECT_GT(transcripts, 0) << info->name << " has no recording in " << folder;
  }
}

} // namespace
} // namespace test
} // namespace scansion
