// scansion record: one device recorded without a daemon, with its raw bytes where they are wanted.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/record.hpp"

#include "daemon/config/config.hpp"
#include "daemon/config/schema.hpp"
#include "daemon/supervisor/device_session.hpp"
#include "daemon/supervisor/supervisor.hpp"

#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace scansion::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr SteadyNs kStopBudget = 1700 * kMillisecond;
constexpr SteadyNs kLook = 50 * kMillisecond;

struct Options {
  std::vector<std::string> words; ///< a device's name, or with --driver KEY=VALUE
  std::string config{kDefaultConfigFile};
  std::string driver, raw, out = ".";
  std::uint64_t lines = 0; ///< 0: no end
  double seconds = 0.0;    ///< 0: no end
  bool force = false, json = false;
};

/// `key = value` as TOML. Texts need no quotes on a command line.
Result<std::string> toml_row(const DriverInfo& driver, const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos || equals == 0) return fail(Errc::usage, word, ": is no KEY=VALUE");
  const std::string key = word.substr(0, equals);
  std::string value = word.substr(equals + 1);
  const auto is_text_in = [&](std::span<const Option> options) {
    return std::any_of(options.begin(), options.end(), [&](const Option& o) {
      return o.key == key && (o.type == OptionType::text || o.type == OptionType::text_or_number);
    });
  };
  const bool is_text = is_text_in(driver.options) || is_text_in(device_section().options);
  if (is_text) value = Json(value).dump(-1, ' ', false, Json::error_handler_t::replace);
  return key + " = " + value + "\n";
}

/// A configuration with the one device that the words describe.
Result<Config> described(const Options& o) {
  const DriverInfo* driver = find_driver(o.driver);
  if (driver == nullptr) return fail(Errc::usage, "--driver ", o.driver, ": unknown; see scansiond.toml(5)");
  std::string text = "[[device]]\ndriver = \"" + o.driver + "\"\n";
  bool has_name = false;
  for (const std::string& word : o.words) {
    SCANSION_TRY(row, toml_row(*driver, word));
    has_name |= row.starts_with("name = ");
    text += row;
  }
  if (!has_name) text += "name = \"" + o.driver + "\"\n";
  return parse_config(text, "command line");
}

/// The configuration file, with the named device alone.
Result<Config> configured(const Options& o) {
  if (o.words.size() > 1) return fail(Errc::usage, "give one device of ", o.config, ", or --driver with KEY=VALUE");
  SCANSION_TRY(config, load_config(o.config));
  if (o.words.empty() && config.devices.size() != 1)
    return fail(Errc::usage, o.config, ": has ", std::to_string(config.devices.size()), " devices; name one");
  if (!o.words.empty()) std::erase_if(config.devices, [&](const DeviceConfig& device) { return device.name != o.words[0]; });
  if (config.devices.empty()) return fail(Errc::usage, o.config, ": has no device \"", o.words[0], "\"");
  return config;
}

/// A transcript that begins in the middle of another one would not replay.
Result<void> ask_for_raw(const Options& o, DeviceConfig& device) {
  if (o.raw.empty()) return success();
  const auto& rows = device.driver->options;
  if (std::none_of(rows.begin(), rows.end(), [](const Option& row) { return row.key == "raw"; }))
    return fail(Errc::usage, "--raw: a ", device.driver->name, " device has no bytes to write");
  std::error_code error;
  if (fs::exists(o.raw, error) && fs::file_size(o.raw, error) > 0) {
    if (!o.force) return fail(Errc::exists, o.raw, ": is there already; remove it or give --force");
    if (!fs::remove(o.raw, error)) return fail(Errc::cannot_create, o.raw, ": cannot be replaced: ", error.message());
  }
  device.options.set("raw", o.raw);
  return success();
}

/// Where recordings go: below a folder under the daemon's names, or to one file, with the later ones of further runs beside it.
class Output {
public:
  Output(const std::string& out, bool force) : out_(out), is_file_(out.ends_with(".mcap")), force_(force) {}

  [[nodiscard]] std::string folder() const {
    if (!is_file_) return out_;
    const std::string parent = fs::path(out_).parent_path().string();
    return parent.empty() ? "." : parent;
  }
  /// Fails with exists before the device is touched.
  [[nodiscard]] Result<void> check() const {
    std::error_code error;
    if (!is_file_ || force_ || !fs::exists(out_, error)) return success();
    return fail(Errc::exists, out_, ": is there already; give another name or --force");
  }
  [[nodiscard]] SinkFactory sinks() {
    return [this, open = file_sinks()](const std::string& path,
                                       const RecordingFacts& facts) -> Result<std::unique_ptr<RecordingSink>> {
      const std::string name = is_file_ ? numbered() : path;
      if (is_file_ && force_) ::unlink(name.c_str());
      SCANSION_TRY(sink, open(name, facts));
      const std::lock_guard lock(mutex_);
      files_.push_back(name);
      return sink;
    };
  }
  [[nodiscard]] std::vector<std::string> files() const {
    const std::lock_guard lock(mutex_);
    return files_;
  }

private:
  [[nodiscard]] std::string numbered() const {
    const std::lock_guard lock(mutex_);
    if (files_.empty()) return out_;
    char number[16];
    std::snprintf(number, sizeof number, "-%03zu.mcap", files_.size() + 1);
    return out_.substr(0, out_.size() - 5) + number;
  }

  const std::string out_;
  const bool is_file_, force_;
  mutable std::mutex mutex_;
  std::vector<std::string> files_; ///< begun so far
};

/// True when SIGINT or SIGTERM came within `wait`.
bool stop_came(const sigset_t& signals, SteadyNs wait) {
  const timespec time{wait / kSecond, wait % kSecond};
  return ::sigtimedwait(&signals, nullptr, &time) > 0;
}

/// Until it is asked to stop, has what was asked for, or nothing more will come. Fails when the device was given up.
Result<void> watch(const DeviceSession& session, const Options& o, const sigset_t& signals, Clock& clock) {
  const SteadyNs end = o.seconds > 0.0 ? clock.steady_ns() + static_cast<SteadyNs>(o.seconds * 1e9) : kNever;
  while (!stop_came(signals, kLook)) {
    const DeviceStatus status = session.status();
    if (status.state == name(SessionState::closed)) return fail(Errc::unavailable, status.name, ": ", status.error);
    if (status.state == name(SessionState::finished) && status.lag_ms == 0) break;
    if ((o.lines > 0 && status.lines >= o.lines) || clock.steady_ns() >= end) break;
  }
  return success();
}

void print_report(const Options& o, const DeviceStatus& status, const std::vector<std::string>& files) {
  const std::uint64_t raw_dropped = status.link ? status.link->raw_dropped : 0;
  if (o.json) {
    const Json out{
        {"files", files},      {"lines", status.lines_written},   {"points", status.points},   {"invalid", status.invalid},
        {"gaps", status.gaps}, {"lost_lines", status.lost_lines}, {"raw_dropped", raw_dropped}};
    std::printf("%s\n", out.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    return;
  }
  for (const std::string& file : files) std::printf("%s\n", file.c_str());
  say(std::to_string(status.lines_written) + " lines, " + std::to_string(status.gaps) + " gaps");
  if (status.lost_lines > 0) say(std::to_string(status.lost_lines) + " lines were not written: the disk refused them");
  if (raw_dropped > 0) say(o.raw + ": is full (raw_limit_mb); what came later is not in it");
}

Result<int> run_record(const Options& o) {
  SCANSION_TRY(config, o.driver.empty() ? configured(o) : described(o));
  DeviceConfig& device = config.devices.front();
  SCANSION_TRY(ask_for_raw(o, device));
  Output output(o.out, o.force);
  SCANSION_TRY(output.check());
  SCANSION_TRY(driver, device.driver->make(device.options));
  SCANSION_TRY(directory, JournalDirectory::open(output.folder()));

  auto logger = std::make_shared<spdlog::logger>("record", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("scansion: %v");
  logger->set_level(spdlog::level::warn);
  spdlog::set_default_logger(std::move(logger));
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr); // before the session's threads start

  SystemClock clock;
  const SessionSettings settings = session_settings(config);
  const JournalPorts ports{directory, output.sinks(), {}};
  DeviceSession session(device, std::move(driver), settings, ports, clock);
  const auto watched = watch(session, o, signals, clock);
  const SteadyNs now = clock.steady_ns();
  session.request_stop();
  const bool let_go = session.wait_device(now + kStopBudget / 4 * 3);
  const bool is_written = session.wait_recording(now + kStopBudget);
  const DeviceStatus status = session.status();
  print_report(o, status, output.files());
  if (!let_go || !is_written) {
    say("a stuck device or disk is left behind");
    std::fflush(stdout);
    ::_exit(exit_code(Errc::io)); // its thread still uses what destructors would take away
  }
  SCANSION_TRY(watched);
  if (output.files().empty())
    return fail(Errc::unavailable, device.name, ": no line came", status.error.empty() ? "" : "; ", status.error);
  const bool is_whole = status.lost_lines == 0 && (!status.link || status.link->raw_dropped == 0);
  return is_whole ? kDone : kBadAnswer;
}

} // namespace

Verb add_record(CLI::App& root) {
  auto* app = root.add_subcommand("record", "Record one device without the daemon");
  auto o = std::make_shared<Options>();
  app->add_option("device", o->words, "A device of the configuration; with --driver KEY=VALUE ..., as in scansiond.toml(5)");
  app->add_option("--config", o->config, "The daemon's configuration file")->capture_default_str();
  app->add_option("--driver", o->driver, "Describe the device here: its driver");
  app->add_option("--raw", o->raw, "Write all its bytes with their times to this file: a transcript to play again");
  app->add_option("-o,--output", o->out, "A folder (default .), or one recording NAME.mcap; later runs are NAME-002.mcap ...");
  app->add_option("--lines", o->lines, "Stop when so many lines came");
  app->add_option("--seconds", o->seconds, "Stop after this time")->check(CLI::NonNegativeNumber);
  app->add_flag("--force", o->force, "Replace existing files");
  app->add_flag("--json", o->json, "Print JSON");
  return {app, [o] { return run_record(*o); }};
}

} // namespace scansion::cli
