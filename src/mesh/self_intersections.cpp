// Candidates from a tree of boxes, each decided by exact signs.
#include "mesh/self_intersections.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "mesh/box_tree.h"
#include "mesh/constants.h"
#include "mesh/exact_orientation.h"
#include "mesh/triangle.h"
#include "mesh/used_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace g3r {
namespace {

using Corners = std::array<Vec3, 3>;

// Segments p q and a b in the plane seen along `axis`; closed.
bool segments_meet(std::size_t axis, const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const int pa = orientation_along(axis, p, q, a), pb = orientation_along(axis, p, q, b);
  const int ap = orientation_along(axis, a, b, p), aq = orientation_along(axis, a, b, q);
  if (pa * pb > 0 || ap * aq > 0) return false;
  if (pa != 0 || pb != 0 || ap != 0 || aq != 0) return true;
  for (const std::size_t k : {(axis + 1) % 3, (axis + 2) % 3}) {
    if (std::max(p[k], q[k]) < std::min(a[k], b[k]) || std::max(a[k], b[k]) < std::min(p[k], q[k])) return false;
  }
  return true;
}

// A segment in the plane of a triangle.
bool coplanar_meet(const Vec3& p, const Vec3& q, const Corners& t) {
  std::size_t axis = 0;
  while (axis < 3 && orientation_along(axis, t[0], t[1], t[2]) == 0) ++axis;
  if (axis == 3) return false;  // no area
  std::array<int, 3> side{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (segments_meet(axis, p, q, t[k], t[(k + 1) % 3])) return true;
    side[k] = orientation_along(axis, t[k], t[(k + 1) % 3], p);
  }
  return side[0] == side[1] && side[1] == side[2];
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Corners& t) {
  const int sp = orientation(t[0], t[1], t[2], p), sq = orientation(t[0], t[1], t[2], q);
  if (sp * sq > 0) return false;
  if (sp == 0 && sq == 0) return coplanar_meet(p, q, t);
  const int ab = orientation(p, q, t[0], t[1]), bc = orientation(p, q, t[1], t[2]), ca = orientation(p, q, t[2], t[0]);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

// Two triangles have a point in common if and only if an edge of one meets the other.
bool triangles_meet(const Corners& s, const Corners& t) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (segment_meets_triangle(s[k], s[(k + 1) % 3], t) || segment_meets_triangle(t[k], t[(k + 1) % 3], s)) return true;
  }
  return false;
}

// Whether a plane across `axis` has s on one side and t on the other, by more than rounding can have moved them.
bool separates(const Vec3& axis, const Corners& s, const Corners& t) {
  double s_most = 0, t_least = std::numeric_limits<double>::infinity(), size = 0;
  const auto along = [&](const Vec3& p) {
    const Vec3 d = vector::subtract(p, s[0]);
    size = std::max(size, std::fabs(axis[0] * d[0]) + std::fabs(axis[1] * d[1]) + std::fabs(axis[2] * d[2]));
    return vector::dot(axis, d);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    s_most = std::max(s_most, along(s[k]));
    t_least = std::min(t_least, along(t[k]));
  }
  return t_least - s_most > mesh::kRounding * size;
}

// Finds most pairs that do not meet, without exact arithmetic: planes parallel to s or through its edges. False where unsure.
bool surely_apart(const Corners& s, const Corners& t) {
  const Vec3 normal = mesh::twice_area_vector(s[0], s[1], s[2]);
  if (separates(normal, s, t) || separates(vector::scale(normal, -1), s, t)) return true;
  for (std::size_t k = 0; k < 3; ++k) {
    if (separates(vector::cross(vector::subtract(s[(k + 1) % 3], s[k]), normal), s, t)) return true;
  }
  return false;
}

bool share_a_corner(const std::array<std::uint32_t, 3>& s, const std::array<std::uint32_t, 3>& t) {
  return std::any_of(s.begin(), s.end(), [&](std::uint32_t v) { return v == t[0] || v == t[1] || v == t[2]; });
}

bool touch_at_a_corner(const Corners& s, const Corners& t) {
  return std::any_of(s.begin(), s.end(), [&](const Vec3& p) { return std::find(t.begin(), t.end(), p) != t.end(); });
}

bool has_no_area(const Corners& t) { return mesh::twice_area_vector(t[0], t[1], t[2]) == Vec3{0, 0, 0}; }

// About `middle`, so that far from the origin boxes are no larger than triangles. Rounding keeps the order of coordinates: the boxes of
// triangles that meet do too.
mesh::FloatBox box_of(const Corners& t, const Vec3& middle) {
  vector::Box exact;
  for (const Vec3& p : t) exact.extend(p);
  mesh::FloatBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = std::nextafter(static_cast<float>(exact.low[k] - middle[k]), -std::numeric_limits<float>::infinity());
    box.high[k] = std::nextafter(static_cast<float>(exact.high[k] - middle[k]), std::numeric_limits<float>::infinity());
  }
  return box;
}

// The corners of the triangles of a mesh, whose vertices lie in `box`, scaled to about 1 by a power of two, which is exact.
class ScaledTriangles {
 public:
  ScaledTriangles(const Mesh& mesh, const vector::Box& box) : triangles_(mesh.triangles), vertices_(mesh.vertices), middle_(box.centre()) {
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) largest = std::max({largest, std::fabs(box.low[k]), std::fabs(box.high[k])});
    const int exponent = -std::ilogb(largest);
    for (Vec3& v : vertices_) {
      for (double& c : v) c = std::ldexp(c, exponent);
    }
    for (double& c : middle_) c = std::ldexp(c, exponent);
  }

  [[nodiscard]] Corners corners(std::size_t f) const {
    const auto& t = triangles_[f];
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  }
  [[nodiscard]] const Vec3& middle() const { return middle_; }

  // Whether two triangles meet that have no corner at the same place.
  [[nodiscard]] bool meet(std::uint32_t f, std::uint32_t g) const {
    if (share_a_corner(triangles_[f], triangles_[g])) return false;
    const Corners mine = corners(f), theirs = corners(g);
    if (surely_apart(mine, theirs) || surely_apart(theirs, mine) || touch_at_a_corner(mine, theirs)) return false;
    return triangles_meet(mine, theirs);
  }

 private:
  const std::vector<std::array<std::uint32_t, 3>>& triangles_;
  std::vector<Vec3> vertices_;
  Vec3 middle_;  // of the box
};

}  // namespace

namespace mesh {

std::vector<TrianglePair> self_intersections(const Mesh& mesh, const std::atomic<bool>* cancel) {
  const vector::Box box = box_of_used_vertices(mesh);
  if (mesh.triangles.empty() || !(box.longest_side() > 0)) return {};
  const ScaledTriangles triangles(mesh, box);
  std::vector<std::uint32_t> with_area;
  std::vector<FloatBox> boxes;
  with_area.reserve(mesh.triangles.size());
  boxes.reserve(mesh.triangles.size());
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const Corners t = triangles.corners(f);
    if (has_no_area(t)) continue;
    with_area.push_back(f);
    boxes.push_back(box_of(t, triangles.middle()));
  }
  const BoxTree tree(std::move(boxes));
  const std::vector<BoxTree::PairJob> jobs = tree.pair_jobs();
  std::vector<std::vector<TrianglePair>> found(jobs.size());
  parallel::for_each(
      jobs.size(),
      [&](std::size_t job) {
        tree.visit_pairs(jobs[job], [&](std::uint32_t i, std::uint32_t j) {
          if (triangles.meet(with_area[i], with_area[j])) found[job].push_back({with_area[i], with_area[j]});
        });
      },
      cancel);
  std::vector<TrianglePair> all;
  for (const std::vector<TrianglePair>& pairs : found) all.insert(all.end(), pairs.begin(), pairs.end());
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace mesh

std::size_t count_self_intersections(const Mesh& mesh) { return mesh::self_intersections(mesh).size(); }

}  // namespace g3r
