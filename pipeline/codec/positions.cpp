// Which points of each run a level adds.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/positions.hpp"

#include <algorithm>
#include <bit>

namespace scansion {
namespace {

// What happens next along a segment. From kMatched on: a vertex that goes on kDrift samples before to kDrift behind the
// candidate.
enum Event : std::uint32_t { kEnd = 0, kNew = 1, kVanished = 2, kMatched = 3 };
constexpr std::uint32_t kEvents = kMatched + 2 * kDrift + 1;

// Contexts of events without a candidate: by the length ahead, apart where the segment has got a vertex already. With one: by
// the last event and by whether the candidate is of this level.
constexpr std::uint32_t kLengths = 8;
constexpr std::uint32_t kWithCandidate = 2 * kLengths;
// Contexts of places: by the length ahead.
constexpr std::uint32_t kPlaces = kWithCandidate + 2 * kEvents;
constexpr std::uint32_t kPlaceContexts = 14;
static_assert(kPlaces + kPlaceContexts <= kMaxContexts);

std::uint32_t log_length(std::int64_t length) noexcept {
  return static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint64_t>(length)));
}
// Of an event without a candidate, with so many points ahead, and of a place among so many.
std::uint32_t free_event_context(std::uint32_t last_event, std::int64_t ahead) noexcept {
  return (last_event == kEnd ? 0 : kLengths) + std::min(kLengths, log_length(ahead)) - 1;
}
std::uint32_t place_context(std::int64_t places) noexcept {
  return kPlaces + std::min(kPlaceContexts, log_length(places)) - 1;
}
// Places are counted from the nearer end of where they may be.
std::int32_t place_of(std::int64_t from_left, std::int64_t places) noexcept {
  const std::int64_t from_right = places - 1 - from_left;
  return static_cast<std::int32_t>(from_left <= from_right ? from_left : -1 - from_right);
}
std::int64_t from_left_of(std::int64_t place, std::int64_t places) noexcept {
  return place >= 0 ? place : places + place;
}

// Vertices that follow nobody.
void take_alone(std::span<const Run> runs, GroupState& state) {
  state.begin_level();
  std::size_t f = 0;
  std::size_t k = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::size_t begin = f;
    state.end_run(runs[r], f, k);
    if (!state.above[r].exists) continue;
    for (std::size_t i = begin; i < f; ++i) state.beside[state.fresh[i].point] = state.above[r].beside(state.fresh[i].point);
  }
}

// The way along the segments between coarser vertices. Both sides see the same candidates: vertices of the line before.
class Walk {
public:
  Walk(std::span<const Run> runs, GroupState& state) noexcept : runs_(runs), s_(state) {}

  void enter_run(std::size_t r) noexcept {
    run_ = &runs_[r];
    above_ = s_.above[r];
    next_ = end_ = 0;
    segment_ = known_;
    if (!above_.exists || run_->count < 3) return;
    const std::size_t begin = s_.run_vertices[above_.run];
    end_ = s_.run_vertices[above_.run + 1] - 1;
    const std::int64_t behind = std::clamp<std::int64_t>(run_->first + above_.shift, above_.first, above_.last);
    const std::span<const PointIndex> inner(s_.vertices.data() + begin, end_ - begin);
    next_ = begin + static_cast<std::size_t>(std::ranges::upper_bound(inner, behind) - inner.begin());
  }
  /// Goes on to the next segment of the run that can have a new vertex; false behind the last.
  bool enter_segment() noexcept {
    const PointIndex last = run_->first + run_->count - 1;
    while (s_.known[segment_] != last) {
      at_ = s_.known[segment_++];
      limit_ = s_.known[segment_];
      if (limit_ - at_ < 2) continue;
      event_ = kEnd;
      find();
      return true;
    }
    return false;
  }
  void leave_run() { s_.end_run(*run_, fresh_, known_); }

  [[nodiscard]] bool can_go_on() const noexcept { return limit_ - at_ >= 2; }
  [[nodiscard]] bool has_candidate() const noexcept { return place_ != 0; }
  [[nodiscard]] std::int64_t place() const noexcept { return place_; }
  [[nodiscard]] std::int64_t at() const noexcept { return at_; }
  [[nodiscard]] std::int64_t limit() const noexcept { return limit_; }
  /// How many points a new vertex that is not the candidate may be.
  [[nodiscard]] std::int64_t length() const noexcept {
    return (has_candidate() ? std::max(at_ + 1, place_ - kDrift) : limit_) - at_ - 1;
  }
  [[nodiscard]] std::uint32_t event_context() const noexcept {
    if (has_candidate()) return kWithCandidate + s_.added[next_] * kEvents + event_;
    return free_event_context(event_, limit_ - at_ - 1);
  }
  /// Goes on behind an event; a new or matched vertex lies at `i`.
  void go(std::uint32_t event, std::int64_t i) {
    event_ = event;
    if (event == kVanished) {
      at_ = std::min(place_ + kDrift, limit_ - 1);
    } else {
      at_ = i;
      const auto point = static_cast<PointIndex>(i);
      const bool matched = event >= kMatched;
      s_.fresh.push_back({point, matched});
      if (above_.exists) s_.beside[point] = matched ? s_.vertices[next_] : above_.beside(point);
    }
    if (event != kNew) ++next_;
    find();
  }

private:
  // The next vertex above whose place lies ahead in the segment, and not beside a coarser vertex, which has taken its part.
  void find() noexcept {
    place_ = 0;
    for (; next_ < end_; ++next_) {
      const std::int64_t place = std::int64_t{s_.vertices[next_]} - above_.shift;
      if (place >= limit_) return;
      if (place <= at_ || place <= std::int64_t{s_.known[segment_ - 1]} + kDrift) continue;
      const PointIndex last = run_->first + run_->count - 1;
      if (limit_ < last && place + kDrift >= limit_) continue;
      place_ = place;
      return;
    }
  }

  std::span<const Run> runs_;
  GroupState& s_;
  const Run* run_ = nullptr;
  RunAbove above_;
  std::int64_t at_ = 0;    // the last point dealt with
  std::int64_t limit_ = 0; // end of the segment
  std::int64_t place_ = 0; // of the candidate; never 0, which is the first point of a run
  std::uint32_t event_ = kEnd;
  std::size_t next_ = 0, end_ = 0; // candidates above
  std::size_t segment_ = 0;        // into known
  std::size_t fresh_ = 0, known_ = 0;
};

} // namespace

void write_alone(std::span<const PointIndex> wanted, const GroupState& state, SymbolWriter& to) {
  // Between the last point of a run and the first of the next lies nothing.
  std::size_t f = 0;
  for (std::size_t k = 1; k < state.known.size(); ++k) {
    const std::int64_t limit = state.known[k];
    std::int64_t at = state.known[k - 1];
    std::uint32_t event = kEnd;
    for (; limit - at >= 2; ++f) {
      const std::int64_t places = limit - at - 1;
      const std::uint32_t context = free_event_context(event, places);
      event = f < wanted.size() && wanted[f] < limit ? kNew : kEnd;
      to.put(unfold(event), context);
      if (event == kEnd) break;
      if (places > 1) to.put(place_of(wanted[f] - at - 1, places), place_context(places));
      at = wanted[f];
    }
  }
}

void take_alone(std::span<const Run> runs, std::span<const PointIndex> wanted, GroupState& state) {
  state.fresh.clear();
  for (const PointIndex i : wanted) state.fresh.push_back({i, false});
  take_alone(runs, state);
}

void write_following(std::span<const Run> runs, std::span<const PointIndex> wanted, GroupState& state, SymbolWriter& to) {
  state.fresh.clear();
  state.begin_level();
  Walk walk(runs, state);
  std::size_t f = 0;
  const auto put = [&](std::uint32_t event, std::int64_t i) {
    to.put(unfold(event), walk.event_context());
    const std::int64_t places = walk.length();
    if (event == kNew && places > 1) to.put(place_of(i - walk.at() - 1, places), place_context(places));
    walk.go(event, i);
  };
  for (std::size_t r = 0; r < runs.size(); ++r) {
    walk.enter_run(r);
    while (walk.enter_segment()) {
      while (walk.can_go_on() && f < wanted.size() && wanted[f] < walk.limit()) {
        const std::int64_t i = wanted[f];
        const std::int64_t drift = i - walk.place();
        if (walk.has_candidate() && drift > kDrift) {
          put(kVanished, 0);
          continue;
        }
        put(walk.has_candidate() && drift >= -kDrift ? static_cast<std::uint32_t>(kMatched + kDrift + drift) : kNew, i);
        ++f;
      }
      if (walk.can_go_on()) to.put(unfold(kEnd), walk.event_context());
    }
    walk.leave_run();
  }
}

namespace {

Result<void> read_alone(std::span<const Run> runs, GroupState& state, std::size_t limit, SymbolReader& from) {
  for (std::size_t k = 1; k < state.known.size(); ++k) {
    const std::int64_t end = state.known[k];
    std::int64_t at = state.known[k - 1];
    std::uint32_t event = kEnd;
    while (end - at >= 2) {
      const std::int64_t places = end - at - 1;
      event = fold(from.next(free_event_context(event, places)));
      if (event == kEnd) break;
      if (event != kNew) return fail(Errc::damaged, "a level tells its points in an impossible way");
      const std::int64_t from_left = places > 1 ? from_left_of(from.next(place_context(places)), places) : 0;
      if (from_left < 0 || from_left >= places || state.fresh.size() == limit)
        return fail(Errc::damaged, "a level names points that its runs do not have");
      at += 1 + from_left;
      state.fresh.push_back({static_cast<PointIndex>(at), false});
    }
  }
  take_alone(runs, state);
  return success();
}

Result<void> read_following(std::span<const Run> runs, GroupState& state, std::size_t limit, SymbolReader& from) {
  state.begin_level();
  Walk walk(runs, state);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    walk.enter_run(r);
    while (walk.enter_segment()) {
      while (walk.can_go_on()) {
        const std::uint32_t event = fold(from.next(walk.event_context()));
        if (event == kEnd) break;
        if (event >= kEvents || (event != kNew && !walk.has_candidate()))
          return fail(Errc::damaged, "a level tells its points in an impossible way");
        std::int64_t i = 0;
        if (event == kNew) {
          const std::int64_t places = walk.length();
          i = walk.at() + 1 + (places > 1 ? from_left_of(from.next(place_context(places)), places) : 0);
        } else if (event >= kMatched) {
          i = walk.place() + event - kMatched - kDrift;
        }
        if (event != kVanished && (i <= walk.at() || i >= walk.limit() || state.fresh.size() == limit))
          return fail(Errc::damaged, "a level names points that its runs do not have");
        walk.go(event, i);
      }
    }
    walk.leave_run();
  }
  return success();
}

} // namespace

Result<void> read_positions(std::span<const Run> runs, bool follow, GroupState& state, std::size_t limit, SymbolReader& from) {
  state.fresh.clear();
  return follow ? read_following(runs, state, limit, from) : read_alone(runs, state, limit, from);
}

} // namespace scansion
