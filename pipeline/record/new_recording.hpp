// A recording that gets its name only when it is complete.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/appender.hpp"

namespace scansion {

/// Written under a temporary name beside `path`, removed again unless commit() succeeds.
class NewRecording {
public:
  /// Fails with exists when `path` is there.
  [[nodiscard]] static Result<NewRecording> create(const std::string& path, const RecordingFacts& facts);
  NewRecording(NewRecording&&) noexcept = default;
  NewRecording& operator=(NewRecording&&) = delete;
  ~NewRecording();

  [[nodiscard]] Appender& appender() noexcept { return appender_; }
  [[nodiscard]] const std::string& temporary() const noexcept { return temporary_; }
  /// Renames the finished file and makes the name durable. Fails with exists when `path` came into being meanwhile.
  [[nodiscard]] Result<void> commit();

private:
  NewRecording(std::string path, std::string temporary, Appender appender)
      : path_(std::move(path)), temporary_(std::move(temporary)), appender_(std::move(appender)) {}
  std::string path_;
  std::string temporary_; ///< empty once moved from or renamed
  Appender appender_;
};

} // namespace scansion
