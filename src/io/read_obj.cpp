// Wavefront OBJ: v (with optional w or r g b), vn and f. Everything else is passed over; no other file is opened.
#include "io/cloud_from_table.h"
#include "io/polygons.h"
#include "io/readers.h"
#include "io/text.h"
#include "io/text_numbers.h"

#include <algorithm>

namespace g3r::io {

namespace {

struct Counts {
  std::size_t vertices = 0;
  std::size_t normals = 0;
};

// Calls visit(keyword, tokens, line number) for every statement.
template <class Visit>
Lines for_each_statement(const Source& source, const Visit& visit) {
  Lines lines(source.bytes);
  std::string_view line;
  while (lines.next_filled(line)) {
    if (line[0] == '#') continue;
    Tokens tokens(line);
    std::string_view keyword;
    tokens.next(keyword);
    if (line.back() == '\\' && (keyword == "v" || keyword == "vn" || keyword == "f")) {
      fail_at_line(source, lines.number(), "the line is continued on the next (\\): expected all numbers on one line");
    }
    visit(keyword, tokens, lines.number());
  }
  return lines;
}

// Numbers of a v or vn line; at most `most`.
std::size_t parse_numbers(const Source& source, std::size_t line, Tokens& tokens, double* numbers, std::size_t most, bool& overflow) {
  std::string_view token;
  std::size_t count = 0;
  while (tokens.next(token)) {
    if (count == most) fail_at_line(source, line, "more than " + std::to_string(most) + " numbers for a vertex or normal");
    if (!parse_double(token, numbers[count], &overflow)) fail_at_line(source, line, expected_number(token));
    ++count;
  }
  if (count < 3) fail_at_line(source, line, "expected three numbers for a vertex or normal, found " + std::to_string(count));
  return count;
}

// A corner "v", "v/t", "v//n" or "v/t/n". The indices count from 1, negative ones back from the last; 0 stands for "none".
struct Corner {
  long vertex = 0;
  long normal = 0;
};

bool parse_corner(std::string_view token, Corner& corner) {
  const std::size_t slash = token.find('/');
  if (!parse_integer(token.substr(0, slash), corner.vertex)) return false;
  if (slash == std::string_view::npos) return true;
  const std::size_t second = token.find('/', slash + 1);
  if (second == std::string_view::npos) return true;
  return parse_integer(token.substr(second + 1), corner.normal);
}

std::vector<std::array<std::uint8_t, 3>> to_bytes(const std::vector<std::array<float, 3>>& colors) {
  float largest = 0;
  for (const auto& color : colors) largest = std::max({largest, color[0], color[1], color[2]});
  const double scale = color_scale(Type::kFloat32, static_cast<double>(largest));
  std::vector<std::array<std::uint8_t, 3>> bytes(colors.size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) bytes[i][c] = to_color(static_cast<double>(colors[i][c]), scale);
  }
  return bytes;
}

Cloud read_vertices(const Source& source) {
  Counts counts;
  for_each_statement(source, [&](std::string_view keyword, Tokens&, std::size_t) {
    counts.vertices += keyword == "v" ? 1 : 0;
    counts.normals += keyword == "vn" ? 1 : 0;
  });
  if (counts.vertices == 0) fail(source, "no points: no vertices (v lines) in this OBJ file");
  Cloud cloud;
  cloud.format = "obj";
  cloud.property_names = {"x", "y", "z"};
  cloud.positions.reserve(counts.vertices);
  cloud.normals.reserve(counts.normals);
  std::vector<std::array<float, 3>> colors;
  bool overflow = false;
  bool paired = counts.normals == counts.vertices;
  const Lines end = for_each_statement(source, [&](std::string_view keyword, Tokens& tokens, std::size_t line) {
    double n[8];
    if (keyword == "v") {
      const std::size_t found = parse_numbers(source, line, tokens, n, 8, overflow);
      if (found >= 6 && colors.size() == cloud.positions.size()) {
        if (colors.empty()) colors.reserve(counts.vertices);
        colors.push_back({static_cast<float>(n[3]), static_cast<float>(n[4]), static_cast<float>(n[5])});
      }
      cloud.positions.push_back({n[0], n[1], n[2]});
    } else if (keyword == "vn") {
      parse_numbers(source, line, tokens, n, 3, overflow);
      cloud.normals.push_back({n[0], n[1], n[2]});
    } else if (keyword == "f" && paired) {
      std::string_view token;
      while (tokens.next(token)) {
        Corner corner;
        if (parse_corner(token, corner) && corner.normal != 0 && corner.normal != corner.vertex) paired = false;
      }
    }
  });
  if (!paired) cloud.normals = {};  // a normal per corner is no normal per point
  if (!cloud.normals.empty()) cloud.property_names.insert(cloud.property_names.end(), {"nx", "ny", "nz"});
  if (colors.size() == cloud.positions.size()) {
    cloud.colors = to_bytes(colors);
    cloud.property_names.insert(cloud.property_names.end(), {"red", "green", "blue"});
  }
  if (overflow) cloud.warnings.emplace_back(kOverflow);
  if (!end.ended()) cloud.warnings.emplace_back(kOpenEnd);
  return cloud;
}

}  // namespace

Cloud read_obj(const Source& source) { return read_vertices(source); }

Mesh read_obj_mesh(const Source& source) {
  Cloud cloud = read_vertices(source);
  Mesh mesh;
  mesh.vertices = std::move(cloud.positions);
  mesh.colors = std::move(cloud.colors);
  Fans fans(source, mesh);
  for_each_statement(source, [&](std::string_view keyword, Tokens& tokens, std::size_t) {
    if (keyword != "f") return;
    std::string_view token;
    std::size_t corners = 0;
    while (tokens.next(token)) ++corners;
    fans.count(corners);
  });
  fans.reserve();
  long vertices = 0;  // so far: what negative indices count back from
  for_each_statement(source, [&](std::string_view keyword, Tokens& tokens, std::size_t line) {
    vertices += keyword == "v" ? 1 : 0;
    if (keyword != "f") return;
    fans.begin(line, "line");
    std::string_view token;
    while (tokens.next(token)) {
      Corner corner;
      if (!parse_corner(token, corner))
        fail_at_line(source, line, "expected a face corner (index, index//index, ...), found " + quote(token));
      fans.corner(static_cast<double>(corner.vertex < 0 ? vertices + corner.vertex : corner.vertex - 1));
    }
  });
  return mesh;
}

}  // namespace g3r::io
