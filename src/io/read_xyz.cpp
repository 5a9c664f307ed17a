// Text with one point per line: XYZ, TXT, CSV, PTS. Blanks, commas or semicolons separate the columns; a header line may name them; PTS
// files start with the number of points. Columns beyond x y z without names are told apart by their values.
#include "io/cloud_from_table.h"
#include "io/readers.h"
#include "io/table.h"
#include "io/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace g3r::io {

namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr std::size_t kMostColumns = 1000;  // more means that the file has no line ends

// Comments start a line; CloudCompare's "//X Y Z" is one that names columns.
bool is_comment(std::string_view line) { return line[0] == '#' || line.substr(0, 2) == "//"; }

bool is_header(std::string_view line) {
  double value = 0;
  return line.find_first_of("+-.0123456789") != 0 && !parse_double(line.substr(0, line.find_first_of(" \t,;")), value);
}

// ';' where there is one; ',' only if every comma stands between two values: "0,5 0,25" has decimal commas and is cut at blanks.
char separator_of(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ';';
  if (line.find(',') == std::string_view::npos) return ' ';
  Tokens fields(line, ',');
  std::string_view field;
  while (fields.next(field)) {
    if (field.find_first_of(" \t") != std::string_view::npos) return ' ';
  }
  return ',';
}

// Values of a line, without an empty one after a final separator.
class Values {
 public:
  Values(std::string_view line, char separator) : tokens_(strip(line, separator), separator) {}
  bool next(std::string_view& token) { return tokens_.next(token); }

 private:
  static std::string_view strip(std::string_view line, char separator) {
    if (separator != ' ' && !line.empty() && line.back() == separator) line.remove_suffix(1);
    return line;
  }
  Tokens tokens_;
};

std::size_t count_values(std::string_view line, char separator) {
  Values values(line, separator);
  std::string_view token;
  std::size_t count = 0;
  while (values.next(token)) ++count;
  return count;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

// The name of a column without quotes; known names in our spelling. Units in brackets do not count: "X [m]" is x.
std::string column_name(std::string_view text) {
  while (!text.empty() && (text.front() == '"' || text.front() == '\'')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == '"' || text.back() == '\'')) text.remove_suffix(1);
  constexpr std::pair<std::string_view, std::string_view> kNames[] = {
      {"x", "x"},         {"y", "y"},         {"z", "z"},         {"nx", "nx"},
      {"ny", "ny"},       {"nz", "nz"},       {"normal_x", "nx"}, {"normal_y", "ny"},
      {"normal_z", "nz"}, {"r", "red"},       {"g", "green"},     {"b", "blue"},
      {"red", "red"},     {"green", "green"}, {"blue", "blue"},   {"confidence", "confidence"}};
  const std::string lower = lower_case(trim(text.substr(0, text.find_first_of("[("))));
  for (const auto& [name, ours] : kNames) {
    if (lower == name) return std::string(ours);
  }
  return std::string(text);
}

bool has_name(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Surveyors' names become x, y and z where those are missing.
void name_axes(std::vector<std::string>& names) {
  constexpr std::pair<std::string_view, std::string_view> kTheirs[] = {
      {"easting", "x"}, {"east", "x"}, {"northing", "y"}, {"north", "y"}, {"height", "z"}, {"elevation", "z"}, {"altitude", "z"}};
  for (const auto& axis : kTheirs) {
    if (has_name(names, axis.second)) continue;
    const auto is_theirs = [&](const std::string& name) {
      return lower_case(trim(name.substr(0, name.find_first_of("[(")))) == axis.first;
    };
    const auto found = std::find_if(names.begin(), names.end(), is_theirs);
    if (found != names.end()) *found = axis.second;
  }
}

// A name that occurred before gets a number: a, a_2.
void make_distinct(std::vector<std::string>& names) {
  std::set<std::string> used;
  for (std::string& name : names) {
    const std::string first = name;
    for (int k = 2; !used.insert(name).second; ++k) name = first + "_" + std::to_string(k);
  }
}

// What the first pass finds out.
struct Shape {
  char separator = ' ';
  std::size_t columns = 0;
  std::size_t points = 0;
  bool counted = false;  // PTS
  std::vector<std::string> names;
  bool axes_named = false;      // x, y and z are among the names
  bool header_differs = false;  // a header line with another number of columns
  bool overflow = false;
  bool open_end = false;  // the last line has no line end
};

// Calls visit(line, number) for every line of values and checks the counts of a PTS file.
template <class Visit>
void for_each_line(const Source& source, Shape& shape, const Visit& visit) {
  Lines lines(source.bytes);
  std::string_view line;
  bool first = true;
  std::uint64_t block = 0;  // points that the last count line announced
  std::uint64_t seen = 0;
  const auto check_block = [&] {
    if (shape.counted && seen != block) {
      fail_at_line(source, lines.number(),
                   "expected " + std::to_string(block) + " points as the count line says, found " + std::to_string(seen) +
                       " lines of columns (truncated?)");
    }
  };
  while (lines.next_filled(line)) {
    if (is_comment(line) || (first && is_header(line))) {
      first = first && is_comment(line);
      continue;
    }
    std::uint64_t count = 0;
    if ((first || shape.counted) && parse_integer(line, count)) {
      check_block();
      shape.counted = true;
      block = count;
      seen = 0;
    } else {
      visit(line, lines.number());
      ++seen;
    }
    first = false;
    shape.open_end = !lines.ended();
  }
  check_block();
}

// The names in a header line or in a comment such as "//X Y Z", one per column of the points. A comment must name x, y and z.
void find_names(const Source& source, Shape& shape) {
  Lines lines(source.bytes);
  std::string_view line;
  while (lines.next_filled(line)) {
    std::uint64_t count = 0;
    if (parse_integer(line, count)) continue;
    if (!is_comment(line) && !is_header(line)) break;
    const bool comment = is_comment(line);
    const std::size_t begin = line.find_first_not_of("#/ \t");
    if (begin == std::string_view::npos) continue;
    line.remove_prefix(begin);
    const char separator = count_values(line, shape.separator) == shape.columns ? shape.separator : separator_of(line);
    if (count_values(line, separator) != shape.columns) {
      shape.header_differs = shape.header_differs || !comment;
      continue;
    }
    std::vector<std::string> names;
    names.reserve(shape.columns);
    Values values(line, separator);
    std::string_view token;
    while (values.next(token)) names.push_back(column_name(token));
    name_axes(names);
    shape.axes_named = has_name(names, "x") && has_name(names, "y") && has_name(names, "z");
    if (comment && !shape.axes_named) continue;
    shape.names = std::move(names);
    return;
  }
}

Shape measure(const Source& source) {
  Shape shape;
  for_each_line(source, shape, [&](std::string_view line, std::size_t number) {
    if (shape.points++ != 0) return;
    shape.separator = separator_of(line);
    shape.columns = count_values(line, shape.separator);
    if (shape.columns < 3) {
      std::string_view token;
      double value = 0;
      Values values(line, shape.separator);
      while (values.next(token)) {
        if (!parse_double(token, value)) fail_at_line(source, number, expected_number(token));
      }
      fail_at_line(source, number, "expected at least three columns (x y z), found " + std::to_string(shape.columns));
    }
    if (shape.columns > kMostColumns) {
      fail_at_line(source, number, std::to_string(shape.columns) + " columns on one line: expected one point per line");
    }
  });
  if (shape.points != 0) find_names(source, shape);
  return shape;
}

// Parses all lines; store(values) gets the columns of one point.
template <class Store>
void parse_points(const Source& source, Shape& shape, const Store& store) {
  std::vector<double> row(shape.columns);
  for_each_line(source, shape, [&](std::string_view line, std::size_t number) {
    Values values(line, shape.separator);
    std::string_view token;
    std::size_t found = 0;
    while (values.next(token)) {
      double value = 0;
      if (!parse_double(token, value, &shape.overflow)) fail_at_line(source, number, expected_number(token));
      if (found < row.size()) row[found] = value;
      ++found;
    }
    if (found != row.size()) {
      fail_at_line(source, number,
                   "expected " + std::to_string(row.size()) + " columns as on the lines before, found " + std::to_string(found));
    }
    store(row);
  });
}

bool are_normals(const Element& points, std::size_t column) {
  constexpr double kSlack = 0.01;  // two decimals are common
  const std::size_t stride = points.properties.size();
  bool any = false;
  for (std::size_t i = 0; i < points.count; ++i) {
    double n[3];
    std::copy_n(points.data.data() + (i * stride + column) * sizeof(double), sizeof n, reinterpret_cast<char*>(n));
    const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (std::abs(square - 1) <= kSlack) {
      any = true;
    } else if (square != 0 && !std::isnan(square)) {
      return false;
    }
  }
  return any;
}

bool are_colors(const Element& points, std::size_t column) {
  const std::size_t stride = points.properties.size();
  for (std::size_t i = 0; i < points.count; ++i) {
    for (std::size_t c = column; c < column + 3; ++c) {
      const auto value = load<double>(points.data.data() + (i * stride + c) * sizeof(double));
      if (!(value >= 0 && value <= 255 && value == std::nearbyint(value))) return false;
    }
  }
  return true;
}

void name_triple(Element& points, std::size_t first, const std::array<const char*, 3>& names) {
  for (std::size_t c = 0; c < 3; ++c) points.properties[first + c].name = names[c];
}

// Names for columns without names: triples that look like normals or colours, "scalar_4" and so on else.
void guess_names(Element& points) {
  name_triple(points, 0, {"x", "y", "z"});
  const std::size_t columns = points.properties.size();
  bool normals = false;
  bool colors = false;
  for (std::size_t c = 3; c < columns;) {
    const bool triple = c + 3 <= columns;
    const bool unit = triple && !normals && are_normals(points, c);
    if (triple && !unit && !colors && are_colors(points, c)) {
      name_triple(points, c, {"red", "green", "blue"});
      colors = true;
      c += 3;
    } else if (unit || columns == 6) {  // x y z and a triple that is no colour: normals of any length
      name_triple(points, c, {"nx", "ny", "nz"});
      normals = true;
      c += 3;
    } else {
      points.properties[c].name = "scalar_" + std::to_string(c + 1);
      ++c;
    }
  }
}

std::shared_ptr<Attributes> read_columns(const Source& source, Shape& shape) {
  auto table = std::make_shared<Attributes>();
  table->dialect = Attributes::Dialect::kText;
  table->elements.emplace_back();
  Element& points = table->elements.back();
  points.name = "vertex";
  points.count = shape.points;
  points.properties.resize(shape.columns);
  for (Property& property : points.properties) property.type = Type::kFloat64;
  points.data.reserve(shape.points * shape.columns * sizeof(double));  // each value has two bytes of text
  parse_points(source, shape, [&](const std::vector<double>& row) {
    points.data.append(reinterpret_cast<const char*>(row.data()), row.size() * sizeof(double));
  });
  if (shape.names.empty()) {
    guess_names(points);
  } else {
    std::vector<std::string> names = shape.names;
    if (!shape.axes_named) std::copy_n(kAxes, 3, names.begin());
    make_distinct(names);
    for (std::size_t c = 0; c < shape.columns; ++c) points.properties[c].name = names[c];
  }
  return table;
}

}  // namespace

Cloud read_xyz(const Source& source) {
  Cloud cloud;
  Shape shape = measure(source);
  cloud.format = shape.counted ? "pts" : shape.separator == ' ' ? "xyz" : "csv";
  if (shape.columns > 3 || !shape.names.empty()) {
    fill_cloud(source, read_columns(source, shape), cloud);
  } else {
    cloud.positions.reserve(shape.points);
    parse_points(source, shape, [&](const std::vector<double>& row) { cloud.positions.push_back({row[0], row[1], row[2]}); });
    cloud.property_names = {"x", "y", "z"};
  }
  if (!shape.names.empty() && !shape.axes_named) {
    cloud.warnings.push_back("the header names no columns x, y and z: the first three, " + quote(shape.names[0]) + ", " +
                             quote(shape.names[1]) + " and " + quote(shape.names[2]) + ", are taken for them");
  }
  if (shape.header_differs) cloud.warnings.emplace_back("the header line has not as many columns as the points: it is not used");
  if (shape.overflow) cloud.warnings.emplace_back("a number is out of double's range: it is taken as infinite (not finite)");
  if (shape.open_end) cloud.warnings.emplace_back("the last line has no line end: the file may be cut");
  return cloud;
}

}  // namespace g3r::io
