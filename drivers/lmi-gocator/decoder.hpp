// The decoder of Gocator profiles; README.md draws their bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/lmi-gocator/gdp.hpp"
#include "drivers/port/decoder.hpp"
#include "drivers/port/way.hpp"

#include <array>

namespace scansion {

/// Which of several profiles of a frame is the scan line. Empty: there is only one, another one is refused.
struct GocatorChoice {
  std::optional<std::uint8_t> source, camera;
};

/// Memory: one profile message of at most kMaxMessage bytes, its stamps and one line. Other messages are passed over.
class GocatorDecoder final : public Decoder {
public:
  static constexpr std::uint32_t kMaxWidth = 1U << 16U;
  static constexpr std::uint32_t kMaxProfiles = 1024;          ///< in one message
  static constexpr std::size_t kMaxMessage = 4U << 20U;        ///< of stamps or profiles
  static constexpr std::size_t kMaxOther = 64U << 20U;         ///< of anything else; surfaces are long
  static constexpr std::int64_t kLongestRun = (1LL << 30) - 1; ///< counts

  GocatorDecoder(LinkCounters& counters, GocatorChoice choice, LineSpacing spacing)
      : counters_(counters), choice_(choice), way_(spacing) {}

  /// A reply is one of two things: with refusal() the sensor sends what is no scan line here; else the first profile is there
  /// and waits for set_count_nm(), which profile() tells how to choose.
  Step decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) override;
  void reset() override;

  /// nm in a count of the lattice. `rounds`: values off the lattice go to the nearest count; else a profile with such values
  /// is refused.
  void set_count_nm(std::int64_t count_nm, bool rounds) noexcept {
    count_nm_ = count_nm;
    rounds_ = rounds;
  }
  [[nodiscard]] const gdp::Profile& profile() const noexcept { return profile_; }
  [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }
  std::optional<std::uint64_t> lost_while_away() const noexcept override { return lost_while_away_; }
  [[nodiscard]] std::int64_t rounding_nm() const noexcept { return rounding_nm_; }

private:
  enum class Head : std::uint8_t { short_of, whole, other, wrong };
  enum class Frames : std::uint8_t { follow, anew, doubtful };

  [[nodiscard]] bool pass_over(std::span<const std::uint8_t> bytes, std::size_t& used);
  [[nodiscard]] bool assemble(std::span<const std::uint8_t> bytes, std::size_t& used);
  [[nodiscard]] Head judge();
  [[nodiscard]] Head judge_stamp(std::size_t size);
  [[nodiscard]] Head judge_profile(gdp::Type type, std::size_t size);
  void drop_first_byte();
  void note_other(gdp::Type type);
  void take_stamps();
  void take_profile();
  [[nodiscard]] std::optional<Reject> check_profile();
  [[nodiscard]] std::array<std::int64_t, 4> scales_nm() const noexcept;
  [[nodiscard]] bool is_on_lattice() const noexcept;
  [[nodiscard]] bool is_ours();
  [[nodiscard]] bool is_stranger_again() noexcept;
  void begin_message();
  void drop_message() noexcept;
  [[nodiscard]] bool fits();
  [[nodiscard]] Frames compare(const gdp::Stamp& stamp);
  [[nodiscard]] std::optional<Decoded> hand_out(const Moment& at, LineBuffer& line, Gap& gap);
  [[nodiscard]] bool find_gap(const gdp::Stamp& stamp, const Moment& at, Gap& gap);
  [[nodiscard]] std::int64_t counts(std::int64_t nm) noexcept;
  [[nodiscard]] std::int64_t way_counts(const gdp::Stamp& stamp) noexcept;
  void convert(std::uint32_t row, std::int32_t y, LineBuffer& line);
  void refuse(std::string why);

  LinkCounters& counters_;
  const GocatorChoice choice_;
  std::int64_t count_nm_ = 0; ///< 0: not known yet
  bool rounds_ = false;
  bool is_exact_ = false; ///< profile_ lies on the lattice
  std::int64_t rounding_nm_ = 0;

  std::vector<std::uint8_t> message_; ///< as far as it has come
  std::size_t size_ = 0;              ///< of the message, once its head is good
  std::size_t skip_ = 0;              ///< bytes left of another message
  bool is_searching_ = false;         ///< for the next stamp, after something that was no message

  std::vector<gdp::Stamp> stamps_; ///< of this group
  bool group_is_doubtful_ = false; ///< its frame index cannot be
  bool group_has_profile_ = false;
  bool group_ended_ = false; ///< with the message before
  bool has_profile_ = false; ///< since reset()
  std::optional<std::uint8_t> source_, camera_;
  struct Stranger {
    std::uint8_t source = 0, camera = 0;
    std::uint64_t group = 0;
    [[nodiscard]] bool is_like(const Stranger& other) const noexcept {
      return source == other.source && camera == other.camera;
    }
  };
  std::uint64_t group_ = 0;
  std::optional<Stranger> stranger_;              ///< the newest group's first profile of another source or camera
  std::array<std::int64_t, 4> doubtful_scales_{}; ///< off the lattice; a second profile may prove them right
  gdp::Profile profile_;
  bool waits_ = false;     ///< profile_ waits for the lattice
  std::uint32_t row_ = 0;  ///< next of profile_ to hand out
  std::uint32_t rows_ = 0; ///< 0: none
  bool gap_is_told_ = false;
  std::string refusal_;
  bool is_refusing_ = false;

  std::optional<gdp::Stamp> last_;        ///< of the newest line
  std::optional<gdp::Stamp> away_;        ///< the same before reset()
  std::optional<gdp::Stamp> before_leap_; ///< the line before last_, when frames are missing between them
  std::optional<gdp::Stamp> doubtful_;    ///< refused; the next one may prove it right
  Way way_;
  Moment line_at_;          ///< when the newest line came
  std::uint64_t lines_ = 0; ///< when there are no stamps
  bool counts_anew_ = false;
  std::optional<std::uint64_t> lost_while_away_;
};

} // namespace scansion
