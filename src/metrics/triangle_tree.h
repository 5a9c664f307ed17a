// Closest point on a triangle mesh, exactly, through a bounding-volume hierarchy.
#pragma once

#include <g3r/mesh.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/vector.h"

namespace g3r {

/// The triangles of a mesh in a tree of boxes. Building costs O(F log F), a query O(log F) when the point is near the surface.
/// Triangles without area are left out: they have no normal, and in a closed mesh their points belong to their neighbours.
class TriangleTree {
 public:
  struct Closest {
    double distance = 0;         ///< in mesh units
    std::uint32_t triangle = 0;  ///< index into mesh.triangles; the lowest of those at exactly the same distance
  };

  /// Copies what it needs of the mesh. Throws InvalidInput like check_mesh(), and if no triangle has an area.
  explicit TriangleTree(const Mesh& mesh);

  /// The triangle nearest to p, and how far it is. p must be finite.
  [[nodiscard]] Closest closest(const Vec3& p) const;

  /// Unit normal of a triangle that closest() returned.
  [[nodiscard]] Vec3 normal(std::uint32_t triangle) const { return normals_[triangle]; }

 private:
  // Deeper than any tree over 2^32 triangles that is halved at every level.
  static constexpr std::size_t kMaxDepth = 64;

  struct Triangle {
    Vec3 a, b, c;
    std::uint32_t index;
  };
  struct Node {
    vector::Box box;
    std::uint32_t begin = 0, end = 0;  ///< triangles of a leaf
    std::uint32_t right = 0;           ///< second child, 0 for a leaf; the first child is the next node
  };

  [[nodiscard]] Vec3 to_inside(const Vec3& p) const { return vector::scale(vector::subtract(p, centre_), 1 / side_); }
  // Below this many triangles testing all of them is quicker than descending.
  static constexpr std::uint32_t kLeafSize = 4;

  // A triangle while the tree is built.
  struct Item {
    Vec3 centre;
    std::uint32_t triangle;
  };
  void build(std::vector<Item>& items, std::uint32_t begin, std::uint32_t end);
  [[nodiscard]] static vector::Box box_of(const Triangle& t) {
    vector::Box box;
    for (const Vec3& p : {t.a, t.b, t.c}) box.extend(p);
    return box;
  }

  // Coordinates inside are (p - centre_) / side_, in units of the longest side of the box: no product overflows or vanishes.
  Vec3 centre_{0, 0, 0};
  double side_ = 1;
  std::vector<Triangle> triangles_;
  std::vector<Vec3> normals_;
  std::vector<Node> nodes_;
};

/// Squared distance between p and the triangle a, b, c (which may be degenerate).
[[nodiscard]] double squared_distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace g3r
