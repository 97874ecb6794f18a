// Errors as values: what went wrong, sorted by what the caller does next.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/outcome/basic_result.hpp>
#include <boost/outcome/policy/terminate.hpp>
#include <boost/outcome/try.hpp>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace scansion {

/// Kinds of error. Each maps to one exit code (see exit_code) and is explained by one sentence (see explain).
enum class Errc : std::uint8_t {
  usage,         ///< the caller asked for something that cannot be asked
  not_found,     ///< the named input does not exist
  undecodable,   ///< the input is not what it claims to be
  out_of_range,  ///< a value does not fit the lattice or a stated limit
  finer,         ///< a value needs a finer lattice than the one in force: survey the whole input, then start again
  damaged,       ///< a recording's checksum or structure is wrong
  unavailable,   ///< the daemon or the device is not there
  attention,     ///< a person must look at the device before it may go on
  cannot_create, ///< an output cannot be created
  exists,        ///< the output exists and may not be overwritten
  io,            ///< reading or writing failed; includes a full disk
  permission,    ///< the operating system says no
  config,        ///< the configuration is wrong
  bug            ///< cannot happen; please report
};

struct [[nodiscard]] Error {
  Errc code = Errc::bug;
  std::string context; ///< for a person: file, line, reason and fix; no trailing full stop or newline

  friend bool operator==(const Error&, const Error&) = default;
};

/// A value or an Error. Using the wrong side terminates: check first, or use BOOST_OUTCOME_TRY.
template <class T>
using Result = boost::outcome_v2::basic_result<T, Error, boost::outcome_v2::policy::terminate>;

inline auto success() noexcept {
  return boost::outcome_v2::success();
}

/// An Error whose context is the parts joined. Out of line: GCC 12 reports inlined moves of known short strings as overruns.
[[nodiscard]] Error make_error(Errc code, std::initializer_list<std::string_view> parts);

template <class... Parts>
[[nodiscard]] auto fail(Errc code, const Parts&... parts) {
  return boost::outcome_v2::failure(make_error(code, {std::string_view(parts)...}));
}

/// An Error of the operating system: `what` and the text of `errno_value`; the code follows the number.
[[nodiscard]] Error system_error(std::string what, int errno_value);

/// Process exit code: 65 undecodable, 69 unavailable and attention, 73 cannot create, 74 I/O, 77 permission, 78 configuration,
/// 2 usage.
[[nodiscard]] int exit_code(Errc code) noexcept;

/// One sentence that says what this kind of error means.
[[nodiscard]] const char* explain(Errc code) noexcept;

} // namespace scansion

/// SCANSION_TRY(expr) or SCANSION_TRY(name, expr): returns the error, or declares `auto&& name` with the value.
#define SCANSION_TRY(...) BOOST_OUTCOME_TRY(__VA_ARGS__)
