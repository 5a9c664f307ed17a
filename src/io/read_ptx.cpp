// PTX, the text of Leica's and other scanners: scan by scan a header of ten lines and one line per point of the scan's grid. The header has
// columns, rows, the position of the scanner, its three axes, and a matrix that takes a row (x y z 1) of the scan to the file's
// coordinates; a point is x y z, then an intensity, a colour, or both. "0 0 0" stands for a beam that met nothing.
#include "io/cloud_from_table.h"
#include "io/readers.h"
#include "io/table.h"
#include "io/text.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace g3r::io {

namespace {

constexpr std::uint64_t kLeastLine = 6;  // bytes of "0 0 0" and its end

// One scan: where its points begin, and what its header says.
struct Scan {
  Lines points;  // at the first one
  std::uint64_t count = 0;
  std::size_t columns = 0;
  std::array<Vec3, 3> axes{};  // rows of the matrix
  Vec3 origin{};               // its last row: where the scanner stands

  [[nodiscard]] bool has_intensity() const { return columns == 4 || columns >= 7; }
  [[nodiscard]] bool has_color() const { return columns >= 6; }
  [[nodiscard]] std::size_t first_color() const { return columns == 6 ? 3 : 4; }
};

class PtxReader {
 public:
  explicit PtxReader(const Source& source) : source_(source), lines_(source.bytes) {}

  Cloud read() {
    std::string_view line;
    while (lines_.next_filled(line)) find_scan(line);
    const std::shared_ptr<Attributes> table = Attributes::of_points(Attributes::Dialect::kPly);
    Element& points = table->elements.back();
    plan(points);
    Cloud cloud;
    cloud.format = "ptx";
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      read_points(scans_[i], points);
      cloud.sensor_positions.push_back(scans_[i].origin);
      if (scans_.size() > 1) cloud.scan_of_point.resize(static_cast<std::size_t>(points.count), static_cast<std::uint32_t>(i));
    }
    fill_cloud(source_, table, cloud);
    if (overflow_) cloud.warnings.emplace_back("a number is out of double's range: it is taken as infinite (not finite)");
    if (!lines_.ended()) cloud.warnings.emplace_back("the last line has no line end: the file may be cut");
    return cloud;
  }

 private:
  // Reads a header, of which `line` is the first line, and passes over the points.
  void find_scan(std::string_view line) {
    const std::string what =
        scans_.empty() ? "columns of a scan" : "columns of the next scan (more points follow than the last one declares?)";
    const std::uint64_t columns = parse_count(source_, lines_.number(), line, what);
    line = header_line();
    const std::uint64_t rows = parse_count(source_, lines_.number(), line, "rows of a scan");
    const std::uint64_t left = (source_.bytes.size() - lines_.offset() + 1) / kLeastLine;  // the last line may lack its end
    if (rows != 0 && columns > left / rows) {
      fail_at_line(source_, lines_.number(),
                   "truncated: " + std::to_string(columns) + " columns of " + std::to_string(rows) + " points declared, but only " +
                       std::to_string(source_.bytes.size() - lines_.offset()) + " bytes follow (count too large)");
    }
    for (int skipped = 0; skipped < 4; ++skipped) header_numbers<3>();  // the matrix says all of the position and the axes
    Scan scan{lines_};
    scan.count = columns * rows;
    for (std::size_t row = 0; row < 4; ++row) {
      const std::array<double, 4> numbers = header_numbers<4>();
      if (numbers[3] != (row == 3 ? 1 : 0))
        fail_at_line(source_, lines_.number(), "expected a matrix whose last column is 0 0 0 1 (the shift is its last row)");
      (row == 3 ? scan.origin : scan.axes[row]) = {numbers[0], numbers[1], numbers[2]};
    }
    scan.points = lines_;
    for (std::uint64_t i = 0; i < scan.count; ++i) {
      if (!lines_.next_filled(line)) {
        fail_at_line(source_, lines_.number(),
                     "truncated: unexpected end of file after " + std::to_string(i) + " of " + std::to_string(scan.count) +
                         " points of scan " + std::to_string(scans_.size() + 1));
      }
      if (i == 0) scan.columns = count(line);
    }
    if (scan.columns != 0) scans_.push_back(scan);
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
  void plan(Element& points) {
    const auto add = [&](const char* name, Type type) {
      points.properties.emplace_back();
      points.properties.back().name = name;
      points.properties.back().type = type;
    };
    for (const char* axis : {"x", "y", "z"}) add(axis, Type::kFloat64);
    std::uint64_t count = 0;
    for (const Scan& scan : scans_) {
      intensity_ = intensity_ || scan.has_intensity();
      color_ = color_ || scan.has_color();
      count += scan.count;
    }
    if (intensity_) add("intensity", Type::kFloat32);
    if (color_) {
      for (const char* name : {"red", "green", "blue"}) add(name, Type::kUint8);
    }
    points.data.reserve(bytes_of(count, points.stride()));  // the lines have been seen
  }

  void read_points(const Scan& scan, Element& points) {
    constexpr std::array<std::size_t, 4> kColumns = {3, 4, 6, 7};
    Lines lines = scan.points;
    std::string_view line;
    std::array<double, 7> numbers{};
    for (std::uint64_t i = 0; i < scan.count; ++i) {
      lines.next_filled(line);
      Tokens tokens(line);
      std::string_view token;
      std::size_t found = 0;
      for (; tokens.next(token); ++found) {
        double value = 0;
        if (!parse_double(token, value, &overflow_)) fail_at_line(source_, lines.number(), expected_number(token));
        if (found < numbers.size()) numbers[found] = value;
      }
      if (found != scan.columns || std::find(kColumns.begin(), kColumns.end(), found) == kColumns.end()) {
        fail_at_line(source_, lines.number(),
                     "expected x y z, then an intensity, a colour, or both (3, 4, 6 or 7 columns, the same in the whole scan), found " +
                         std::to_string(found));
      }
      if (numbers[0] != 0 || numbers[1] != 0 || numbers[2] != 0) append_point(scan, numbers, points);
    }
  }

  void append_point(const Scan& scan, const std::array<double, 7>& numbers, Element& points) {
    const auto append = [&](Type type, double value) {
      char stored[8];
      store_double(type, value, stored);
      points.data.append(stored, size_of(type));
    };
    // (x y z 1) M
    for (std::size_t a = 0; a < 3; ++a) {
      append(Type::kFloat64, numbers[0] * scan.axes[0][a] + numbers[1] * scan.axes[1][a] + numbers[2] * scan.axes[2][a] + scan.origin[a]);
    }
    if (intensity_) append(Type::kFloat32, scan.has_intensity() ? numbers[3] : 0);
    for (std::size_t c = 0; color_ && c < 3; ++c) append(Type::kUint8, scan.has_color() ? numbers[scan.first_color() + c] : 0);
    ++points.count;
  }

  const Source& source_;
  Lines lines_;
  std::vector<Scan> scans_;
  bool intensity_ = false;
  bool color_ = false;
  bool overflow_ = false;
};

}  // namespace

Cloud read_ptx(const Source& source) { return PtxReader(source).read(); }

}  // namespace g3r::io
