// Recordings from standard input and to standard output; inputs that no output may replace.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "pipeline/record/pending_file.hpp"

#include <string>
#include <vector>

namespace scansion::cli {

/// The path under which a recording of the command line can be read: itself, or for "-" standard input, which goes to an
/// unlinked temporary file first when it is a pipe, since recordings are read from their end. Once in a program.
[[nodiscard]] Result<std::string> readable_recording(const std::string& name);

/// "standard input" where a message names the path that readable_recording() made up.
[[nodiscard]] std::string with_names_of_the_user(std::string message);

/// Fails when `output` is one of the inputs, under whatever name: not even --force may replace what is read.
[[nodiscard]] Result<void> spares_inputs(const std::string& output, const std::vector<std::string>& inputs);

/// A recording that appears whole or not at all, under its name or, for "-", on standard output.
class RecordingOutput {
public:
  [[nodiscard]] static Result<RecordingOutput> create(const std::string& output, bool force);
  [[nodiscard]] const std::string& name() const noexcept { return pending_.name(); } ///< to write to; does not exist yet
  [[nodiscard]] bool to_stdout() const noexcept { return to_stdout_; }
  [[nodiscard]] Result<void> commit();

private:
  RecordingOutput(PendingFile pending, bool to_stdout) : pending_(std::move(pending)), to_stdout_(to_stdout) {}
  PendingFile pending_;
  bool to_stdout_;
};

/// Standard output cannot take a recording and figures in JSON as well.
[[nodiscard]] Result<void> json_has_room(bool json, const std::string& output);

} // namespace scansion::cli
