// What happens in the daemon, line by line, for those who listen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/transport/unique_fd.hpp"
#include "pipeline/model/result.hpp"

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace scansion {

enum class TailTopic : std::uint8_t { lines, features, events };
inline constexpr std::size_t kTailTopics = 3;
[[nodiscard]] std::string_view name(TailTopic topic) noexcept;

/// Takes messages of devices and hands them to listeners. Thread-safe. Nobody waits for a listener: what it has not taken is
/// kept up to a bound, then lost for it and counted.
class TailHub {
public:
  static constexpr std::size_t kKept = 1U << 20U; ///< bytes of each listener

  /// One who listens. Belongs to the thread that serves it; destroyed before the hub.
  class Listener {
  public:
    Listener(TailHub& hub, TailTopic topic);
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    ~Listener();
    /// Messages since the last call, each with its newline; {"lost":N} stands where N are missing.
    [[nodiscard]] std::string take();

  private:
    friend class TailHub;
    TailHub& hub_;
    TailTopic topic_;
    std::string kept_;
    std::uint64_t lost_ = 0;
  };

  [[nodiscard]] static Result<std::unique_ptr<TailHub>> make();
  /// Whether a message of this topic is worth making.
  [[nodiscard]] bool wanted(TailTopic topic) const noexcept { return counts_[static_cast<std::size_t>(topic)] > 0; }
  /// `json` without a newline.
  void publish(TailTopic topic, std::string_view json);
  /// Readable when listeners have something to take; clear() makes it quiet again.
  [[nodiscard]] int ready_fd() const noexcept { return ready_.get(); }
  void clear() noexcept;

private:
  explicit TailHub(UniqueFd ready) : ready_(std::move(ready)) {}

  UniqueFd ready_; ///< eventfd
  std::array<std::atomic<int>, kTailTopics> counts_{};
  std::mutex mutex_; ///< guards listeners_ and all that is in them
  std::vector<Listener*> listeners_;
};

/// The topic of a request {"command":"tail","topic":"lines"}; none: another request, or no such topic.
[[nodiscard]] std::optional<TailTopic> tail_request(std::string_view request);

} // namespace scansion
