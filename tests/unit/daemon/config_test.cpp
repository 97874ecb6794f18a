// The configuration: values, places and wording of errors, the printed form.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.hpp"
#include "daemon/config/nearest.hpp"

#include <gtest/gtest.h>
#include <sstream>
#include <sys/stat.h>
#include <unistd.h>

namespace scansion {
namespace {

std::string error_of(std::string_view text) {
  auto config = parse_config(text, "c.toml");
  if (config) return "no error";
  EXPECT_EQ(config.assume_error().code, Errc::config);
  return config.assume_error().context;
}

TEST(Config, EmptyFileHasAllDefaults) {
  auto config = parse_config("", "c.toml");
  ASSERT_TRUE(config);
  const Config& value = config.assume_value();
  EXPECT_EQ(value.recording, (RecordingConfig{"/var/lib/scansion", 100, 250, 1024, 256, 60}));
  EXPECT_EQ(value.socket, "");
  EXPECT_EQ(value.levels, LevelSpec{});
  EXPECT_TRUE(value.devices.empty());
}

TEST(Config, ReadsEveryKey) {
  auto config = parse_config(R"([recording]
directory = "/data"
sync_interval_ms = 50
group_ms = 20
min_free_mb = 0
rotate_mb = 1
rotate_minutes = 2
[control]
socket = "/run/x.sock"
[pipeline]
levels = "explicit:1,0.1"
[[device]]
name = "table-1"
driver = "replay"
file = "scan.xyz"
format = "xyz"
unit = "um"
resolution = 0.005
gap = 2
rate = 500
loop = true
)",
                             "c.toml");
  ASSERT_TRUE(config) << config.assume_error().context;
  const Config& value = config.assume_value();
  EXPECT_EQ(value.recording, (RecordingConfig{"/data", 50, 20, 0, 1, 2}));
  EXPECT_EQ(value.socket, "/run/x.sock");
  EXPECT_EQ(value.levels.explicit_tolerances, (std::vector<double>{1.0, 0.1}));
  ASSERT_EQ(value.devices.size(), 1U);
  const DeviceConfig& device = value.devices[0];
  EXPECT_EQ(device.name, "table-1");
  EXPECT_EQ(device.driver->name, "replay");
  EXPECT_EQ(device.options.text("file"), "scan.xyz");
  EXPECT_EQ(device.options.text("resolution"), "0.005");
  EXPECT_EQ(device.options.get<double>("gap"), 2.0);
  EXPECT_EQ(device.options.text("rate"), "500");
  EXPECT_TRUE(device.options.flag("loop"));
}

TEST(Config, UnknownKeyNamesPlaceAndNearest) {
  EXPECT_EQ(error_of("[recording]\n  group_sm = 250\n"), "c.toml:2:3: unknown key \"group_sm\"; nearest is \"group_ms\"");
  EXPECT_EQ(error_of("[recordings]\n"), "c.toml:1:2: unknown key \"recordings\"; nearest is \"recording\"");
  EXPECT_EQ(error_of("[[device]]\nname = \"a\"\ndriver = \"replay\"\nfile = \"f\"\n\nlopo = true\n"),
            "c.toml:6:1: unknown key \"lopo\"; nearest is \"loop\"");
}

TEST(Config, WrongTypesAndRanges) {
  EXPECT_EQ(error_of("[recording]\ngroup_ms = \"250\"\n"), "c.toml:2:12: group_ms must be an integer");
  EXPECT_EQ(error_of("[recording]\ngroup_ms = 0\n"), "c.toml:2:12: group_ms = 0 is out of range; it must be from 1 to 60000");
  EXPECT_EQ(error_of("[recording]\ndirectory = 5\n"), "c.toml:2:13: directory must be a text in quotes");
  EXPECT_EQ(error_of("recording = 5\n"), "c.toml:1:13: \"recording\" must be a table: [recording]");
  EXPECT_EQ(error_of("device = 5\n"), "c.toml:1:10: \"device\" must be an array of tables: [[device]]");
  EXPECT_EQ(error_of("[device]\nname = \"a\"\n"), "c.toml:1:1: \"device\" must be an array of tables: [[device]]");
  EXPECT_NE(error_of("[pipeline]\nlevels = \"cubic:3\"\n").find("c.toml:2:10: levels = \"cubic:3\" is not a choice of levels"),
            std::string::npos);
}

TEST(Config, DeviceErrors) {
  const std::string head = "[[device]]\nname = \"a\"\ndriver = \"replay\"\nfile = \"f\"\n";
  EXPECT_EQ(error_of(head + "rate = \"fast\"\n"),
            "c.toml:5:8: rate = \"fast\" is neither \"max\" nor a number of lines per second from 0.001 to 1000000");
  EXPECT_EQ(error_of(head + "rate = 0\n"),
            "c.toml:5:8: rate = \"0\" is neither \"max\" nor a number of lines per second from 0.001 to 1000000");
  EXPECT_EQ(error_of(head + "unit = \"parsec\"\n"), "c.toml:5:8: unit = \"parsec\" is none of m, mm, um, in, ft");
  EXPECT_EQ(error_of(head + head), "c.toml:6:8: a second device is called \"a\"; names must be unique");
  EXPECT_EQ(error_of("[[device]]\nname = \"a b\"\ndriver = \"replay\"\nfile = \"f\"\n"),
            "c.toml:2:8: name = \"a b\" must be 1 to 64 letters, digits, '.', '_' or '-', not starting with '.'");
  EXPECT_EQ(
      error_of("[[device]]\nname = \"a\"\ndriver = \"replay\"\n"),
      "c.toml:1:1: key \"file\" is missing: recorded scan to play: a file, a folder or an archive that `scansion compress` "
      "reads");
  std::string known;
  for (const DriverInfo* driver : drivers()) known.append(known.empty() ? "" : ", ").append(driver->name);
  EXPECT_EQ(error_of("[[device]]\nname = \"a\"\ndriver = \"repaly\"\n"),
            "c.toml:3:10: driver = \"repaly\" is no driver of this build; there are: " + known);
  EXPECT_EQ(error_of("[[device]]\nname = \"a\"\n"), "c.toml:1:1: key \"driver\" is missing: how to talk to the device");
}

TEST(Config, AllProblemsAreReportedInOneGo) {
  const std::string text = error_of("[recording]\na = 1\ngroup_ms = 0\n[control]\nsocket = \"\"\n");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
}

TEST(Config, NumberOfProblemsIsBounded) {
  std::string text = "[recording]\n";
  for (int i = 0; i < 50; ++i) text += "unknown" + std::to_string(i) + " = 1\n";
  const std::string error = error_of(text);
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 20);
  EXPECT_NE(error.find("c.toml: 30 more problems"), std::string::npos);
}

TEST(Config, SyntaxErrorHasItsPlace) {
  EXPECT_EQ(error_of("[recording]\ngroup_ms 250\n").substr(0, 9), "c.toml:2:");
  EXPECT_EQ(error_of("a = 1\na = 2\n").substr(0, 9), "c.toml:2:");
}

/// Both ended in an assertion of the parser.
TEST(Config, StrangeTableHeadsAreErrors) {
  EXPECT_EQ(error_of("[.a]\n").substr(0, 9), "c.toml:1:");
  EXPECT_EQ(error_of("\n[[[a]]]\n").substr(0, 9), "c.toml:2:");
}

/// Letters beyond ASCII where a space may stand: undefined behaviour of the parser once.
TEST(Config, StrangeLettersAreErrors) {
  EXPECT_EQ(error_of("\n\xC3\xA4\n").substr(0, 9), "c.toml:2:");
  EXPECT_EQ(error_of("device\xC3\xA4|\xEA\x9E\x92"
                     "e = 1\n")
                .substr(0, 9),
            "c.toml:1:");
  EXPECT_EQ(error_of("[control]\nsocket = \"\"\"\\\n\xC2\xA7\"\"\"\n"), "no error");
}

TEST(Config, PrintedFormReadsBackTheSame) {
  auto first = parse_config("[recording]\ngroup_ms = 20\n[control]\nsocket = \"/a \\\"b\\\"\"\n[[device]]\nname = \"x\"\n"
                            "driver = \"replay\"\nfile = \"\\u00e9\\\\\"\ngap = 3\nrate = 12.5\n",
                            "c.toml");
  ASSERT_TRUE(first) << first.assume_error().context;
  const std::string printed = print_config(first.assume_value());
  auto second = parse_config(printed, "c.toml");
  ASSERT_TRUE(second) << second.assume_error().context << "\n" << printed;
  EXPECT_EQ(second.assume_value().recording_values, first.assume_value().recording_values);
  EXPECT_EQ(second.assume_value().control_values, first.assume_value().control_values);
  EXPECT_EQ(second.assume_value().pipeline_values, first.assume_value().pipeline_values);
  EXPECT_EQ(second.assume_value().devices, first.assume_value().devices);
}

/// Uncommenting the example of the sample gives a device that is accepted.
TEST(Config, ExampleDeviceOfTheSampleIsValid) {
  auto defaults = parse_config("", "c.toml");
  ASSERT_TRUE(defaults);
  std::istringstream lines(print_config(defaults.assume_value()));
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() > 1 && line[0] == '#' && line[1] != ' ') line.erase(0, 1);
    text += line + '\n';
  }
  auto config = parse_config(text, "c.toml");
  ASSERT_TRUE(config) << config.assume_error().context;
  EXPECT_EQ(config.assume_value().devices.size(), drivers().size());
}

TEST(Config, MissingFileIsAConfigurationError) {
  auto config = load_config("/nonexistent/c.toml");
  ASSERT_FALSE(config);
  EXPECT_EQ(config.assume_error().code, Errc::config);
  EXPECT_EQ(config.assume_error().context,
            "/nonexistent/c.toml: cannot read the configuration: No such file or directory; name another file with --config");
}

TEST(Config, HugeAndEndlessFilesAreRefused) {
  auto config = load_config("/dev/zero");
  ASSERT_FALSE(config);
  EXPECT_EQ(config.assume_error().context, "/dev/zero: larger than 1 MiB, so not a configuration");
}

TEST(NearestName, CountsSwapsAsOne) {
  const std::string_view names[] = {"rate_max", "name", "group_ms"};
  EXPECT_EQ(nearest_name("gruop_ms", names), "group_ms");
  EXPECT_EQ(nearest_name("nmae", names), "name");
  EXPECT_EQ(nearest_name("x", {}), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'a'), names), "rate_max");
}

} // namespace
} // namespace scansion
