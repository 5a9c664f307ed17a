// PTX, the text of Leica's and other scanners: scan by scan a header of ten lines and one line per point of the scan's grid. The header has
// columns, rows, the position of the scanner, its three axes, and a matrix that takes a row (x y z 1) of the scan to the file's
// coordinates; a point is x y z, then an intensity, a colour, or both. "0 0 0" stands for a beam that met nothing.
#include "io/cloud_from_table.h"
#include "io/fixed_records.h"
#include "io/readers.h"
#include "io/table.h"
#include "io/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace g3r::io {

namespace {

constexpr const char* kOpenEnd = "the last line has no line end: the file may be cut";
constexpr std::uint64_t kLeastLine = 6;  // bytes of "0 0 0" and its end

// One scan: where its points begin, and what its header says.
struct Scan {
  std::uint64_t offset = 0;  // of its first point in the text,
  std::size_t lines = 0;     // and how many lines come before it
  std::uint64_t count = 0;
  std::uint64_t hits = 0;  // points but for beams that met nothing
  std::size_t columns = 0;
  std::array<Vec3, 3> axes{};  // rows of the matrix
  Vec3 origin{};               // its last row: where the scanner stands

  [[nodiscard]] bool has_intensity() const { return columns == 4 || columns >= 7; }
  [[nodiscard]] bool has_color() const { return columns >= 6; }
  [[nodiscard]] std::size_t first_color() const { return columns == 6 ? 3 : 4; }
};

// The points of all scans, one after the other.
class PtxPoints {
 public:
  // Looks at all lines: headers are checked, points counted.
  explicit PtxPoints(const Text& text) : text_(text), source_(text.source()), lines_(text.lines()) {
    std::string_view line;
    while (lines_.next_filled(line)) find_scan(line);
    open_end_ = !lines_.ended();
    plan();
    begin_scan();
  }

  // Without data; count is that of all points.
  [[nodiscard]] const Attributes& table() const { return *table_; }
  [[nodiscard]] const std::vector<Scan>& scans() const { return scans_; }
  // Of the point that next() has given.
  [[nodiscard]] std::size_t scan() const { return scan_; }
  [[nodiscard]] bool overflow() const { return overflow_; }
  // Whether the last line has no line end.
  [[nodiscard]] bool open_end() const { return open_end_; }

  // Appends the record of the next point; false at the end.
  bool next(std::string& records) {
    while (scan_ < scans_.size()) {
      while (done_ < scans_[scan_].count) {
        ++done_;
        if (next_of_scan(scans_[scan_], records)) return true;
      }
      ++scan_;
      begin_scan();
    }
    return false;
  }

 private:
  // Reads a header, of which `line` is the first line, and passes over the points.
  void find_scan(std::string_view line) {
    const std::string what =
        scans_.empty() ? "columns of a scan" : "columns of the next scan (more points follow than the last one declares?)";
    const std::uint64_t columns = parse_count(source_, lines_.number(), line, what);
    line = header_line();
    const std::uint64_t rows = parse_count(source_, lines_.number(), line, "rows of a scan");
    const std::uint64_t left = (text_.size() - lines_.offset() + 1) / kLeastLine;  // the last line may lack its end
    if (rows != 0 && columns > left / rows) {
      fail_at_line(source_, lines_.number(),
                   "truncated: " + std::to_string(columns) + " columns of " + std::to_string(rows) + " points declared, but only " +
                       std::to_string(text_.size() - lines_.offset()) + " bytes follow (count too large)");
    }
    for (int skipped = 0; skipped < 4; ++skipped) header_numbers<3>();  // the matrix says all of the position and the axes
    Scan scan;
    scan.count = columns * rows;
    for (std::size_t row = 0; row < 4; ++row) {
      const std::array<double, 4> numbers = header_numbers<4>();
      if (numbers[3] != (row == 3 ? 1 : 0))
        fail_at_line(source_, lines_.number(), "expected a matrix whose last column is 0 0 0 1 (the shift is its last row)");
      (row == 3 ? scan.origin : scan.axes[row]) = {numbers[0], numbers[1], numbers[2]};
    }
    scan.offset = lines_.offset();
    scan.lines = lines_.number();
    for (std::uint64_t i = 0; i < scan.count; ++i) {
      if (!lines_.next_filled(line)) {
        fail_at_line(source_, lines_.number(),
                     "truncated: unexpected end of file after " + std::to_string(i) + " of " + std::to_string(scan.count) +
                         " points of scan " + std::to_string(scans_.size() + 1));
      }
      if (i == 0) scan.columns = count(line);
      scan.hits += is_hit(line) ? 1 : 0;
    }
    if (scan.columns != 0) scans_.push_back(scan);
  }

  // Whether its first three numbers are not all 0. What are no numbers is told when the point is read.
  static bool is_hit(std::string_view line) {
    Tokens tokens(line);
    std::string_view token;
    for (int a = 0; a < 3 && tokens.next(token); ++a) {
      double value = 0;
      if (!parse_double(token, value) || value != 0) return true;
    }
    return false;
  }

  static std::size_t count(std::string_view line) {
    Tokens tokens(line);
    std::string_view token;
    std::size_t found = 0;
    while (tokens.next(token)) ++found;
    return found;
  }

  std::string_view header_line() {
    std::string_view line;
    if (!lines_.next_filled(line)) fail_at_line(source_, lines_.number(), "truncated: the header of a scan has ten lines");
    return line;
  }

  template <std::size_t N>
  std::array<double, N> header_numbers() {
    std::array<double, N> numbers{};
    Tokens tokens(header_line());
    std::string_view token;
    std::size_t found = 0;
    while (tokens.next(token)) {
      double value = 0;
      if (!parse_double(token, value)) fail_at_line(source_, lines_.number(), expected_number(token));
      if (!std::isfinite(value)) fail_at_line(source_, lines_.number(), "the pose of a scan is not finite");
      if (found < N) numbers[found] = value;
      ++found;
    }
    if (found != N) {
      fail_at_line(
          source_, lines_.number(),
          "expected " + std::to_string(N) + " numbers in this line of a scan's header (a count is wrong?), found " + std::to_string(found));
    }
    return numbers;
  }

  // The properties that any of the scans has.
  void plan() {
    Element& points = table_->elements.back();
    const auto add = [&](const char* name, Type type) {
      points.properties.emplace_back();
      points.properties.back().name = name;
      points.properties.back().type = type;
    };
    for (const char* axis : {"x", "y", "z"}) add(axis, Type::kFloat64);
    for (const Scan& scan : scans_) {
      intensity_ = intensity_ || scan.has_intensity();
      color_ = color_ || scan.has_color();
      points.count += scan.hits;
    }
    if (intensity_) add("intensity", Type::kFloat32);
    if (color_) {
      for (const char* name : {"red", "green", "blue"}) add(name, Type::kUint8);
    }
  }

  void begin_scan() {
    done_ = 0;
    if (scan_ < scans_.size()) lines_ = text_.lines_from(scans_[scan_].offset, scans_[scan_].lines);
  }

  // The record of the scan's next line; false if its beam met nothing.
  bool next_of_scan(const Scan& scan, std::string& records) {
    constexpr std::array<std::size_t, 4> kColumns = {3, 4, 6, 7};
    std::string_view line;
    lines_.next_filled(line);
    Tokens tokens(line);
    std::string_view token;
    std::array<double, 7> numbers{};
    std::size_t found = 0;
    for (; tokens.next(token); ++found) {
      double value = 0;
      if (!parse_double(token, value, &overflow_)) fail_at_line(source_, lines_.number(), expected_number(token));
      if (found < numbers.size()) numbers[found] = value;
    }
    if (found != scan.columns || std::find(kColumns.begin(), kColumns.end(), found) == kColumns.end()) {
      fail_at_line(source_, lines_.number(),
                   "expected x y z, then an intensity, a colour, or both (3, 4, 6 or 7 columns, the same in the whole scan), found " +
                       std::to_string(found));
    }
    if (numbers[0] == 0 && numbers[1] == 0 && numbers[2] == 0) return false;
    append_point(scan, numbers, records);
    return true;
  }

  void append_point(const Scan& scan, const std::array<double, 7>& numbers, std::string& records) const {
    const auto append = [&](Type type, double value) {
      char stored[8];
      store_double(type, value, stored);
      records.append(stored, size_of(type));
    };
    // (x y z 1) M
    for (std::size_t a = 0; a < 3; ++a) {
      append(Type::kFloat64, numbers[0] * scan.axes[0][a] + numbers[1] * scan.axes[1][a] + numbers[2] * scan.axes[2][a] + scan.origin[a]);
    }
    if (intensity_) append(Type::kFloat32, scan.has_intensity() ? numbers[3] : 0);
    for (std::size_t c = 0; color_ && c < 3; ++c) append(Type::kUint8, scan.has_color() ? numbers[scan.first_color() + c] : 0);
  }

  const Text& text_;
  const Source& source_;
  Lines lines_;
  std::vector<Scan> scans_;
  std::shared_ptr<Attributes> table_ = Attributes::of_points(Attributes::Dialect::kPly);
  bool intensity_ = false;
  bool color_ = false;
  bool overflow_ = false;
  bool open_end_ = false;
  std::size_t scan_ = 0;
  std::uint64_t done_ = 0;  // lines of the scan that have been read
};

// The text of a file, and the points in it.
struct PtxFile {
  PtxFile(const RandomFile& file, std::uint64_t begin) : source{{}, file.path()}, text(source, file, begin), points(text) {}
  Source source;
  Text text;
  PtxPoints points;
};

class PtxRecords : public FixedRecords {
 public:
  // `ptx` is that of `file`.
  PtxRecords(std::unique_ptr<RandomFile> file, std::unique_ptr<PtxFile> ptx)
      : FixedRecords(std::move(file), 0, ptx->points.table()), ptx_(std::move(ptx)) {}

  [[nodiscard]] std::vector<std::string> warnings() const override {
    if (!ptx_->points.open_end()) return {};
    return {kOpenEnd};
  }

 private:
  void fetch(std::size_t count, std::string& records) override {
    records.clear();
    for (std::size_t i = 0; i < count && ptx_->points.next(records); ++i) {
    }
  }

  std::unique_ptr<PtxFile> ptx_;
};

}  // namespace

Cloud read_ptx(const Source& source) {
  const Text text(source);
  PtxPoints points(text);
  auto table = std::make_shared<Attributes>(points.table());
  std::string& data = table->elements.back().data;
  data.reserve(bytes_of(table->points().count, table->points().stride()));  // the lines have been seen
  Cloud cloud;
  cloud.format = "ptx";
  for (const Scan& scan : points.scans()) cloud.sensor_positions.push_back(scan.origin);
  while (points.next(data)) {
    if (points.scans().size() > 1) cloud.scan_of_point.push_back(static_cast<std::uint32_t>(points.scan()));
  }
  fill_cloud(source, std::move(table), cloud);
  if (points.overflow()) cloud.warnings.emplace_back("a number is out of double's range: it is taken as infinite (not finite)");
  if (points.open_end()) cloud.warnings.emplace_back(kOpenEnd);
  return cloud;
}

std::unique_ptr<PointStream> stream_ptx(std::unique_ptr<RandomFile> file, std::uint64_t begin) {
  auto ptx = std::make_unique<PtxFile>(*file, begin);
  return std::make_unique<PtxRecords>(std::move(file), std::move(ptx));
}

}  // namespace g3r::io
