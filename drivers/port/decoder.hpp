// What a decoder is: bytes in, scan lines and gaps out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/link_counters.hpp"
#include "drivers/transport/transport.hpp"
#include "pipeline/model/scan_line.hpp"

namespace scansion {

enum class Decoded : std::uint8_t {
  more,  ///< all bytes are used, nothing is complete
  line,  ///< `line` was filled
  gap,   ///< `gap.count` and `gap.reason` were filled: lines are missing before what comes next
  reply, ///< something that is no line: an answer, a status; the driver asks the decoder what it was
  end    ///< the device says that it is done and sends nothing more
};

/// Pure and incremental: no input or output, no clock, no thread, no log. The same bytes give the same results however they are
/// cut into pieces; of the times only the stamps, and the way that went by during a loss, may depend on `at`. Any bytes may
/// come in: what is not understood is counted once in LinkCounters, by cause, and skipped to the next place where a frame may
/// begin. Memory has a bound that the decoder's header states; the steady state allocates nothing.
class Decoder {
public:
  Decoder() = default;
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  virtual ~Decoder() = default;

  struct Step {
    Decoded what = Decoded::more;
    std::size_t used = 0; ///< bytes of this call that are done with; may be 0 when something was still to be handed out
  };
  /// Goes through `bytes`, which came at `at`, up to the first result. `line` and `gap` come in cleared.
  [[nodiscard]] virtual Step decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) = 0;
  /// Forgets half a frame: the connection is new.
  virtual void reset() = 0;
  /// How many lines are missing between the last one before reset() and the first after it; empty: the device does not tell.
  /// Asked when the latter was handed out.
  [[nodiscard]] virtual std::optional<std::uint64_t> lost_while_away() const noexcept { return std::nullopt; }
  /// The source came to its end, or (`is_lost`) broke off, at `now`: a line whose end only a later byte would tell is over.
  virtual void finish(const Moment& /*now*/, bool /*is_lost*/) {}
};

} // namespace scansion
