// The daemon's log.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/log.hpp"

#include <cstdlib>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace scansion {
namespace {

/// `<3>` and the like, as in sd-daemon(3).
class SyslogMark final : public spdlog::custom_flag_formatter {
public:
  void format(const spdlog::details::log_msg& message, const std::tm& /*time*/, spdlog::memory_buf_t& out) override {
    char mark = '7';
    switch (message.level) {
      case spdlog::level::info: mark = '6'; break;
      case spdlog::level::warn: mark = '4'; break;
      case spdlog::level::err: mark = '3'; break;
      case spdlog::level::critical: mark = '2'; break;
      default: break;
    }
    out.push_back('<');
    out.push_back(mark);
    out.push_back('>');
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return spdlog::details::make_unique<SyslogMark>();
  }
};

} // namespace

Result<void> start_log(const std::string& level) {
  const auto parsed = spdlog::level::from_str(level);
  if (parsed == spdlog::level::off) {
    return fail(Errc::usage, "--log-level ", level, " is none of trace, debug, info, warning, error, critical");
  }
  auto logger = std::make_shared<spdlog::logger>("scansiond", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  if (std::getenv("JOURNAL_STREAM") != nullptr) { // journald adds the time itself
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<SyslogMark>('*').set_pattern("%*%v");
    logger->set_formatter(std::move(formatter));
  } else {
    logger->set_formatter(
        std::make_unique<spdlog::pattern_formatter>("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc));
  }
  logger->set_level(parsed);
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(std::move(logger));
  return success();
}

} // namespace scansion
