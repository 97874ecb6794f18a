// Recordings from standard input and to standard output; inputs that no output may replace.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/streams.hpp"

#include "pipeline/export/output_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scansion::cli {
namespace {

std::string input_path; // what stands for standard input; empty while nothing was read from it

// The descriptor stays open until the program ends: the file has no other name.
Result<int> spool_standard_input() {
  std::string name = temporary_folder() + "/scansion-XXXXXX";
  const int fd = ::mkostemp(name.data(), O_CLOEXEC);
  if (fd < 0) return boost::outcome_v2::failure(creation_error(name, errno));
  ::unlink(name.c_str());
  std::vector<char> buffer(std::size_t{1} << 20);
  while (true) {
    const ssize_t got = ::read(STDIN_FILENO, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(Errc::io, system_error("cannot read standard input", errno).context);
    if (got == 0) return fd;
    for (ssize_t done = 0; done < got;) {
      const ssize_t put = ::write(fd, buffer.data() + done, static_cast<std::size_t>(got - done));
      if (put < 0 && errno == EINTR) continue;
      if (put < 0) return fail(Errc::io, system_error("cannot write a temporary file in " + temporary_folder(), errno).context);
      done += put;
    }
  }
}

} // namespace

Result<std::string> readable_recording(const std::string& name) {
  if (name != "-") return name;
  if (!input_path.empty()) return fail(Errc::usage, "- stands for standard input once only");
  struct stat info {};
  int fd = STDIN_FILENO;
  if (::fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) {
    SCANSION_TRY(spooled, spool_standard_input());
    fd = spooled;
  }
  input_path = "/proc/self/fd/" + std::to_string(fd);
  return input_path;
}

std::string with_names_of_the_user(std::string message) {
  if (input_path.empty()) return message;
  for (std::size_t at = 0; (at = message.find(input_path, at)) != std::string::npos;)
    message.replace(at, input_path.size(), "standard input");
  return message;
}

Result<void> spares_inputs(const std::string& output, const std::vector<std::string>& inputs) {
  struct stat out {};
  if (output == "-" || ::stat(output.c_str(), &out) != 0 || !S_ISREG(out.st_mode)) return success();
  for (const std::string& input : inputs) {
    struct stat in {};
    const int found = input == "-" ? ::fstat(STDIN_FILENO, &in) : ::stat(input.c_str(), &in);
    if (found == 0 && in.st_dev == out.st_dev && in.st_ino == out.st_ino)
      return fail(Errc::cannot_create, output, " is the input itself and stays as it is; choose another name");
  }
  return success();
}

Result<RecordingOutput> RecordingOutput::create(const std::string& output, bool force) {
  const bool to_stdout = output == "-";
  SCANSION_TRY(pending, PendingFile::create(to_stdout ? temporary_folder() + "/scansion-stdout" : output, force || to_stdout));
  return RecordingOutput(std::move(pending), to_stdout);
}

Result<void> RecordingOutput::commit() {
  return to_stdout_ ? copy_to_stdout(name()) : pending_.commit();
}

Result<void> json_has_room(bool json, const std::string& output) {
  if (!json || output != "-") return success();
  return fail(Errc::usage, "--json prints to standard output, where -o - puts the recording; name a file for the recording");
}

} // namespace scansion::cli
