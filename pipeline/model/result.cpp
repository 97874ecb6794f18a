// Errors as values.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/model/result.hpp"

#include <cerrno>
#include <system_error>

namespace scansion {

Error make_error(Errc code, std::initializer_list<std::string_view> parts) {
  Error error{code, {}};
  for (const std::string_view part : parts) error.context.append(part);
  return error;
}

Error system_error(std::string what, int errno_value) {
  Errc code = Errc::io;
  switch (errno_value) {
    case ENOENT:
    case ENOTDIR: code = Errc::not_found; break;
    case EACCES:
    case EPERM:
    case EROFS: code = Errc::permission; break;
    case EEXIST: code = Errc::exists; break;
    default: break;
  }
  what += ": ";
  what += std::generic_category().message(errno_value);
  return Error{code, std::move(what)};
}

int exit_code(Errc code) noexcept {
  switch (code) {
    case Errc::usage: return 2;
    case Errc::not_found:
    case Errc::undecodable:
    case Errc::out_of_range:
    case Errc::finer:
    case Errc::damaged: return 65;
    case Errc::unavailable:
    case Errc::attention: return 69;
    case Errc::cannot_create:
    case Errc::exists: return 73;
    case Errc::io: return 74;
    case Errc::permission: return 77;
    case Errc::config: return 78;
    case Errc::bug: return 70;
  }
  return 70;
}

const char* explain(Errc code) noexcept {
  switch (code) {
    case Errc::usage: return "the request itself is wrong";
    case Errc::not_found: return "the input does not exist";
    case Errc::undecodable: return "the input is not in the form it claims";
    case Errc::out_of_range: return "a value does not fit the lattice or a limit";
    case Errc::finer: return "a value needs a finer lattice than the one in force";
    case Errc::damaged: return "the recording is damaged";
    case Errc::unavailable: return "the daemon or device is not available";
    case Errc::attention: return "a person must look at the device before it may go on";
    case Errc::cannot_create: return "the output cannot be created";
    case Errc::exists: return "the output exists already";
    case Errc::io: return "reading or writing failed";
    case Errc::permission: return "the operating system refused access";
    case Errc::config: return "the configuration is wrong";
    case Errc::bug: return "an internal rule was broken";
  }
  return "unknown error";
}

} // namespace scansion
