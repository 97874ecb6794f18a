// PLY files: range grids, and point lists with a line number.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/ply_reader.hpp"

#include "pipeline/import/paged_table.hpp"
#include "pipeline/import/ply_element.hpp"

#include <algorithm>
#include <optional>

namespace scansion {
namespace {

constexpr std::uint8_t kLineSlot = 3;
constexpr std::uint32_t kEmptyCell = ~std::uint32_t{0};

/// Vertex row numbers for errors: text files have one vertex in each row, usually.
struct VertexPlaces {
  std::string file;
  std::uint64_t first_row = 0; ///< 0: rows are not known

  [[nodiscard]] std::string operator()(std::uint64_t vertex) const {
    if (first_row > 0) return file + ":" + std::to_string(first_row + vertex);
    return file + ": vertex " + std::to_string(vertex);
  }
};

Sample sample_of(const PlyRecord& record, std::uint64_t vertex) noexcept {
  Sample sample;
  sample.place = vertex;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sample.xyz[axis] = record.values[axis];
    if (sample.xyz[axis].kind == NumberKind::invalid) sample.kind = SampleKind::invalid;
  }
  return sample;
}

/// What both kinds of PLY input share. Heap-allocated once: element readers point into the header.
struct PlyFile {
  ByteWindow window;
  PlyHeader header;
  std::vector<std::uint8_t> vertex_slots;
  VertexPlaces places;

  [[nodiscard]] PlyElementReader reader_of(const PlyElement& element) const {
    std::vector<std::uint8_t> slots(element.properties.size(), PlyElementReader::kIgnore);
    if (element.name == "vertex") slots = vertex_slots;
    if (element.name == "range_grid") slots[0] = 0;
    return {element, header.encoding, std::move(slots)};
  }

  /// Reads the vertex and remembers on which row vertices stand.
  Result<void> read_vertex(PlyElementReader& reader, PlyRecord& record) {
    SCANSION_TRY(reader.read(window, record));
    if (header.encoding != PlyEncoding::ascii) return success();
    const std::uint64_t first = window.row_number() - (reader.index() - 1);
    places.first_row = reader.index() == 1 || places.first_row == first ? first : 0;
    return success();
  }

  Result<void> pass_over(const PlyElement& element) {
    PlyElementReader reader = reader_of(element);
    SCANSION_TRY(reader.check_room(window));
    PlyRecord record;
    while (!reader.done()) {
      SCANSION_TRY(reader.read(window, record));
    }
    return success();
  }
};

/// Vertices in file order; a change of `line` starts a scan line.
class PlyLineReader final : public SampleReader {
public:
  explicit PlyLineReader(std::unique_ptr<PlyFile> file)
      : file_(std::move(file)), vertices_(file_->reader_of(*file_->header.find("vertex"))) {}

  Result<std::size_t> read(std::span<Sample> out) override {
    if (!begun_) {
      SCANSION_TRY(begin());
    }
    std::size_t n = 0;
    // A vertex may need a line_end before it.
    while (n + 2 <= out.size() && !vertices_.done()) {
      SCANSION_TRY(file_->read_vertex(vertices_, record_));
      const std::int64_t line = record_.values[kLineSlot].mantissa;
      if (line_ && *line_ != line) {
        out[n] = Sample{};
        out[n++].kind = SampleKind::line_end;
      }
      line_ = line;
      out[n++] = sample_of(record_, vertices_.index() - 1);
    }
    return n;
  }
  std::string where(std::uint64_t place) const override { return file_->places(place); }
  std::uint64_t position() const noexcept override { return file_->window.position(); }

private:
  Result<void> begin() {
    begun_ = true;
    for (const PlyElement& element : file_->header.elements) {
      if (element.name == "vertex") break;
      SCANSION_TRY(file_->pass_over(element));
    }
    return vertices_.check_room(file_->window);
  }

  std::unique_ptr<PlyFile> file_;
  PlyElementReader vertices_;
  PlyRecord record_;
  std::optional<std::int64_t> line_;
  bool begun_ = false;
};

/// The cells of a range grid, column after column or row after row.
class PlyGridReader final : public SampleReader {
public:
  PlyGridReader(std::unique_ptr<PlyFile> file, bool by_rows)
      : file_(std::move(file)), columns_(*file_->header.num_cols), rows_(*file_->header.num_rows), by_rows_(by_rows) {}

  Result<std::size_t> read(std::span<Sample> out) override {
    if (!loaded_) {
      SCANSION_TRY(load());
    }
    const std::uint64_t lines = by_rows_ ? rows_ : columns_;
    const std::uint64_t length = by_rows_ ? columns_ : rows_;
    std::size_t n = 0;
    while (n < out.size() && line_ < lines) {
      Sample& sample = out[n++];
      if (cell_ == length) {
        sample.kind = SampleKind::line_end;
        cell_ = 0;
        ++line_;
        continue;
      }
      SCANSION_TRY(read_cell(by_rows_ ? line_ * columns_ + cell_ : cell_ * columns_ + line_, sample));
      ++cell_;
    }
    return n;
  }
  std::string where(std::uint64_t place) const override { return file_->places(place); }
  std::uint64_t position() const noexcept override { return file_->window.position(); }

private:
  Result<void> read_cell(std::uint64_t index, Sample& sample) {
    SCANSION_TRY(cell, cells_.at(index));
    if (*cell == kEmptyCell) {
      sample.kind = SampleKind::missing;
      return success();
    }
    sample.place = *cell;
    SCANSION_TRY(vertex, vertices_.at(*cell));
    sample.xyz = *vertex;
    const bool valid =
        std::none_of(vertex->begin(), vertex->end(), [](const Number& n) { return n.kind == NumberKind::invalid; });
    sample.kind = valid ? SampleKind::point : SampleKind::invalid;
    return success();
  }

  Result<void> load() {
    loaded_ = true;
    bool vertices = false;
    bool cells = false;
    for (const PlyElement& element : file_->header.elements) {
      if (vertices && cells) break;
      if (element.name == "vertex") {
        SCANSION_TRY(load_vertices(element));
        vertices = true;
      } else if (element.name == "range_grid") {
        SCANSION_TRY(load_cells(element));
        cells = true;
      } else {
        SCANSION_TRY(file_->pass_over(element));
      }
    }
    SCANSION_TRY(vertices_.seal());
    return cells_.seal();
  }

  Result<void> load_vertices(const PlyElement& element) {
    PlyElementReader reader = file_->reader_of(element);
    SCANSION_TRY(reader.check_room(file_->window));
    PlyRecord record;
    while (!reader.done()) {
      SCANSION_TRY(file_->read_vertex(reader, record));
      SCANSION_TRY(vertices_.append({record.values[0], record.values[1], record.values[2]}));
    }
    return success();
  }

  Result<void> load_cells(const PlyElement& element) {
    PlyElementReader reader = file_->reader_of(element);
    SCANSION_TRY(reader.check_room(file_->window));
    const std::uint64_t vertices = file_->header.find("vertex")->count;
    PlyRecord record;
    while (!reader.done()) {
      SCANSION_TRY(reader.read(file_->window, record));
      const Number& index = record.values[0];
      if (record.list_count == 0) {
        SCANSION_TRY(cells_.append(kEmptyCell));
      } else if (record.list_count > 1 || index.kind != NumberKind::decimal || index.exponent != 0 || index.mantissa < 0 ||
                 static_cast<std::uint64_t>(index.mantissa) >= vertices || index.mantissa >= kEmptyCell) {
        return fail(Errc::undecodable, file_->window.name(), ": range_grid cell ", std::to_string(reader.index() - 1),
                    " does not name one of the ", std::to_string(vertices), " vertices; the file is damaged");
      } else {
        SCANSION_TRY(cells_.append(static_cast<std::uint32_t>(index.mantissa)));
      }
    }
    return success();
  }

  std::unique_ptr<PlyFile> file_;
  std::uint64_t columns_, rows_;
  bool by_rows_;
  bool loaded_ = false;
  PagedTable<std::array<Number, 3>> vertices_;
  PagedTable<std::uint32_t> cells_;
  std::uint64_t line_ = 0, cell_ = 0;
};

/// Finds x, y, z and line; true when `line` is there.
Result<bool> find_vertex_properties(PlyFile& file, Notes& notes) {
  const PlyElement* vertex = file.header.find("vertex");
  const std::string& name = file.window.name();
  if (vertex == nullptr) return fail(Errc::undecodable, name, ": has no element vertex; give a PLY file of points");
  constexpr std::array<std::string_view, 4> kNames{"x", "y", "z", "line"};
  std::array<bool, 4> seen{};
  std::string others;
  for (const PlyProperty& property : vertex->properties) {
    const auto at = static_cast<std::size_t>(std::find(kNames.begin(), kNames.end(), property.name) - kNames.begin());
    const bool wanted =
        at < kNames.size() && !property.count_type && !seen[at] && (at != kLineSlot || is_integer(property.type));
    file.vertex_slots.push_back(wanted ? static_cast<std::uint8_t>(at) : PlyElementReader::kIgnore);
    if (wanted) {
      seen[at] = true;
    } else {
      others += (others.empty() ? "" : ", ") + property.name;
    }
  }
  if (!seen[0] || !seen[1] || !seen[2])
    return fail(Errc::undecodable, name, ": vertices have no x, y and z; give a PLY file of points");
  if (!others.empty())
    notes.say(Notes::Subject::properties, name + ": vertex properties passed over: " + others.substr(0, 200));
  return seen[kLineSlot];
}

Result<void> check_grid(const PlyFile& file, const PlyElement& grid) {
  const std::string& name = file.window.name();
  if (grid.properties.empty() || !grid.properties[0].count_type)
    return fail(Errc::undecodable, name, ": range_grid has no list of vertex indices; correct the header");
  const auto columns = file.header.num_cols;
  const auto rows = file.header.num_rows;
  if (!columns || !rows)
    return fail(Errc::undecodable, name, ": a range_grid needs obj_info num_cols and num_rows; add them to the header");
  std::uint64_t cells = 0;
  if (__builtin_mul_overflow(*columns, *rows, &cells) || cells != grid.count)
    return fail(Errc::undecodable, name, ": range_grid has ", std::to_string(grid.count), " cells, obj_info says ",
                std::to_string(*columns), " columns of ", std::to_string(*rows), "; correct the header");
  if (cells == 0) return fail(Errc::undecodable, name, ": range_grid has no cells; give a scan with at least one point");
  return success();
}

} // namespace

Result<std::unique_ptr<SampleReader>> open_ply(ByteWindow window, bool grid_rows, Notes& notes) {
  SCANSION_TRY(header, read_ply_header(window));
  auto file = std::make_unique<PlyFile>(PlyFile{std::move(window), std::move(header), {}, {}});
  file->places.file = file->window.name();
  SCANSION_TRY(has_line, find_vertex_properties(*file, notes));
  if (const PlyElement* grid = file->header.find("range_grid"); grid != nullptr) {
    SCANSION_TRY(check_grid(*file, *grid));
    return std::unique_ptr<SampleReader>(std::make_unique<PlyGridReader>(std::move(file), grid_rows));
  }
  if (!has_line)
    return fail(
        Errc::undecodable, file->window.name(),
        ": has neither a range_grid nor an integer vertex property `line`, so its scan lines cannot be told apart; add one, or "
        "convert it to text with a blank line between scan lines");
  return std::unique_ptr<SampleReader>(std::make_unique<PlyLineReader>(std::move(file)));
}

} // namespace scansion
