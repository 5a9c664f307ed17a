// Text with one point per line: XYZ, TXT, CSV, PTS. Blanks, commas or semicolons separate the columns; a header line may name them; PTS
// files start with the number of points. Columns without names are told apart by their values; those that hold text are left out.
#include "io/cloud_from_table.h"
#include "io/readers.h"
#include "io/table.h"
#include "io/text.h"
#include "io/text_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace g3r::io {

namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr std::size_t kMostColumns = 1000;  // more means that the file has no line ends

// A column with a word in more than one line of so many holds text; fewer words are damage, which is an error.
constexpr std::uint64_t kLinesPerWord = 100;

// Comments start a line; CloudCompare's "//X Y Z" is one that names columns.
bool is_comment(std::string_view line) { return line[0] == '#' || line.substr(0, 2) == "//"; }

// A first line that names columns: it starts with a word and is no point whose first column holds text.
bool is_header(std::string_view line) {
  const char separator = separator_of(line);
  Values values(line, separator);
  std::string_view first;
  double number = 0;
  return values.next(first) && !is_like_number(first) && !parse_double(first, number) && count_numbers(line, separator) < 3;
}

// What the first pass finds out.
struct Shape {
  char separator = ' ';
  std::size_t columns = 0;
  std::size_t points = 0;
  bool counted = false;                      // PTS
  std::optional<std::uint64_t> announced{};  // of the first count line that more points follow than it says
  ColumnNames header;
  bool header_differs = false;  // a header line with another number of columns
  bool overflow = false;
  bool open_end = false;  // the last line has no line end
};

// Values of a column that are no numbers.
struct Words {
  std::uint64_t count = 0;
  std::size_t line = 0;  // of the first
  std::string_view first{};
  bool like_numbers = false;  // some begin like a number
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
    if (shape.counted && seen > block && !shape.announced) shape.announced = block;
    if (shape.counted && seen < block) {
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
    const bool comment = is_comment(line);
    if (!comment && !is_header(line)) break;
    const std::size_t begin = line.find_first_not_of("#/ \t");
    if (begin == std::string_view::npos) continue;
    line.remove_prefix(begin);
    const char separator = count_values(line, shape.separator) == shape.columns ? shape.separator : separator_of(line);
    if (count_values(line, separator) != shape.columns) {
      shape.header_differs = shape.header_differs || !comment;
      continue;
    }
    ColumnNames header = column_names(line, separator);
    if (comment && !header.axes) continue;
    shape.header = std::move(header);
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

// Parses all lines; store(values) gets the columns of one point. word(column, line, value) is told of values that are no numbers, which
// become NaN, and throws where there must be numbers.
template <class Store, class Word>
void parse_points(const Source& source, Shape& shape, const Store& store, const Word& word) {
  std::vector<double> row(shape.columns);
  for_each_line(source, shape, [&](std::string_view line, std::size_t number) {
    Values values(line, shape.separator);
    std::string_view token;
    std::size_t found = 0;
    while (values.next(token)) {
      double value = 0;
      if (!parse_double(token, value, &shape.overflow)) {
        value = std::numeric_limits<double>::quiet_NaN();
        if (found < row.size()) word(found, number, token);
      }
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

// All columns as a table of doubles without names, and what is no number in it.
Element read_columns(const Source& source, Shape& shape, std::vector<Words>& words) {
  Element points = make_vertex_element();
  points.count = shape.points;
  points.properties.resize(shape.columns);
  for (Property& property : points.properties) property.type = Type::kFloat64;
  points.data.reserve(bytes_of(shape.points, shape.columns * sizeof(double)));  // each value has two bytes of text
  words.resize(shape.columns);
  parse_points(
      source, shape,
      [&](const std::vector<double>& row) { points.data.append(reinterpret_cast<const char*>(row.data()), row.size() * sizeof(double)); },
      [&](std::size_t column, std::size_t line, std::string_view value) {
        Words& here = words[column];
        if (here.count++ == 0) {
          here.line = line;
          here.first = value;
        }
        here.like_numbers = here.like_numbers || is_like_number(value);
      });
  return points;
}

[[noreturn]] void fail_at_word(const Source& source, const Words& words) { fail_at_line(source, words.line, expected_number(words.first)); }

// Which columns hold text; a word among numbers is an error.
std::vector<TextColumn> find_text(const Source& source, const Element& points, const std::vector<Words>& words) {
  std::vector<TextColumn> text(words.size());
  const Words* damage = nullptr;
  for (std::size_t c = 0; c < words.size(); ++c) {
    text[c].any = words[c].count != 0;
    text[c].all = words[c].count == points.count && !words[c].like_numbers;
    if (text[c].any && words[c].count * kLinesPerWord <= points.count && (damage == nullptr || words[c].line < damage->line))
      damage = &words[c];
  }
  if (damage != nullptr) fail_at_word(source, *damage);
  return text;
}

// Names the columns of a text without names, as far as their order says what they are; returns how many.
std::size_t name_first_columns(const Source& source, bool counted, Element& points, const std::vector<Words>& words,
                               const std::vector<TextColumn>& text, std::vector<std::string>& warnings) {
  const Arrangement arrangement = counted ? Arrangement::kXyz : find_arrangement(points, text);  // PTS is always x y z
  if (arrangement == Arrangement::kPnezd) {
    warnings.emplace_back(
        "the columns look like point number, northing, easting, elevation and description (PNEZD) and are read so; if they are others, "
        "name "
        "them in a first line, for example point,x,y,z,description");
    constexpr const char* kNames[] = {"point", "y", "x", "z", "description"};
    for (std::size_t c = 0; c < std::size(kNames); ++c) points.properties[c].name = kNames[c];
    return std::size(kNames);
  }
  const std::size_t first = arrangement == Arrangement::kNumberedXyz ? 1 : 0;
  if (first != 0) {
    points.properties[0].name = "point";
    warnings.emplace_back(
        "the first column names or numbers the points; the next three are taken for x, y and z; if they are others, name the columns in a "
        "first line, for example point,northing,easting,elevation");
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (text[first + a].any) fail_at_word(source, words[first + a]);
    points.properties[first + a].name = kAxes[a];
  }
  return first + 3;
}

// Names the columns by the header. x, y and z must be numbers.
void name_by_header(const Source& source, const Shape& shape, Element& points, const std::vector<Words>& words,
                    std::vector<std::string>& warnings) {
  std::vector<std::string> names = shape.header.names;
  if (!shape.header.axes) {
    std::vector<std::size_t> numbers;
    for (std::size_t c = 0; c < names.size() && numbers.size() < 3; ++c) {
      if (words[c].count == 0) numbers.push_back(c);
    }
    if (numbers.size() < 3) fail(source, "the header names no columns x, y and z, and fewer than three columns are numbers");
    warnings.push_back("the header names no columns x, y and z: the first three, " + quote(names[numbers[0]]) + ", " +
                       quote(names[numbers[1]]) + " and " + quote(names[numbers[2]]) + ", are taken for them");
    for (std::size_t a = 0; a < 3; ++a) names[numbers[a]] = kAxes[a];
  }
  make_distinct(names);
  for (std::size_t c = 0; c < names.size(); ++c) points.properties[c].name = names[c];
  for (const char* axis : kAxes) {
    const std::size_t column = points.find(axis);
    if (words[column].count != 0) fail_at_word(source, words[column]);
  }
}

// Takes the columns with text out of the records, and says so. Returns how many of the first `known` columns are left.
std::size_t leave_out_text(Element& points, const std::vector<Words>& words, std::size_t known, std::vector<std::string>& warnings) {
  constexpr std::size_t kMostNamed = 8;
  std::vector<std::size_t> kept;
  std::string names;
  for (std::size_t c = 0; c < words.size(); ++c) {
    if (words[c].count == 0) {
      kept.push_back(c);
      continue;
    }
    const std::size_t left_out = c + 1 - kept.size();
    if (left_out > kMostNamed) continue;
    if (left_out > 1) names += ", ";
    names += std::to_string(c + 1);
    if (!points.properties[c].name.empty()) names.append(" ").append(quote(points.properties[c].name));
    names.append(" (").append(quote(words[c].first)).append(")");
  }
  if (kept.size() == words.size()) return known;
  const std::size_t more = words.size() - kept.size() > kMostNamed ? words.size() - kept.size() - kMostNamed : 0;
  if (more != 0) names += " and " + std::to_string(more) + " more";
  warnings.push_back("columns that hold text are not used: " + names);
  char* to = points.data.data();
  for (std::size_t i = 0; i < points.count; ++i) {
    for (const std::size_t c : kept) {
      const char* from = points.data.data() + (i * words.size() + c) * sizeof(double);
      to = std::copy_n(from, sizeof(double), to);
    }
  }
  points.data.resize(static_cast<std::size_t>(to - points.data.data()));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (k != kept[k]) points.properties[k] = std::move(points.properties[kept[k]]);
  }
  points.properties.resize(kept.size());
  return static_cast<std::size_t>(std::lower_bound(kept.begin(), kept.end(), known) - kept.begin());
}

std::shared_ptr<Attributes> read_table(const Source& source, Shape& shape, std::vector<std::string>& warnings) {
  auto table = std::make_shared<Attributes>();
  table->dialect = Attributes::Dialect::kText;
  std::vector<Words> words;
  table->elements.push_back(read_columns(source, shape, words));
  Element& points = table->elements.back();
  const std::vector<TextColumn> text = find_text(source, points, words);
  std::size_t known = shape.columns;
  if (shape.header.names.empty()) {
    known = name_first_columns(source, shape.counted, points, words, text, warnings);
  } else {
    name_by_header(source, shape, points, words, warnings);
  }
  known = leave_out_text(points, words, known, warnings);
  guess_names(points, known);
  return table;
}

// Longitude and latitude beside heights in metres: a shape that nobody wants.
void warn_about_degrees(Cloud& cloud) {
  for (const Vec3& p : cloud.positions) {
    if (std::abs(p[0]) > 360 || std::abs(p[1]) > 90) return;
  }
  cloud.warnings.emplace_back(
      "x and y are longitude and latitude: where they are degrees the shape is distorted; project them first, for example with PDAL or "
      "PROJ");
}

}  // namespace

Cloud read_xyz(const Source& source) {
  Cloud cloud;
  Shape shape = measure(source);
  cloud.format = shape.counted ? "pts" : shape.separator == ' ' ? "xyz" : "csv";
  if (shape.columns > 3 || !shape.header.names.empty()) {
    fill_cloud(source, read_table(source, shape, cloud.warnings), cloud);
  } else {
    cloud.positions.reserve(shape.points);
    parse_points(
        source, shape,
        [&](const std::vector<double>& row) {
          cloud.positions.push_back({row[0], row[1], row[2]});
        },
        [&](std::size_t, std::size_t line, std::string_view value) { fail_at_line(source, line, expected_number(value)); });
    cloud.property_names = {"x", "y", "z"};
  }
  if (shape.header.geographic) warn_about_degrees(cloud);
  if (shape.announced) {
    cloud.warnings.push_back("more points follow than the count line says (" + std::to_string(*shape.announced) + "): all are read");
  }
  if (shape.header_differs) cloud.warnings.emplace_back("the header line has not as many columns as the points: it is not used");
  if (shape.overflow) cloud.warnings.emplace_back("a number is out of double's range: it is taken as infinite (not finite)");
  if (shape.open_end) cloud.warnings.emplace_back("the last line has no line end: the file may be cut");
  return cloud;
}

}  // namespace g3r::io
