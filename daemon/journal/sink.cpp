// Recording files as sinks.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal/sink.hpp"

#include "pipeline/record/writer.hpp"

namespace scansion {
namespace {

class FileSink final : public RecordingSink {
public:
  explicit FileSink(RecordingWriter writer) : writer_(std::move(writer)) {}

  Result<void> append(const EncodedGroup& group, std::uint64_t points, std::uint64_t runs, std::uint64_t invalid) override {
    return writer_.append(group, points, runs, invalid);
  }
  Result<void> append(const Gap& gap, std::uint64_t log_time_ns) override { return writer_.append(gap, log_time_ns); }
  Result<void> append(FeatureReport& report, std::uint64_t log_time_ns) override { return writer_.append(report, log_time_ns); }
  Result<void> sync() override { return writer_.sync(); }
  Result<void> finish(std::int64_t ended_ns, double rounding_mm) override { return writer_.finish(ended_ns, rounding_mm); }
  std::uint64_t bytes() const noexcept override { return writer_.bytes(); }

private:
  RecordingWriter writer_;
};

} // namespace

SinkFactory file_sinks() {
  return [](const std::string& path, const RecordingFacts& facts) -> Result<std::unique_ptr<RecordingSink>> {
    SCANSION_TRY(writer, RecordingWriter::create(path, facts));
    return std::unique_ptr<RecordingSink>(std::make_unique<FileSink>(std::move(writer)));
  };
}

} // namespace scansion
