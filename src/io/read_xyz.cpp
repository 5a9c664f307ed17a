// Text with one point per line: XYZ, TXT, CSV, PTS. Where its points are: point_lines.h; what its columns are: find_columns.h.
#include "io/cloud_from_table.h"
#include "io/find_columns.h"
#include "io/fixed_records.h"
#include "io/readers.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r::io {

namespace {

// The points of the kept columns, without records.
Element points_of(TextColumns& columns, std::uint64_t count) {
  Element points = make_vertex_element();
  points.properties = std::move(columns.properties);
  points.count = count;
  return points;
}

std::shared_ptr<Attributes> read_table(const Text& text, const TextShape& shape, bool& overflow, std::vector<std::string>& warnings) {
  std::string data;
  data.reserve(bytes_of(shape.points, shape.columns * sizeof(double)));  // each value has two bytes of text
  TextColumns columns = find_columns(
      text, shape, [&](const double* row) { data.append(reinterpret_cast<const char*>(row), shape.columns * sizeof(double)); });
  if (columns.kept.size() < shape.columns) {
    char* to = data.data();
    for (const char* row = data.data(); row != data.data() + data.size(); row += shape.columns * sizeof(double)) {
      for (const std::size_t c : columns.kept) to = std::copy_n(row + c * sizeof(double), sizeof(double), to);
    }
    data.resize(static_cast<std::size_t>(to - data.data()));
  }
  overflow = columns.overflow;
  warnings = std::move(columns.warnings);
  Element points = points_of(columns, shape.points);
  points.data = std::move(data);
  return Attributes::of_points(Attributes::Dialect::kText, std::move(points));
}

// Where the numbers can be degrees.
void warn_about_degrees(Cloud& cloud) {
  for (const Vec3& p : cloud.positions) {
    if (std::abs(p[0]) > 360 || std::abs(p[1]) > 90) return;
  }
  cloud.warnings.emplace_back(kDegrees);
}

std::vector<std::string> warnings_of(const TextShape& shape, bool overflow) {
  std::vector<std::string> warnings;
  if (shape.announced) {
    warnings.push_back("more points follow than the count line says (" + std::to_string(*shape.announced) + "): all are read");
  }
  if (shape.unused_headers > 0) {
    const std::string lines = shape.unused_headers == 1 ? "a line" : std::to_string(shape.unused_headers) + " lines";
    warnings.push_back(lines + " before the points, line " + std::to_string(shape.unused_line) + " " + quote(shape.unused_text) +
                       (shape.unused_headers == 1 ? "" : " the first") +
                       (shape.header.names.empty() ? ", not used: without a name for every column of the points" : ", not used"));
  }
  if (overflow) warnings.emplace_back(kOverflow);
  if (shape.open_end) warnings.emplace_back(kOpenEnd);
  return warnings;
}

// The text of a file, and the kept columns of its points.
struct TextFile {
  TextFile(const RandomFile& file, std::uint64_t begin)
      : source{{}, file.path()}, text(source, file, begin), shape(measure(text)), rows(text, shape, no_words(text, shape)) {
    if (!shape.is_bare()) {
      columns = find_columns(text, shape);
      rows = PointRows(text, shape, [](std::size_t, std::size_t, std::string_view) {});  // find_columns() has seen the words
      return;
    }
    Element bare;
    for (const char* axis : {"x", "y", "z"}) columns.kept.push_back(bare.add(axis, Type::kFloat64));
    columns.properties = std::move(bare.properties);
  }

  [[nodiscard]] Attributes table() {
    const Attributes::Dialect dialect = shape.is_bare() ? Attributes::Dialect::kPly : Attributes::Dialect::kText;  // as without a table
    return *Attributes::of_points(dialect, points_of(columns, shape.points));
  }

  Source source;
  Text text;
  TextShape shape;
  PointRows rows;
  TextColumns columns;
};

class TextRecords : public FixedRecords {
 public:
  // `text` is that of `file`.
  TextRecords(std::unique_ptr<RandomFile> file, std::unique_ptr<TextFile> text)
      : FixedRecords(std::move(file), 0, text->table()), text_(std::move(text)) {}

  [[nodiscard]] std::vector<std::string> warnings() const override {
    std::vector<std::string> all = text_->columns.warnings;
    const std::vector<std::string> more = warnings_of(text_->shape, text_->columns.overflow);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

 private:
  void fetch(std::size_t count, std::string& records) override {
    records.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const double* row = text_->rows.next();
      if (row == nullptr) return;
      for (const std::size_t c : text_->columns.kept) records.append(reinterpret_cast<const char*>(row + c), sizeof(double));
    }
  }

  std::unique_ptr<TextFile> text_;
};

}  // namespace

Cloud read_xyz(const Source& source) {
  Cloud cloud;
  const Text text(source);
  const TextShape shape = measure(text);
  cloud.format = shape.counted ? "pts" : shape.separator == ' ' ? "xyz" : "csv";
  bool overflow = false;
  if (!shape.is_bare()) {
    std::shared_ptr<Attributes> table = read_table(text, shape, overflow, cloud.warnings);
    fill_cloud(source, std::move(table), cloud);
  } else {
    cloud.positions.reserve(static_cast<std::size_t>(shape.points));
    PointRows rows(text, shape, no_words(text, shape));
    while (const double* row = rows.next()) cloud.positions.push_back({row[0], row[1], row[2]});
    overflow = rows.overflow();
    cloud.warnings = about_missing(shape, rows.missing());
    cloud.property_names = {"x", "y", "z"};
  }
  if (shape.header.geographic) warn_about_degrees(cloud);
  const std::vector<std::string> more = warnings_of(shape, overflow);
  cloud.warnings.insert(cloud.warnings.end(), more.begin(), more.end());
  return cloud;
}

std::unique_ptr<PointStream> stream_xyz(std::unique_ptr<RandomFile> file, std::uint64_t begin) {
  auto text = std::make_unique<TextFile>(*file, begin);
  return std::make_unique<TextRecords>(std::move(file), std::move(text));
}

}  // namespace g3r::io
