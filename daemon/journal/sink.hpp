// Where encoded groups go: a recording file, or a stand-in with faults in tests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/payload.hpp"
#include "pipeline/feature/feature_line.hpp"
#include "pipeline/model/scan_line.hpp"
#include "pipeline/record/recording.hpp"

#include <functional>
#include <memory>
#include <string>

namespace scansion {

/// One open recording; the meaning of each call is that of RecordingWriter. Thread-bound.
class RecordingSink {
public:
  RecordingSink() = default;
  RecordingSink(const RecordingSink&) = delete;
  RecordingSink& operator=(const RecordingSink&) = delete;
  virtual ~RecordingSink() = default;

  [[nodiscard]] virtual Result<void> append(const EncodedGroup& group, std::uint64_t points, std::uint64_t runs,
                                            std::uint64_t invalid) = 0;
  [[nodiscard]] virtual Result<void> append(const Gap& gap, std::uint64_t log_time_ns) = 0;
  [[nodiscard]] virtual Result<void> append(FeatureReport& report, std::uint64_t log_time_ns) = 0;
  [[nodiscard]] virtual Result<void> sync() = 0;
  [[nodiscard]] virtual Result<void> finish(std::int64_t ended_ns, double rounding_mm) = 0;
  [[nodiscard]] virtual std::uint64_t bytes() const noexcept = 0;
};

/// Creates the recording at `path`; fails with exists when something is there.
using SinkFactory = std::function<Result<std::unique_ptr<RecordingSink>>(const std::string& path, const RecordingFacts& facts)>;

/// Recording files.
[[nodiscard]] SinkFactory file_sinks();

} // namespace scansion
