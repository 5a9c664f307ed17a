// Arc/Info (Esri) ASCII grids as points: one for every cell that has a value, in its middle. What a header says: grid_header.h.
#include "io/fixed_records.h"
#include "io/grid_header.h"
#include "io/readers.h"
#include "io/text_numbers.h"

#include <cmath>
#include <utility>

namespace g3r::io {

namespace {

// A step of float32, as a share of the number: programs write NODATA_value with other digits than the values.
constexpr double kNoDataDigits = 1.2e-7;

// The cells that have a value, row by row from the north.
class GridCells {
 public:
  explicit GridCells(const Text& text)
      : source_(text.source()), header_(read_grid_header(text)), lines_(text.lines_from(header_.offset, header_.lines)) {}

  // The middle of the next cell, at the height of its value; false at the end.
  bool next(Vec3& point) {
    for (double value = 0; next_value(value);) {
      if (std::isnan(value) || is_near(value, header_.no_data)) continue;
      if (is_near(value, kUsualNoData)) ++usual_;
      const std::uint64_t cell = done_ - 1;
      const std::uint64_t from_south = header_.rows - 1 - cell / header_.columns;
      point = {middle(0, cell % header_.columns), middle(1, from_south), value};
      ++points_;
      return true;
    }
    return false;
  }

  // Of the cells that next() has passed.
  [[nodiscard]] std::uint64_t points() const { return points_; }
  [[nodiscard]] std::vector<std::string> warnings() const {
    std::vector<std::string> all;
    const std::string no_data = number_text(header_.no_data);
    if (points_ == 0) all.push_back("no points: all of " + header_.counts() + " are NODATA_value (" + no_data + ") or nan");
    if (usual_ != 0)
      all.push_back("-9999 is the value of " + std::to_string(usual_) + " cells, but NODATA_value is " + no_data +
                    ": it is read as a height");
    if (overflow_) all.emplace_back(kOverflow);
    if (open_end_) all.emplace_back(kOpenEnd);
    return all;
  }

 private:
  static bool is_near(double value, double no_data) {
    return value == no_data || std::abs(value - no_data) < kNoDataDigits * std::abs(no_data);
  }

  [[nodiscard]] double middle(std::size_t axis, std::uint64_t cell) const {
    return header_.corner[axis] + (static_cast<double>(cell) + header_.to_middle[axis]) * header_.size[axis];
  }

  bool next_value(double& value) {
    std::string_view token;
    while (!tokens_.next(token)) {
      std::string_view line;
      if (!lines_.next_filled(line)) return end();
      open_end_ = !lines_.ended();
      tokens_ = Tokens(line);
    }
    if (done_ == header_.columns * header_.rows) {
      fail_at_line(
          source_, lines_.number(),
          "expected the end of the file after " + header_.counts() + ", found " + quote(token) + " (a count in the header is wrong?)");
    }
    if (!parse_double(token, value, &overflow_)) fail_at_line(source_, lines_.number(), expected_number(token));
    ++done_;
    return true;
  }

  [[nodiscard]] bool end() const {
    if (done_ == header_.columns * header_.rows) return false;
    fail_at_line(source_, lines_.number(),
                 "truncated: unexpected end of file after " + std::to_string(done_) + " of " + header_.counts() +
                     ", or a count in the header is wrong");
  }

  const Source& source_;
  GridHeader header_;
  Lines lines_;
  Tokens tokens_{{}};       // what is left of the line
  std::uint64_t done_ = 0;  // values
  std::uint64_t points_ = 0;
  std::uint64_t usual_ = 0;  // points whose height stands for none in most files
  bool overflow_ = false;
  bool open_end_ = false;
};

// All cells, passed.
GridCells pass_cells(const Text& text) {
  GridCells cells(text);
  for (Vec3 point{}; cells.next(point);) {
  }
  return cells;
}

// The text of a file, and the points in it.
struct GridFile {
  GridFile(const RandomFile& file, std::uint64_t begin) : source{{}, file.path()}, text(source, file, begin), cells(text) {
    const GridCells passed = pass_cells(text);
    warnings = passed.warnings();
    Element& points = table->elements.back();
    for (const char* axis : {"x", "y", "z"}) points.add(axis, Type::kFloat64);
    points.count = passed.points();
  }
  Source source;
  Text text;
  GridCells cells;
  std::vector<std::string> warnings;
  std::shared_ptr<Attributes> table = Attributes::of_points(Attributes::Dialect::kPly);
};

class GridRecords : public FixedRecords {
 public:
  // `grid` is that of `file`.
  GridRecords(std::unique_ptr<RandomFile> file, std::unique_ptr<GridFile> grid)
      : FixedRecords(std::move(file), 0, *grid->table), grid_(std::move(grid)) {}

  [[nodiscard]] std::vector<std::string> warnings() const override { return grid_->warnings; }

 private:
  void fetch(std::size_t count, std::string& records) override {
    records.clear();
    Vec3 point{};
    for (std::size_t i = 0; i < count && grid_->cells.next(point); ++i)
      records.append(reinterpret_cast<const char*>(point.data()), sizeof point);
  }

  std::unique_ptr<GridFile> grid_;
};

}  // namespace

Cloud read_ascii_grid(const Source& source) {
  const Text text(source);
  const GridCells passed = pass_cells(text);
  Cloud cloud;
  cloud.format = "ascii grid";
  cloud.property_names = {"x", "y", "z"};
  cloud.warnings = passed.warnings();
  cloud.positions.reserve(static_cast<std::size_t>(passed.points()));
  GridCells cells(text);
  for (Vec3 point{}; cells.next(point);) cloud.positions.push_back(point);
  return cloud;
}

std::unique_ptr<PointStream> stream_ascii_grid(std::unique_ptr<RandomFile> file, std::uint64_t begin) {
  auto grid = std::make_unique<GridFile>(*file, begin);
  return std::make_unique<GridRecords>(std::move(file), std::move(grid));
}

}  // namespace g3r::io
