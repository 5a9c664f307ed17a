// STL, binary and text. Corners with equal coordinates become one vertex: the format repeats every vertex in each of its triangles.
#include "io/readers.h"
#include "io/table.h"
#include "io/text.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace g3r::io {

namespace {

constexpr std::size_t kHeader = 84;    // 80 free bytes and the count
constexpr std::size_t kTriangle = 50;  // normal, three corners, two attribute bytes
constexpr std::size_t kNormal = 12;

std::vector<Vec3> binary_corners(const Source& source) {
  const std::size_t triangles = (source.bytes.size() - kHeader) / kTriangle;  // the size was checked when the format was recognised
  std::vector<Vec3> corners;
  corners.reserve(3 * triangles);
  for (std::size_t t = 0; t < triangles; ++t) {
    const char* corner = source.bytes.data() + kHeader + t * kTriangle + kNormal;
    for (int k = 0; k < 3; ++k, corner += 12) corners.push_back({load<float>(corner), load<float>(corner + 4), load<float>(corner + 8)});
  }
  return corners;
}

std::vector<Vec3> text_corners(const Source& source, std::vector<std::string>& warnings) {
  const auto for_each = [&](const auto& visit) {
    Lines lines(source.bytes);
    std::string_view line;
    bool closed = false;
    while (lines.next_filled(line)) {
      Tokens tokens(line);
      std::string_view keyword;
      tokens.next(keyword);
      closed = keyword == "endsolid";
      if (keyword == "vertex")
        visit(tokens, lines.number());
      else if (keyword != "solid" && keyword != "facet" && keyword != "outer" && keyword != "endloop" && keyword != "endfacet" && !closed) {
        fail_at_line(source, lines.number(),
                     "unknown STL keyword " + quote(keyword) + ": expected solid, facet, outer, vertex, endloop, endfacet or endsolid");
      }
    }
    return closed;
  };
  std::size_t count = 0;
  if (!for_each([&](Tokens&, std::size_t) { ++count; })) fail(source, "truncated: no \"endsolid\" at the end of this STL text");
  if (count % 3 != 0) fail(source, "truncated: " + std::to_string(count) + " vertex lines, not three for each facet");
  std::vector<Vec3> corners;
  corners.reserve(count);
  bool overflow = false;
  for_each([&](Tokens& tokens, std::size_t number) {
    Vec3 corner{};
    std::string_view token;
    for (double& coordinate : corner) {
      if (!tokens.next(token)) fail_at_line(source, number, "expected three numbers after \"vertex\"");
      if (!parse_double(token, coordinate, &overflow)) fail_at_line(source, number, expected_number(token));
    }
    corners.push_back(corner);
  });
  if (overflow) warnings.emplace_back(kOverflow);
  return corners;
}

struct Welded {
  std::vector<Vec3> vertices;            // in the order in which they first appear
  std::vector<std::uint32_t> vertex_of;  // of every corner
};

Welded weld(const Source& source, std::vector<Vec3> corners) {
  if (corners.size() > std::numeric_limits<std::uint32_t>::max()) fail(source, "too many triangles: vertices are counted in 32 bits");
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0U);
  // By the bits of the coordinates (after 0 + x, which makes -0 and 0 one), so that NaN has its place too.
  for (Vec3& corner : corners) {
    for (double& coordinate : corner) coordinate += 0.0;
  }
  const auto compare = [&](std::uint32_t a, std::uint32_t b) { return std::memcmp(&corners[a], &corners[b], sizeof(Vec3)); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const int difference = compare(a, b);
    return difference != 0 ? difference < 0 : a < b;
  });
  Welded welded;
  welded.vertex_of.resize(corners.size());
  std::size_t distinct = 0;
  for (std::size_t i = 0, first = 0; i < order.size(); ++i) {
    if (i == 0 || compare(order[first], order[i]) != 0) {
      first = i;
      ++distinct;
    }
    welded.vertex_of[order[i]] = order[first];  // for now: the first corner at the same place
  }
  welded.vertices.reserve(distinct);
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    if (welded.vertex_of[i] == i) {
      welded.vertices.push_back(corners[i]);
      welded.vertex_of[i] = static_cast<std::uint32_t>(welded.vertices.size() - 1);
    } else {
      welded.vertex_of[i] = welded.vertex_of[welded.vertex_of[i]];
    }
  }
  return welded;
}

Welded read_welded(const Source& source, bool binary, std::vector<std::string>& warnings) {
  return weld(source, binary ? binary_corners(source) : text_corners(source, warnings));
}

}  // namespace

Cloud read_stl(const Source& source, bool binary) {
  Cloud cloud;
  cloud.positions = read_welded(source, binary, cloud.warnings).vertices;
  cloud.format = binary ? "stl binary" : "stl ascii";
  cloud.scalar = binary ? Scalar::kFloat32 : Scalar::kFloat64;
  cloud.property_names = {"x", "y", "z"};
  return cloud;
}

Mesh read_stl_mesh(const Source& source, bool binary) {
  std::vector<std::string> warnings;
  Welded welded = read_welded(source, binary, warnings);
  Mesh mesh;
  mesh.vertices = std::move(welded.vertices);
  mesh.triangles.reserve(welded.vertex_of.size() / 3);
  for (std::size_t i = 0; i + 2 < welded.vertex_of.size(); i += 3) {
    mesh.triangles.push_back({welded.vertex_of[i], welded.vertex_of[i + 1], welded.vertex_of[i + 2]});
  }
  return mesh;
}

}  // namespace g3r::io
