// The rows of a raster that are done.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/rows.hpp"

#include <cmath>
#include <utility>

namespace scansion::grbl {

Lattice report_lattice(bool inches) noexcept {
  Lattice out;
  out.resolution = inches ? Rational{1, 10'000} : Rational{1, 1000};
  out.unit = inches ? Unit::in : Unit::mm;
  return out;
}

void DoneRows::clear() noexcept {
  contacts_.clear();
  stamps_.clear();
}

Result<void> DoneRows::put(const Row& row, bool inches, const Stamps& stamps) {
  if (is_empty()) inches_ = inches;
  if (inches != inches_) {
    return fail(Errc::attention, "the controller now reports in ", inches ? "inches" : "mm", ", the raster began in ",
                inches_ ? "inches" : "mm", "; set $13 as it was");
  }
  const Ticks ticks_per_count = inches ? 1 : 10;
  const std::size_t before = contacts_.size();
  for (const auto& point : row.points) {
    Contact contact;
    contact.is_hole = !point;
    for (std::size_t axis = 0; point && axis < contact.at.size(); ++axis) {
      const Ticks ticks = (*point)[axis];
      if (ticks % ticks_per_count != 0) {
        contacts_.resize(before);
        return fail(Errc::out_of_range, "a contact was reported with more than three decimals of a mm");
      }
      contact.at[axis] = static_cast<std::int32_t>(ticks / ticks_per_count); // kFarthest fits
    }
    contacts_.push_back(contact);
  }
  stamps_.push_back(stamps);
  return success();
}

double DoneRows::um(std::int32_t count) const noexcept {
  constexpr double kInch = 2.54;
  return inches_ ? count * kInch : count;
}

Result<void> DoneRows::take_line(const LineBuffer& line, const std::array<std::int64_t, 3>& origin) {
  const std::uint32_t row = count();
  const std::uint32_t columns = raster_->columns();
  std::vector<Contact> contacts(columns);
  std::uint64_t column = 0;
  const Um away_x = std::max<Um>(1, (columns > 1 ? raster_->x(1) - raster_->x(0) : 1000) / 2);
  const Um away_y = std::max<Um>(1, (raster_->rows() > 1 ? raster_->y(1) - raster_->y(0) : 1000) / 2);
  for (const Run& run : line.runs) {
    column += run.invalid_before;
    for (std::uint32_t i = 0; i < run.count; ++i, ++column) {
      if (column >= columns) return fail(Errc::config, "row ", std::to_string(row), " has more points than the raster");
      Contact& contact = contacts[column];
      contact.is_hole = false;
      for (std::size_t axis = 0; axis < contact.at.size(); ++axis) {
        const std::int64_t total = origin[axis] + line.xyz[axis][run.first + i];
        if (total > kFarthest || total < -kFarthest)
          return fail(Errc::config, "row ", std::to_string(row), " lies too far away");
        contact.at[axis] = static_cast<std::int32_t>(total);
      }
      const double dx = um(contact.at[0]) - static_cast<double>(raster_->x(static_cast<std::uint32_t>(column)));
      const double dy = um(contact.at[1]) - static_cast<double>(raster_->y(row));
      if (std::abs(dx) > static_cast<double>(away_x) || std::abs(dy) > static_cast<double>(away_y)) {
        return fail(Errc::config, "row ", std::to_string(row), " lies in another place than the raster's");
      }
    }
  }
  if (column + line.invalid_after != columns) {
    return fail(Errc::config, "row ", std::to_string(row), " has another number of points than the raster");
  }
  contacts_.insert(contacts_.end(), contacts.begin(), contacts.end());
  stamps_.push_back(line.stamps);
  return success();
}

Result<void> DoneRows::take_over(const Lattice& lattice, const std::vector<LineBuffer>& lines) {
  clear();
  Lattice here = lattice;
  here.origin = {};
  const bool inches = here == report_lattice(true);
  if (!inches && !(here == report_lattice(false))) return fail(Errc::config, "it was not recorded by a touch probe");
  if (lines.size() > raster_->rows()) return fail(Errc::config, "it has more rows than the raster");
  inches_ = inches;
  for (const LineBuffer& line : lines) {
    if (auto taken = take_line(line, lattice.origin); !taken) {
      clear();
      return taken;
    }
  }
  return success();
}

void DoneRows::fill(std::uint32_t row, LineBuffer& line) const {
  const std::size_t columns = raster_->columns();
  const Contact* contacts = contacts_.data() + row * columns;
  line.clear();
  line.stamps = stamps_[row];
  std::uint32_t holes = 0;
  bool is_planar = true;
  for (std::size_t column = 0; column < columns; ++column) {
    const Contact& contact = contacts[column];
    if (contact.is_hole) {
      ++holes;
      continue;
    }
    const auto at = static_cast<std::uint32_t>(line.points());
    if (at > 0) is_planar &= contact.at[1] == line.xyz[1].front();
    if (line.runs.empty() || holes > 0) line.runs.push_back({at, 0, std::exchange(holes, 0U)});
    ++line.runs.back().count;
    for (std::size_t axis = 0; axis < contact.at.size(); ++axis) line.xyz[axis].push_back(contact.at[axis]);
  }
  line.invalid_after = holes;
  constexpr double kUm = 1e-3;
  if (is_planar && line.points() > 0) line.plane = {0.0, 1.0, -um(line.xyz[1].front()) * kUm};
}

void DoneRows::put_heights(HeightMap& heights) const {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (contacts_[i].is_hole) continue;
    heights.put(static_cast<std::uint32_t>(i / raster_->columns()), static_cast<std::uint32_t>(i % raster_->columns()),
                std::llround(um(contacts_[i].at[2])));
  }
}

} // namespace scansion::grbl
