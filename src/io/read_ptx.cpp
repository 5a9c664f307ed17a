// PTX, the text of Leica's and other scanners, as points. Its scans: ptx_scans.h.
#include "io/cloud_from_table.h"
#include "io/fixed_records.h"
#include "io/ptx_scans.h"
#include "io/readers.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <array>
#include <utility>

namespace g3r::io {

namespace {

// The points of all scans, one after the other.
class PtxPoints {
 public:
  explicit PtxPoints(const Text& text) : text_(text), source_(text.source()), lines_(text.lines()), found_(find_ptx_scans(text)) {
    plan();
    begin_scan();
  }

  // Without data; count is that of all points.
  [[nodiscard]] const Attributes& table() const { return *table_; }
  [[nodiscard]] const std::vector<PtxScan>& scans() const { return found_.scans; }
  // Of the point that next() has given.
  [[nodiscard]] std::size_t scan() const { return scan_; }
  [[nodiscard]] bool overflow() const { return overflow_; }
  // Whether the last line has no line end.
  [[nodiscard]] bool open_end() const { return found_.open_end; }

  // Appends the record of the next point; false at the end.
  bool next(std::string& records) {
    while (scan_ < found_.scans.size()) {
      while (done_ < found_.scans[scan_].count) {
        ++done_;
        if (next_of_scan(found_.scans[scan_], records)) return true;
      }
      ++scan_;
      begin_scan();
    }
    return false;
  }

 private:
  // The properties that any of the scans has.
  void plan() {
    Element& points = table_->elements.back();
    for (const char* axis : {"x", "y", "z"}) points.add(axis, Type::kFloat64);
    for (const PtxScan& scan : found_.scans) {
      intensity_ = intensity_ || scan.has_intensity();
      color_ = color_ || scan.has_color();
      points.count += scan.hits;
    }
    if (intensity_) points.add("intensity", Type::kFloat32);
    if (color_) {
      for (const char* name : {"red", "green", "blue"}) points.add(name, Type::kUint8);
    }
  }

  void begin_scan() {
    done_ = 0;
    if (scan_ < found_.scans.size()) lines_ = text_.lines_from(found_.scans[scan_].offset, found_.scans[scan_].lines);
  }

  // The record of the scan's next line; false if its beam met nothing.
  bool next_of_scan(const PtxScan& scan, std::string& records) {
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

  void append_point(const PtxScan& scan, const std::array<double, 7>& numbers, std::string& records) const {
    const auto append = [&](Type type, double value) { append_double(type, value, records); };
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
  PtxScans found_;
  std::shared_ptr<Attributes> table_ = Attributes::of_points(Attributes::Dialect::kPly);
  bool intensity_ = false;
  bool color_ = false;
  bool overflow_ = false;
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
  for (const PtxScan& scan : points.scans()) cloud.sensor_positions.push_back(scan.origin);
  while (points.next(data)) {
    if (points.scans().size() > 1) cloud.scan_of_point.push_back(static_cast<std::uint32_t>(points.scan()));
  }
  fill_cloud(source, std::move(table), cloud);
  if (points.overflow()) cloud.warnings.emplace_back(kOverflow);
  if (points.open_end()) cloud.warnings.emplace_back(kOpenEnd);
  return cloud;
}

std::unique_ptr<PointStream> stream_ptx(std::unique_ptr<RandomFile> file, std::uint64_t begin) {
  auto ptx = std::make_unique<PtxFile>(*file, begin);
  return std::make_unique<PtxRecords>(std::move(file), std::move(ptx));
}

}  // namespace g3r::io
