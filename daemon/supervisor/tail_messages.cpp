// Messages of devices for `scansion tail`.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/tail_messages.hpp"

#include "daemon/control/status.hpp"
#include "pipeline/record/notes.hpp"

#include <nlohmann/json.hpp>

namespace scansion {
namespace {

using Json = nlohmann::ordered_json;

/// A path may be no text: what is not becomes U+FFFD.
std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void tell(TailHub& hub, TailTopic topic, const Json& json) {
  hub.publish(topic, dumped(json));
}

class TellingSink final : public RecordingSink {
public:
  TellingSink(std::unique_ptr<RecordingSink> sink, TailHub& hub, std::string device, std::string path)
      : sink_(std::move(sink)), hub_(hub), device_(std::move(device)), path_(std::move(path)) {
    tell_file("recording begun");
  }
  Result<void> append(const EncodedGroup& group, std::uint64_t points, std::uint64_t runs, std::uint64_t invalid) override {
    return sink_->append(group, points, runs, invalid);
  }
  Result<void> append(const Gap& gap, std::uint64_t log_time_ns) override {
    SCANSION_TRY(sink_->append(gap, log_time_ns));
    if (hub_.wanted(TailTopic::events)) {
      tell(hub_, TailTopic::events,
           {{"device", device_},
            {"event", "gap"},
            {"first", gap.first},
            {"count", gap.count ? Json(*gap.count) : Json(nullptr)},
            {"reason", gap.reason}});
    }
    return success();
  }
  Result<void> append(FeatureReport& report, std::uint64_t log_time_ns) override {
    if (hub_.wanted(TailTopic::features)) {
      for (const FeatureLine& line : report.lines) {
        // Ids count anew in each recording.
        std::string text = dumped({{"device", device_}, {"recording", path_}});
        text.back() = ',';
        text += "\"feature\":";
        append_feature_line(text, line);
        hub_.publish(TailTopic::features, text + '}');
      }
    }
    return sink_->append(report, log_time_ns);
  }
  Result<void> sync() override { return sink_->sync(); }
  Result<void> finish(std::int64_t ended_ns, double rounding_mm) override {
    SCANSION_TRY(sink_->finish(ended_ns, rounding_mm));
    tell_file("recording finished");
    return success();
  }
  std::uint64_t bytes() const noexcept override { return sink_->bytes(); }

private:
  void tell_file(std::string_view event) {
    if (!hub_.wanted(TailTopic::events)) return;
    tell(hub_, TailTopic::events, {{"device", device_}, {"event", event}, {"path", path_}, {"bytes", sink_->bytes()}});
  }
  std::unique_ptr<RecordingSink> sink_;
  TailHub& hub_;
  std::string device_, path_;
};

} // namespace

void tell_lines(TailHub& hub, std::string_view device, const LineGroup& group) {
  if (!hub.wanted(TailTopic::lines)) return;
  for (const ScanLine& line : group.lines) {
    std::uint64_t points = 0;
    std::uint64_t invalid = line.invalid_after;
    for (const Run& run : group.runs_of(line)) {
      points += run.count;
      invalid += run.invalid_before;
    }
    const auto& stamp = line.stamps.host_realtime_ns;
    tell(hub, TailTopic::lines,
         {{"device", device},
          {"line", line.index},
          {"points", points},
          {"runs", line.run_count},
          {"invalid", invalid},
          {"realtime", stamp ? Json(iso_time(*stamp)) : Json(nullptr)}});
  }
}

void tell_state(TailHub& hub, std::string_view device, std::string_view state) {
  if (hub.wanted(TailTopic::events)) tell(hub, TailTopic::events, {{"device", device}, {"event", "state"}, {"state", state}});
}

SinkFactory telling_sinks(SinkFactory sinks, TailHub& hub) {
  return [sinks = std::move(sinks), &hub](const std::string& path,
                                          const RecordingFacts& facts) -> Result<std::unique_ptr<RecordingSink>> {
    SCANSION_TRY(sink, sinks(path, facts));
    return std::unique_ptr<RecordingSink>(std::make_unique<TellingSink>(std::move(sink), hub, facts.device, path));
  };
}

} // namespace scansion
