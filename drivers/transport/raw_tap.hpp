// A transport that keeps what goes through it: in the ring, and in a transcript when one is asked for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/transport/descriptor.hpp"
#include "drivers/transport/raw_ring.hpp"

#include <memory>

namespace scansion {

/// Thread-bound like every transport; the ring may be read from elsewhere.
class RawTap final : public Transport {
public:
  /// `transcript`: a file that events are appended to; empty: none. It is held for this transport alone. With the first event
  /// that would make it larger than `bound` it ends for good: what is there can be played, and what is not is counted.
  RawTap(std::unique_ptr<Transport> inner, std::shared_ptr<RawRing> ring, std::string transcript,
         std::uint64_t bound = UINT64_MAX)
      : inner_(std::move(inner)), ring_(std::move(ring)), path_(std::move(transcript)), bound_(bound) {}
  ~RawTap() override { close(); }

  using Transport::write;
  Result<void> open() override;
  Result<Arrival> read(std::span<std::uint8_t> to, std::int64_t deadline_ns) override;
  Result<void> write(std::span<const std::uint8_t> bytes, std::int64_t deadline_ns) override;
  Result<void> change_rate(int baud) override { return inner_->change_rate(baud); }
  void close() noexcept override;
  [[nodiscard]] Moment now() const noexcept override { return inner_->now(); }
  [[nodiscard]] const std::string& name() const noexcept override { return inner_->name(); }
  [[nodiscard]] bool is_live() const noexcept override { return inner_->is_live(); }
  [[nodiscard]] bool is_over() const noexcept override { return inner_->is_over(); }

private:
  Result<void> open_transcript();
  /// Fails with io when the transcript cannot be written: who asks for one wants it whole.
  Result<void> note(RawEvent::Kind kind, const Moment& at, std::span<const std::uint8_t> bytes);
  void note_lost(const Error& error);

  std::unique_ptr<Transport> inner_;
  std::shared_ptr<RawRing> ring_;
  Result<void> put(std::string_view text);

  const std::string path_;
  const std::uint64_t bound_;
  std::uint64_t size_ = 0; ///< of the file
  bool is_full_ = false;
  UniqueFd file_;
  std::string line_; ///< used again
  bool is_open_ = false;
};

} // namespace scansion
