// OFF in text: OFF, COFF (colours), NOFF (normals) and both, as Geomview's manual describes them, with the counts on the first line or not.
#include "io/cloud_from_table.h"
#include "io/polygons.h"
#include "io/readers.h"
#include "io/text.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <array>
#include <vector>

namespace g3r::io {

namespace {

// Lines without comments and blanks.
class Statements {
 public:
  explicit Statements(std::string_view text, std::size_t lines_before = 0) : lines_(text, lines_before) {}
  bool next(std::string_view& line) {
    if (!pending_.empty()) {
      line = pending_;
      pending_ = {};
      return true;
    }
    while (lines_.next(line)) {
      line = trim(line.substr(0, line.find('#')));
      if (!line.empty()) return true;
    }
    return false;
  }
  // Gives a part of a line back: the next call returns it.
  void put_back(std::string_view part) { pending_ = part; }
  [[nodiscard]] std::size_t number() const { return lines_.number(); }
  [[nodiscard]] std::size_t offset() const { return static_cast<std::size_t>(lines_.offset()); }
  [[nodiscard]] bool ended() const { return lines_.ended(); }

 private:
  Lines lines_;
  std::string_view pending_;
};

class OffParser {
 public:
  explicit OffParser(const Source& source) : source_(source), statements_(source.bytes) {}

  void header() {
    std::string_view line;
    statements_.next(line);
    const std::size_t off = line.find("OFF");
    const std::string_view prefix = line.substr(0, off);
    if (prefix.find_first_of("4n") != std::string_view::npos)
      fail_here("four-dimensional OFF files are not read: expected OFF, COFF, NOFF or CNOFF");
    texture_ = prefix.find("ST") != std::string_view::npos;
    colors_ = prefix.find('C') != std::string_view::npos;
    normals_ = prefix.find('N') != std::string_view::npos;
    std::string_view rest = trim(line.substr(off + 3));
    if (rest.substr(0, 6) == "BINARY") fail_here("binary OFF files are not read: convert the file to PLY or text OFF");
    if (!rest.empty()) statements_.put_back(rest);
    if (!statements_.next(line)) fail(source_, "truncated: expected the counts of vertices and faces, found the end of the file");
    Tokens tokens(line);
    std::string_view token;
    tokens.next(token);
    vertices_ = parse_count(source_, statements_.number(), token, "count of vertices");
    faces_ = tokens.next(token) ? parse_count(source_, statements_.number(), token, "count of faces") : 0;
    constexpr std::size_t kLeastVertex = 6;  // "0 0 0" and a line end
    if (vertices_ > (source_.bytes.size() - statements_.offset() + 1) / kLeastVertex) {
      fail_here("truncated: the header declares " + std::to_string(vertices_) + " vertices, but only " +
                std::to_string(source_.bytes.size() - statements_.offset()) + " bytes follow (count too large)");
    }
  }

  Cloud vertices() {
    Cloud cloud;
    cloud.format = std::string(colors_ ? "c" : "") + (normals_ ? "n" : "") + "off";
    const auto count = static_cast<std::size_t>(vertices_);
    cloud.positions.reserve(count);
    if (normals_) cloud.normals.reserve(count);
    channels_.clear();
    if (colors_) channels_.reserve(count);
    std::string_view line;
    for (std::size_t i = 0; i < count; ++i) {
      if (!statements_.next(line)) {
        fail_here("truncated: unexpected end of file after " + std::to_string(i) + " of " + std::to_string(vertices_) + " vertices");
      }
      vertex(line, cloud);
    }
    faces_at_ = statements_.offset();
    lines_before_faces_ = statements_.number();
    convert_colors(cloud);
    cloud.property_names = {"x", "y", "z"};
    if (normals_) cloud.property_names.insert(cloud.property_names.end(), {"nx", "ny", "nz"});
    if (colors_) cloud.property_names.insert(cloud.property_names.end(), {"red", "green", "blue"});
    if (extra_columns_) cloud.warnings.emplace_back("extra columns on the vertex lines are not used");
    if (overflow_) cloud.warnings.emplace_back(kOverflow);
    if (!statements_.ended()) cloud.warnings.emplace_back(kOpenEnd);
    return cloud;
  }

  // Calls corner(index) between begin(face) and the next; throws InvalidInput for a face that is no face. After vertices(), as often as
  // wanted.
  template <class Begin, class EachCorner>
  void faces(const Begin& begin, const EachCorner& each_corner) {
    statements_ = Statements(source_.bytes.substr(faces_at_), lines_before_faces_);
    std::string_view line;
    for (std::uint64_t face = 0; face < faces_; ++face) {
      if (!statements_.next(line)) {
        fail_here("truncated: unexpected end of file after " + std::to_string(face) + " of " + std::to_string(faces_) +
                  " faces (face count too large)");
      }
      Tokens tokens(line);
      std::string_view token;
      tokens.next(token);
      const std::uint64_t corners = parse_count(source_, statements_.number(), token, "count of corners of a face");
      if (corners > line.size() / 2)
        fail_here("face truncated: " + std::to_string(corners) + " corners declared, more than the line holds (face count)");
      begin(face, static_cast<std::size_t>(corners));
      for (std::uint64_t k = 0; k < corners; ++k) {
        std::int64_t index = 0;
        if (!tokens.next(token) || !parse_integer(token, index)) fail_here("expected a face index, found " + quote(token));
        each_corner(index);
      }
    }
    if (statements_.next(line)) fail_here("lines after the last face (trailing data)");
  }

 private:
  void vertex(std::string_view line, Cloud& cloud) {
    double numbers[12];
    std::size_t found = 0;
    Tokens tokens(line);
    std::string_view token;
    const std::size_t color = normals_ ? 6 : 3;
    while (tokens.next(token)) {
      if (found == 12) fail_here("more than 12 columns for a vertex");
      const bool is_channel = colors_ && found >= color && found < color + 3;
      points_ = points_ || (is_channel && token.find('.') != std::string_view::npos);
      if (!parse_double(token, numbers[found], &overflow_)) fail_here(expected_number(token));
      ++found;
    }
    const std::size_t expected = 3 + (normals_ ? 3 : 0) + (colors_ ? 3 : 0) + (texture_ ? 2 : 0);
    if (found < expected) fail_here("expected " + std::to_string(expected) + " columns for a vertex, found " + std::to_string(found));
    extra_columns_ = extra_columns_ || found > expected + (colors_ ? 1 : 0);  // alpha
    cloud.positions.push_back({numbers[0], numbers[1], numbers[2]});
    if (normals_) cloud.normals.push_back({numbers[3], numbers[4], numbers[5]});
    if (!colors_) return;
    std::array<float, 3>& rgb = channels_.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      store_double(Type::kFloat32, numbers[color + c], reinterpret_cast<char*>(&rgb[c]));
      largest_ = std::max(largest_, rgb[c]);
    }
  }

  // Geomview: whole numbers are 0..255, numbers with a point 0..1.
  void convert_colors(Cloud& cloud) const {
    const double scale = color_scale(points_ ? Type::kFloat32 : Type::kInt32, static_cast<double>(largest_));
    cloud.colors.reserve(channels_.size());
    for (const std::array<float, 3>& rgb : channels_) {
      std::array<std::uint8_t, 3>& color = cloud.colors.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) color[c] = to_color(static_cast<double>(rgb[c]), scale);
    }
  }

  [[noreturn]] void fail_here(const std::string& what) const { fail_at_line(source_, statements_.number(), what); }

  const Source& source_;
  Statements statements_;
  std::uint64_t vertices_ = 0;
  std::uint64_t faces_ = 0;
  std::size_t faces_at_ = 0;  // byte of the line of the first
  std::size_t lines_before_faces_ = 0;
  bool normals_ = false;
  bool colors_ = false;
  bool texture_ = false;
  bool overflow_ = false;
  bool points_ = false;                         // some channels of colours have a decimal point
  float largest_ = 0;                           // of the channels
  std::vector<std::array<float, 3>> channels_;  // as in the file
  bool extra_columns_ = false;
};

}  // namespace

Cloud read_off(const Source& source) {
  OffParser parser(source);
  parser.header();
  Cloud cloud = parser.vertices();
  try {
    parser.faces([](std::uint64_t, std::size_t) {},
                 [&](std::int64_t index) {
                   if (index < 0 || index >= static_cast<std::int64_t>(cloud.positions.size())) fail(source, "face index out of range");
                 });
  } catch (const InvalidInput& error) {
    cloud.warnings.push_back(std::string("the faces are damaged, the points are used: ") + error.what());
  }
  return cloud;
}

Mesh read_off_mesh(const Source& source) {
  Mesh mesh;
  Fans fans(source, mesh);
  OffParser parser(source);
  parser.header();
  Cloud cloud = parser.vertices();
  parser.faces([&](std::uint64_t, std::size_t corners) { fans.count(corners); }, [](std::int64_t) {});
  mesh.vertices = std::move(cloud.positions);
  mesh.colors = std::move(cloud.colors);
  fans.reserve();
  parser.faces([&](std::uint64_t face, std::size_t) { fans.begin(face, "face"); },
               [&](std::int64_t index) { fans.corner(static_cast<double>(index)); });
  return mesh;
}

}  // namespace g3r::io
