// Messages about feature lines and patches: no text may do harm, and what is understood says the same when it is written again.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/findings.hpp"
#include "pipeline/record/notes.hpp"

#include <cstdlib>

using namespace scansion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  FeatureReport report;
  const bool lines = parse_features_message(text, report).has_value();
  if (!lines) report = {};
  const bool patches = !lines && parse_patches_message(text, report).has_value();
  if (!lines && !patches) return 0;
  FeatureReport again;
  for (const std::string& message : lines ? features_messages(report) : patches_messages(report)) {
    if (!(lines ? parse_features_message(message, again) : parse_patches_message(message, again))) std::abort();
  }
  if (again.lines.size() != report.lines.size() || again.runs != report.runs || again.merges != report.merges) std::abort();
  for (std::size_t k = 0; k < report.lines.size(); ++k)
    if (again.lines[k].vertices != report.lines[k].vertices || again.lines[k].piece != report.lines[k].piece) std::abort();
  (void)assemble(std::move(report));
  return 0;
}
