// What happens in the daemon, line by line, for those who listen.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/control/tail.hpp"

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <sys/eventfd.h>
#include <unistd.h>

namespace scansion {
namespace {

constexpr std::array<std::string_view, kTailTopics> kTopics{"lines", "features", "events"};

} // namespace

std::string_view name(TailTopic topic) noexcept {
  return kTopics[static_cast<std::size_t>(topic)];
}

TailHub::Listener::Listener(TailHub& hub, TailTopic topic) : hub_(hub), topic_(topic) {
  const std::lock_guard lock(hub_.mutex_);
  hub_.listeners_.push_back(this);
  ++hub_.counts_[static_cast<std::size_t>(topic)];
}

TailHub::Listener::~Listener() {
  const std::lock_guard lock(hub_.mutex_);
  std::erase(hub_.listeners_, this);
  --hub_.counts_[static_cast<std::size_t>(topic_)];
}

std::string TailHub::Listener::take() {
  const std::lock_guard lock(hub_.mutex_);
  std::string out = std::exchange(kept_, {});
  if (lost_ > 0) out += "{\"lost\":" + std::to_string(std::exchange(lost_, 0)) + "}\n";
  return out;
}

Result<std::unique_ptr<TailHub>> TailHub::make() {
  UniqueFd ready(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!ready) return system_error("cannot make an eventfd", errno);
  return std::unique_ptr<TailHub>(new TailHub(std::move(ready)));
}

void TailHub::publish(TailTopic topic, std::string_view json) {
  {
    const std::lock_guard lock(mutex_);
    for (Listener* listener : listeners_) {
      if (listener->topic_ != topic) continue;
      // Once something is lost, all is until the listener takes what it has: so the count stands in the right place.
      if (listener->lost_ > 0 || listener->kept_.size() + json.size() + 1 > kKept) {
        ++listener->lost_;
        continue;
      }
      listener->kept_.append(json);
      listener->kept_ += '\n';
    }
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(ready_.get(), &one, sizeof one); // full: it is readable anyway
}

void TailHub::clear() noexcept {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(ready_.get(), &count, sizeof count); // nothing there: quiet already
}

std::optional<TailTopic> tail_request(std::string_view request) {
  const auto json = nlohmann::json::parse(request, nullptr, false);
  if (!json.is_object() || json.value("command", nlohmann::json()) != "tail") return std::nullopt;
  const auto topic = json.find("topic");
  if (topic == json.end() || !topic->is_string()) return std::nullopt;
  const auto found = std::ranges::find(kTopics, topic->get_ref<const std::string&>());
  if (found == kTopics.end()) return std::nullopt;
  return static_cast<TailTopic>(found - kTopics.begin());
}

} // namespace scansion
