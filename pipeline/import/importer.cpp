// Recorded scans to scan lines on a lattice: the two passes.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/import.hpp"
#include "pipeline/import/line_builder.hpp"
#include "pipeline/import/quantizer.hpp"
#include "pipeline/import/sample_stream.hpp"
#include "pipeline/import/survey.hpp"

#include <charconv>
#include <cmath>

namespace scansion {
namespace {

constexpr std::uint64_t kFirstLook = std::uint64_t{4} << 20U; ///< bytes surveyed before streaming starts
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

std::string text_of(const Number& number) {
  std::array<char, 64> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), to_double(number));
  return std::isinf(to_double(number)) ? "a value above 1e308" : std::string(text.data(), written.ptr);
}

Result<void> check_options(const ImportOptions& options) {
  if (options.gap_mm && !(std::isfinite(*options.gap_mm) && *options.gap_mm > 0.0))
    return fail(Errc::usage, "gap: must be a length above zero; leave it out to take every step");
  if (!std::isfinite(options.spacing)) return fail(Errc::usage, "spacing: must be a number; use e.g. 0.5");
  if (const auto* given = std::get_if<ResolutionGiven>(&options.resolution); given != nullptr) {
    Lattice lattice;
    lattice.unit = options.unit;
    SCANSION_TRY(resolution, make_rational(given->input_units.num, given->input_units.den));
    lattice.resolution = resolution;
    SCANSION_TRY(resolution_mm(lattice));
  }
  return success();
}

} // namespace

struct Importer::Impl {
  Impl(ImportOptions opts, MemberList list, std::vector<Column> columns, Notes remarks)
      : options(std::move(opts)), notes(std::move(remarks)), stream(std::move(list), std::move(columns), options, notes) {}

  Result<void> survey(bool whole);
  Result<bool> next(LineBuffer& line);
  Result<void> use(const Lattice& chosen);

  ImportOptions options;
  Notes notes;
  SampleStream stream;
  ThirdColumn third = ThirdColumn::height;
  Lattice lattice;
  Quantizer quantizer;
  LineBuilder builder;
  ImportCounts counts;
  bool complete = false; ///< the survey saw all of the input
  std::optional<Error> failed;

private:
  Result<void> find_third_column(bool whole);
  Result<void> survey_points(bool whole, Survey& survey);
  Result<void> use_exact(const Survey& survey, bool whole);
  Result<bool> holds_only_singles(bool whole);
  void rewind();
  Result<void> add_point(const Sample& sample);
  Error misfit(const Sample& sample, std::size_t axis, bool for_good) const;
  [[nodiscard]] Error too_long(const Sample& sample) const;

  std::span<const Sample> block;
  std::size_t at = 0;
};

/// Three columns without a heading: labels when the third is 0 or 1 throughout, with a 1 somewhere.
Result<void> Importer::Impl::find_third_column(bool whole) {
  const ThirdColumn before = third;
  third = ThirdColumn::height;
  if (!options.columns.empty()) return success();
  stream.restart(ThirdColumn::height);
  bool one = false;
  while (whole || !one || stream.bytes_read() < kFirstLook) {
    const auto samples = stream.next();
    if (!samples) return success(); // the survey of the points explains it
    if (samples.value().empty()) break;
    if (!stream.third_may_be_label()) {
      stream.skip_member();
      continue;
    }
    for (const Sample& sample : samples.value()) {
      if (sample.kind == SampleKind::line_end) continue;
      const Number& value = sample.xyz[2];
      const bool mark = sample.kind == SampleKind::point && is_zero_or_one(value);
      if (!mark) {
        if (before == ThirdColumn::label)
          notes.say(Notes::Subject::no_labels,
                    stream.where(sample.place) + ": third column is more than 0 and 1: it is read as z after all");
        return success();
      }
      one = one || value.mantissa != 0;
    }
  }
  if (!one) return success();
  third = ThirdColumn::label;
  notes.say(Notes::Subject::labels, stream.description() +
                                        ": third column holds only 0 and 1: taken for labels, columns are x,z; "
                                        "name the columns x,y,z to read heights");
  return success();
}

Result<void> Importer::Impl::survey_points(bool whole, Survey& survey) {
  stream.restart(third);
  std::uint64_t invalid = 0;
  while (whole || !survey.any() || stream.bytes_read() < kFirstLook) {
    SCANSION_TRY(samples, stream.next());
    if (samples.empty()) {
      complete = true;
      break;
    }
    for (const Sample& sample : samples) {
      invalid += sample.kind == SampleKind::invalid ? 1 : 0;
      if (sample.kind != SampleKind::point) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (survey.add(sample.xyz[axis], axis) != Survey::Verdict::ok) return misfit(sample, axis, true);
    }
  }
  if (survey.any()) return success();
  if (invalid > 0)
    return fail(Errc::undecodable, stream.description(), ": all ", std::to_string(invalid),
                " samples are invalid; give a scan with at least one point");
  return fail(Errc::undecodable, stream.description(), ": no points; give a scan with at least one point");
}

Result<void> Importer::Impl::survey(bool whole) {
  complete = false;
  SCANSION_TRY(find_third_column(whole));
  Survey survey(options);
  SCANSION_TRY(survey_points(whole, survey));
  SCANSION_TRY(use(survey.choose()));
  if (!lattice.exact || !std::holds_alternative<ResolutionAuto>(options.resolution)) return success();
  return use_exact(survey, whole);
}

/// No decimal lattice holds the values. Text often shows singles, and as such it costs far fewer bits than as doubles.
Result<void> Importer::Impl::use_exact(const Survey& survey, bool whole) {
  bool singles = false;
  if (survey.only_decimals()) {
    SCANSION_TRY(only, holds_only_singles(whole));
    singles = only;
  }
  SCANSION_TRY(use(singles ? survey.exact(Source::float32) : survey.exact()));
  notes.say(Notes::Subject::bits, stream.description() +
                                      ": the decimals do not fit one integer lattice: every bit of the values is "
                                      "kept instead; give a resolution to round them");
  return success();
}

Result<bool> Importer::Impl::holds_only_singles(bool whole) {
  stream.restart(third);
  while (whole || stream.bytes_read() < kFirstLook) {
    SCANSION_TRY(samples, stream.next());
    if (samples.empty()) break;
    for (const Sample& sample : samples) {
      if (sample.kind != SampleKind::point) continue;
      for (const Number& number : sample.xyz)
        if (!as_single(number)) return false;
    }
  }
  return true;
}

Result<void> Importer::Impl::use(const Lattice& chosen) {
  lattice = chosen;
  SCANSION_TRY(mm, resolution_mm(lattice));
  quantizer = Quantizer(lattice, mm.value(), std::holds_alternative<ResolutionGiven>(options.resolution));
  builder = LineBuilder(lattice.exact, options.gap_mm, mm);
  rewind();
  return success();
}

void Importer::Impl::rewind() {
  stream.restart(third);
  block = {};
  at = 0;
  counts = {};
  counts.bytes_total = stream.bytes_total();
  failed.reset();
}

Result<bool> Importer::Impl::next(LineBuffer& line) {
  builder.begin(line);
  for (;;) {
    if (at == block.size()) {
      SCANSION_TRY(samples, stream.next());
      block = samples;
      at = 0;
      counts.bytes_read = stream.bytes_read();
      if (block.empty()) return false;
    }
    const Sample& sample = block[at++];
    switch (sample.kind) {
      case SampleKind::point: {
        SCANSION_TRY(add_point(sample));
      } break;
      case SampleKind::invalid:
        if (builder.add_invalid() != LineBuilder::Added::ok) return too_long(sample);
        ++counts.invalid;
        break;
      case SampleKind::missing: ++counts.missing; break;
      case SampleKind::line_end:
        if (builder.empty()) break;
        builder.finish();
        ++counts.lines;
        counts.points += line.points();
        counts.rounding_mm = quantizer.rounding_mm();
        return true;
    }
  }
}

Result<void> Importer::Impl::add_point(const Sample& sample) {
  std::array<std::int32_t, 3> place{};
  std::array<std::int64_t, 3> ulps{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!quantizer.place(sample.xyz[axis], axis, place[axis], ulps[axis])) return misfit(sample, axis, complete);
  if (builder.add(place, ulps) != LineBuilder::Added::ok) return too_long(sample);
  return success();
}

Error Importer::Impl::misfit(const Sample& sample, std::size_t axis, bool for_good) const {
  const std::string what = stream.where(sample.place) + ": " + kAxes[axis] + " = " + text_of(sample.xyz[axis]);
  if (!(std::fabs(to_double(sample.xyz[axis])) <= max_value(options.unit)))
    return {Errc::out_of_range,
            what + " " + std::string(name(options.unit)) + " is beyond the limit of 1e12 mm; check the value and the unit"};
  if (for_good)
    return {Errc::out_of_range, what + " does not fit 2^32 counts of the resolution; use a coarser resolution, or exact"};
  return {Errc::finer, what + " does not fit the lattice of the values before it; survey the whole input first"};
}

Error Importer::Impl::too_long(const Sample& sample) const {
  return {Errc::out_of_range, stream.where(sample.place) + ": a scan line of more than " + std::to_string(kMaxLinePoints) +
                                  " samples; is a blank line between scan lines missing?"};
}

Importer::Importer(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Importer::Importer(Importer&&) noexcept = default;
Importer& Importer::operator=(Importer&&) noexcept = default;
Importer::~Importer() = default;

Result<Importer> Importer::open(const std::vector<std::string>& inputs, const ImportOptions& options,
                                std::function<void(const std::string&)> note) {
  SCANSION_TRY(check_options(options));
  std::vector<Column> columns;
  if (!options.columns.empty()) {
    SCANSION_TRY(parsed, parse_columns(options.columns));
    columns = std::move(parsed);
  }
  Notes notes(std::move(note));
  SCANSION_TRY(list, list_members(inputs, options.name_for_stdin, notes));
  auto impl = std::make_unique<Impl>(options, std::move(list), std::move(columns), std::move(notes));
  SCANSION_TRY(impl->survey(false));
  return Importer(std::move(impl));
}

const Lattice& Importer::lattice() const noexcept {
  return impl_->lattice;
}

Result<bool> Importer::next(LineBuffer& line) {
  if (impl_->failed) return *impl_->failed;
  auto more = impl_->next(line);
  if (!more) impl_->failed = more.error();
  return more;
}

Result<void> Importer::survey_all() {
  return impl_->survey(true);
}

const ImportCounts& Importer::counts() const noexcept {
  return impl_->counts;
}

} // namespace scansion
