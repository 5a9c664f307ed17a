#include "metrics/triangle_tree.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <limits>

#include "mesh/used_vertices.h"

namespace g3r {

namespace {

using vector::add;
using vector::cross;
using vector::dot;
using vector::scale;
using vector::subtract;

double squared_distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = subtract(b, a);
  const Vec3 ap = subtract(p, a);
  const double length2 = dot(ab, ab);
  const double t = length2 > 0 ? std::clamp(dot(ap, ab) / length2, 0.0, 1.0) : 0.0;
  const Vec3 d = subtract(ap, scale(ab, t));
  return dot(d, d);
}

double squared_distance_to_box(const Vec3& p, const vector::Box& box) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max({box.low[k] - p[k], 0.0, p[k] - box.high[k]});
    sum += d * d;
  }
  return sum;
}

}  // namespace

double squared_distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  // The foot of p on the plane counts if it is inside; otherwise the nearest point is on a side. Slivers, for which the inside test
  // is unsure, are then still right: their inside is next to their sides.
  double best =
      std::min({squared_distance_to_segment(p, a, b), squared_distance_to_segment(p, b, c), squared_distance_to_segment(p, c, a)});
  const Vec3 n = cross(subtract(b, a), subtract(c, a));
  const double n2 = dot(n, n);
  if (n2 > 0) {
    const bool inside = dot(cross(subtract(b, a), subtract(p, a)), n) >= 0 && dot(cross(subtract(c, b), subtract(p, b)), n) >= 0 &&
                        dot(cross(subtract(a, c), subtract(p, c)), n) >= 0;
    const double height = dot(subtract(p, a), n);
    if (inside) best = std::min(best, height * height / n2);
  }
  return best;
}

TriangleTree::TriangleTree(const Mesh& mesh) {
  const vector::Box box = box_of_used_vertices(mesh);
  if (mesh.triangles.empty()) throw InvalidInput("the mesh has no triangles");
  if (!(box.longest_side() > 0)) throw InvalidInput("no triangle of the mesh has an area");
  centre_ = box.centre();
  side_ = box.longest_side();
  normals_.resize(mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto& t = mesh.triangles[f];
    const Vec3 a = to_inside(mesh.vertices[t[0]]), b = to_inside(mesh.vertices[t[1]]), c = to_inside(mesh.vertices[t[2]]);
    normals_[f] = vector::normalised(cross(subtract(b, a), subtract(c, a)));
    if (dot(normals_[f], normals_[f]) > 0) triangles_.push_back({a, b, c, static_cast<std::uint32_t>(f)});
  }
  if (triangles_.empty()) throw InvalidInput("no triangle of the mesh has an area");
  nodes_.reserve(triangles_.size());
  std::vector<Item> items(triangles_.size());
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    const Triangle& t = triangles_[i];
    items[i] = {scale(add(add(t.a, t.b), t.c), 1.0 / 3), i};
  }
  build(items, 0, static_cast<std::uint32_t>(items.size()));
  std::vector<Triangle> ordered;
  ordered.reserve(items.size());
  for (const Item& item : items) ordered.push_back(triangles_[item.triangle]);
  triangles_ = std::move(ordered);
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children come after their parents
    Node& node = nodes_[i];
    if (node.right == 0) {
      for (std::uint32_t t = node.begin; t < node.end; ++t) node.box.extend(box_of(triangles_[t]));
    } else {
      node.box = nodes_[i + 1].box;
      node.box.extend(nodes_[node.right].box);
    }
  }
}

/// Appends the node of items[begin, end), splitting at the median centre along the longest side of the box of centres.
void TriangleTree::build(std::vector<Item>& items, std::uint32_t begin, std::uint32_t end) {
  const auto index = nodes_.size();
  nodes_.emplace_back();
  nodes_[index].begin = begin;
  nodes_[index].end = end;
  if (end - begin <= kLeafSize) return;
  vector::Box centres;
  for (std::uint32_t i = begin; i < end; ++i) centres.extend(items[i].centre);
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (centres.high[k] - centres.low[k] > centres.high[axis] - centres.low[axis]) axis = k;
  }
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end, [&](const Item& s, const Item& t) {
    return s.centre[axis] != t.centre[axis] ? s.centre[axis] < t.centre[axis] : s.triangle < t.triangle;
  });
  build(items, begin, middle);
  nodes_[index].right = static_cast<std::uint32_t>(nodes_.size());
  build(items, middle, end);
}

TriangleTree::Closest TriangleTree::closest(const Vec3& point) const {
  struct Entry {
    double squared_distance;
    std::uint32_t node;
  };
  const Vec3 p = to_inside(point);
  std::array<Entry, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = {squared_distance_to_box(p, nodes_[0].box), 0};
  double best = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = std::numeric_limits<std::uint32_t>::max();
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.squared_distance > best) continue;
    const Node& node = nodes_[entry.node];
    if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const Triangle& t = triangles_[i];
        const double d = squared_distance_to_triangle(p, t.a, t.b, t.c);
        if (d > best || (d == best && t.index > triangle)) continue;
        best = d;
        triangle = t.index;
      }
      continue;
    }
    Entry near{squared_distance_to_box(p, nodes_[entry.node + 1].box), entry.node + 1};
    Entry far{squared_distance_to_box(p, nodes_[node.right].box), node.right};
    if (far.squared_distance < near.squared_distance) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return {std::sqrt(best) * side_, triangle};
}

}  // namespace g3r
