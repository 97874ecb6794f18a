// The decoder of Gocator profiles: messages to lines.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/lmi-gocator/decoder.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

using gdp::get;

namespace {

constexpr std::int64_t kNmPerUm = 1000;
constexpr double kNmPerMm = 1e6;
/// No profiler makes more than a frame in this time. A frame index that rises faster than this is not believed.
constexpr std::uint64_t kShortestFrameUs = 10;

/// Whether `later` can be a frame of the same count after `earlier`.
bool follows(const gdp::Stamp& earlier, const gdp::Stamp& later) noexcept {
  if (later.frame <= earlier.frame) return false;
  const std::uint64_t frames = later.frame - earlier.frame;
  if (frames == 1) return true;
  return later.time_us > earlier.time_us && frames <= (later.time_us - earlier.time_us) / kShortestFrameUs + 1;
}

std::int64_t rounded(std::int64_t value, std::int64_t step) noexcept {
  const std::int64_t half = step / 2;
  const std::int64_t off = value >= 0 ? value + half : value - half;
  return off / step;
}

} // namespace

void GocatorDecoder::reset() {
  message_.clear();
  size_ = skip_ = 0;
  is_searching_ = false;
  stamps_.clear();
  group_is_doubtful_ = group_has_profile_ = group_ended_ = has_profile_ = false;
  source_.reset();
  camera_.reset();
  stranger_.reset();
  doubtful_scales_ = {};
  waits_ = false;
  row_ = rows_ = 0;
  is_refusing_ = false;
  refusal_.clear();
  if (last_) away_ = std::exchange(last_, std::nullopt);
  before_leap_.reset();
  doubtful_.reset();
  counts_anew_ = false;
  lost_while_away_.reset();
}

void GocatorDecoder::refuse(std::string why) {
  refusal_ = std::move(why);
  is_refusing_ = true;
}

void GocatorDecoder::drop_message() noexcept {
  message_.clear();
  size_ = 0;
  rows_ = 0;
}

/// Stamps belong to the messages of their group only.
void GocatorDecoder::begin_message() {
  if (group_ended_) {
    stamps_.clear();
    group_is_doubtful_ = group_has_profile_ = false;
    ++group_;
  }
  group_ended_ = (get<std::uint16_t>(&message_[4]) & gdp::kLastOfGroup) != 0;
}

void GocatorDecoder::note_other(gdp::Type type) {
  if (has_profile_) return;
  if (type == gdp::Type::uniform_surface || type == gdp::Type::surface_point_cloud) {
    refuse("the sensor sends surfaces; set its scan mode to Profile");
  } else if (type == gdp::Type::range) {
    refuse("the sensor sends single ranges; set its scan mode to Profile");
  }
}

void GocatorDecoder::take_stamps() {
  const auto count = get<std::uint32_t>(&message_[6]);
  const auto bytes = get<std::uint16_t>(&message_[10]);
  stamps_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint8_t* at = &message_[gdp::kStampHead + std::size_t{i} * bytes];
    stamps_.push_back({get<std::uint64_t>(at), get<std::uint64_t>(at + 8), get<std::int64_t>(at + 16)});
  }
  group_has_profile_ = false;
  group_is_doubtful_ = compare(stamps_.front()) == Frames::doubtful;
  if (group_is_doubtful_)
    counters_.reject(Reject::value);
  else
    counters_.accept();
}

GocatorDecoder::Frames GocatorDecoder::compare(const gdp::Stamp& stamp) {
  const bool is_proven = doubtful_ && follows(*doubtful_, stamp);
  doubtful_.reset();
  if (!last_ || follows(*last_, stamp)) return Frames::follow;
  // The leap before was a wrong bit: what comes now follows the frame before it.
  if (before_leap_ && follows(*before_leap_, stamp)) {
    last_ = std::exchange(before_leap_, std::nullopt);
    return Frames::follow;
  }
  // The count begins with 0 whenever the sensor is started. Any other step back is believed when a second frame goes on from
  // there: the first may be a repeated message or a wrong bit.
  if (stamp.frame == 0 && stamp != *last_) {
    counts_anew_ = true;
    return Frames::anew;
  }
  if (is_proven) {
    counts_anew_ = true;
    return Frames::anew;
  }
  if (stamp.frame != last_->frame) doubtful_ = stamp;
  return Frames::doubtful;
}

/// One profile of another source or camera may be a wrong bit; the same again in the next group is none.
bool GocatorDecoder::is_stranger_again() noexcept {
  const Stranger now{profile_.source, profile_.camera, group_};
  if (!stranger_ || group_ > stranger_->group + 1) {
    stranger_ = now;
    return false;
  }
  if (group_ == stranger_->group) return false;
  return std::exchange(*stranger_, now).is_like(now);
}

/// Whether it is the one profile of each frame that is wanted.
bool GocatorDecoder::is_ours() {
  if (profile_.step == gdp::kToolStep) return false;
  if (choice_.source && *choice_.source != profile_.source) return false;
  if (choice_.camera && *choice_.camera != profile_.camera) return false;
  if (!source_) source_ = profile_.source;
  if (!camera_) camera_ = profile_.camera;
  if (*source_ == profile_.source && *camera_ == profile_.camera) return true;
  if (!is_stranger_again()) return false;
  if (*source_ != profile_.source) {
    refuse("the sensor sends profiles of several sources; choose one with source = \"top\" or another");
  } else {
    refuse("the sensor sends profiles of several cameras; choose one with camera = 0 or 1");
  }
  return false;
}

/// Scales and offsets.
std::array<std::int64_t, 4> GocatorDecoder::scales_nm() const noexcept {
  return {profile_.x_nm, profile_.z_nm, profile_.x_um * kNmPerUm, profile_.z_um * kNmPerUm};
}

bool GocatorDecoder::is_on_lattice() const noexcept {
  const auto nm = scales_nm();
  return std::all_of(nm.begin(), nm.end(), [this](std::int64_t value) { return value % count_nm_ == 0; });
}

std::optional<Reject> GocatorDecoder::check_profile() {
  if (profile_.x_nm == 0 || profile_.z_nm == 0 || group_is_doubtful_) return Reject::value;
  if (group_has_profile_) return Reject::count;
  if (!stamps_.empty() && stamps_.size() != profile_.count) return Reject::count;
  if (count_nm_ == 0 || rounds_ || is_on_lattice()) return std::nullopt;
  // The job was changed, or a bit is wrong: the next profile tells.
  if (std::exchange(doubtful_scales_, scales_nm()) == scales_nm()) return std::nullopt;
  return Reject::value;
}

void GocatorDecoder::take_profile() {
  const std::uint8_t* at = message_.data();
  profile_.x_nm = get<std::uint32_t>(at + 16);
  profile_.z_nm = get<std::uint32_t>(at + 20);
  profile_.x_um = get<std::int32_t>(at + 24);
  profile_.z_um = get<std::int32_t>(at + 28);
  profile_.source = at[32];
  profile_.camera = profile_.type == gdp::Type::point_cloud_profile ? at[37] : std::uint8_t{0};
  profile_.step = profile_.samples_at >= gdp::kAttributes + gdp::kOldAttributes + 8 ? get<std::int32_t>(at + 40) : 0;
  has_profile_ = true;
  if (!is_ours()) {
    counters_.accept();
    return;
  }
  if (const auto cause = check_profile()) {
    counters_.reject(*cause);
    return;
  }
  counters_.accept();
  group_has_profile_ = true;
  row_ = 0;
  rows_ = profile_.count;
  gap_is_told_ = false;
  waits_ = count_nm_ == 0;
}

/// Whether the profile lies on the lattice; refuses it when not.
bool GocatorDecoder::fits() {
  const auto nm = scales_nm();
  is_exact_ = is_on_lattice();
  if (!is_exact_ && !rounds_) {
    refuse("the sensor's scales have changed; its recording goes on in a new file");
    return false;
  }
  const std::int64_t first = profile_.type == gdp::Type::uniform_profile ? 0 : -32768;
  const std::int64_t last = profile_.type == gdp::Type::uniform_profile ? std::int64_t{profile_.width} : 32767;
  const auto is_inside = [&](std::int64_t offset_nm, std::int64_t scale_nm, std::int64_t from, std::int64_t to) {
    return (offset_nm + from * scale_nm) / count_nm_ > INT32_MIN && (offset_nm + to * scale_nm) / count_nm_ < INT32_MAX &&
           (to - from) * scale_nm / count_nm_ < kLongestRun;
  };
  if (is_inside(nm[2], nm[0], first, last) && is_inside(nm[3], nm[1], -32768, 32767)) return true;
  refuse("the sensor's field is too wide for so fine a resolution; set resolution to a coarser one, such as 0.001");
  return false;
}

std::int64_t GocatorDecoder::counts(std::int64_t nm) noexcept {
  const std::int64_t count = rounded(nm, count_nm_);
  rounding_nm_ = std::max(rounding_nm_, std::abs(nm - count * count_nm_));
  return count;
}

std::int64_t GocatorDecoder::way_counts(const gdp::Stamp& stamp) noexcept {
  const double mm = way_.at({stamp.frame, static_cast<std::int64_t>(stamp.time_us * 1000U), stamp.encoder});
  const double at = mm * kNmPerMm / static_cast<double>(count_nm_);
  if (!(std::abs(at) < 2147483646.0)) return INT64_MAX;
  return std::llround(at);
}

void GocatorDecoder::convert(std::uint32_t row, std::int32_t y, LineBuffer& line) {
  const std::size_t step = profile_.sample_bytes();
  const std::uint8_t* at = message_.data() + profile_.samples_at + std::size_t{row} * profile_.width * step;
  const bool is_even = profile_.type == gdp::Type::uniform_profile;
  const std::int64_t unit = is_exact_ ? count_nm_ : 1;
  const std::int64_t x0 = std::int64_t{profile_.x_um} * kNmPerUm / unit;
  const std::int64_t z0 = std::int64_t{profile_.z_um} * kNmPerUm / unit;
  const std::int64_t dx = profile_.x_nm / unit;
  const std::int64_t dz = profile_.z_nm / unit;
  const auto on_lattice = [&](std::int64_t value) { return static_cast<std::int32_t>(is_exact_ ? value : counts(value)); };
  std::uint32_t invalid = 0;
  bool is_in_run = false;
  for (std::uint32_t i = 0; i < profile_.width; ++i, at += step) {
    const std::int64_t x = is_even ? std::int64_t{i} : get<std::int16_t>(at);
    const std::int64_t z = get<std::int16_t>(at + step - 2);
    if (z == gdp::kNull || x == gdp::kNull) {
      ++invalid;
      is_in_run = false;
      continue;
    }
    if (!is_in_run) line.runs.push_back({static_cast<std::uint32_t>(line.points()), 0, std::exchange(invalid, 0U)});
    is_in_run = true;
    ++line.runs.back().count;
    line.xyz[0].push_back(on_lattice(x0 + x * dx));
    line.xyz[1].push_back(y);
    line.xyz[2].push_back(on_lattice(z0 + z * dz));
  }
  line.invalid_after = invalid;
}

bool GocatorDecoder::find_gap(const gdp::Stamp& stamp, const Moment& at, Gap& gap) {
  if (std::exchange(gap_is_told_, true)) return false;
  const std::int64_t waited_ns = at.monotonic_ns - line_at_.monotonic_ns;
  if (std::exchange(counts_anew_, false)) {
    way_.go_on(1, waited_ns);
    if (stamp.frame == 0) return false; // a fresh start follows the end of the run before
    gap.reason = "the sensor counts its frames anew";
    return true;
  }
  if (!last_) {
    if (away_ && follows(*away_, stamp))
      lost_while_away_ = stamp.frame - away_->frame - 1;
    else if (away_)
      way_.go_on(1, waited_ns);
    away_.reset();
    return false;
  }
  if (stamp.frame == last_->frame + 1) return false;
  gap.count = stamp.frame - last_->frame - 1;
  gap.reason = "frames are missing";
  return true;
}

std::optional<Decoded> GocatorDecoder::hand_out(const Moment& at, LineBuffer& line, Gap& gap) {
  if (is_refusing_) {
    is_refusing_ = false;
    drop_message();
    return Decoded::reply;
  }
  if (rows_ == 0) return std::nullopt;
  if (waits_) {
    if (count_nm_ == 0) return Decoded::reply;
    waits_ = false;
  }
  if (row_ == 0 && !fits()) return hand_out(at, line, gap);
  gdp::Stamp stamp{lines_, 0, 0};
  if (!stamps_.empty()) {
    stamp = stamps_[row_];
    if (row_ > 0 && !follows(*last_, stamp)) stamp = {last_->frame + 1, last_->time_us, last_->encoder}; // within one message
    if (find_gap(stamp, at, gap)) return Decoded::gap;
  }
  const std::int64_t y = way_counts(stamp);
  if (y == INT64_MAX) {
    way_.begin_anew();
    refuse("the line's place along the way fits no lattice of this resolution; the way begins anew");
    return hand_out(at, line, gap);
  }
  convert(row_, static_cast<std::int32_t>(y), line);
  ++lines_;
  line_at_ = at;
  if (!stamps_.empty()) {
    before_leap_ = last_ && stamp.frame > last_->frame + 1 ? last_ : std::nullopt;
    last_ = stamp;
    line.stamps.encoder = stamp.encoder;
    if (stamp.time_us < static_cast<std::uint64_t>(INT64_MAX / 1000))
      line.stamps.device_ns = static_cast<std::int64_t>(stamp.time_us) * 1000;
  }
  gap_is_told_ = false;
  if (++row_ == rows_) drop_message();
  return Decoded::line;
}

Decoder::Step GocatorDecoder::decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) {
  Step step;
  for (;;) {
    if (const auto what = hand_out(at, line, gap)) {
      step.what = *what;
      return step;
    }
    if (!assemble(bytes, step.used)) return step;
    begin_message();
    if ((get<std::uint16_t>(&message_[4]) & ~gdp::kLastOfGroup) == static_cast<std::uint16_t>(gdp::Type::stamp))
      take_stamps();
    else
      take_profile();
    if (rows_ == 0) drop_message();
  }
}

} // namespace scansion
