#include <g3r/mesh_points.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <nanoflann.hpp>
#include <string>

#include "cpu/parallel.h"

namespace g3r {
namespace {

constexpr std::size_t kBlock = 1024;  // vertices per task; large enough to hide the cost of a task

/// Nearest finite point, by a k-d tree.
class NearestPoint {
 public:
  explicit NearestPoint(const PointsView& points) : tree_(3, set_, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3 p = points[i];
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
      set_.points.push_back(p);
      index_.push_back(i);
    }
    if (index_.empty()) throw InvalidInput("there is no finite point to compare the mesh with");
    tree_.buildIndex();
  }

  struct Hit {
    std::size_t point = 0;
    double distance = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] Hit operator()(const Vec3& query) const {
    std::uint32_t found = 0;
    double squared = std::numeric_limits<double>::infinity();
    tree_.knnSearch(query.data(), 1, &found, &squared);
    return {index_[found], std::sqrt(squared)};
  }

 private:
  struct Set {
    std::vector<Vec3> points;
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t k) const { return points[i][k]; }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const {
      return false;
    }
  };
  Set set_;
  std::vector<std::size_t> index_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Set>, Set, 3> tree_;
};

template <class T>
std::vector<T> carry(const Mesh& mesh, const PointsView& points, const std::vector<T>& values, const char* what) {
  if (values.size() != points.count) {
    throw InvalidInput(std::string(what) + ": " + std::to_string(values.size()) + " values for " + std::to_string(points.count) +
                       " points");
  }
  const NearestPoint nearest(points);
  std::vector<T> out(mesh.vertices.size());
  parallel::for_blocks(out.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) out[v] = values[nearest(mesh.vertices[v]).point];
  });
  return out;
}

}  // namespace

std::vector<std::array<std::uint8_t, 3>> carry_colors(const Mesh& mesh, const PointsView& points,
                                                      const std::vector<std::array<std::uint8_t, 3>>& colors) {
  return carry(mesh, points, colors, "colours");
}

std::vector<float> carry_confidence(const Mesh& mesh, const PointsView& points, const std::vector<float>& confidence) {
  return carry(mesh, points, confidence, "confidence");
}

Mesh trim_mesh(const Mesh& mesh, const PointsView& points, double distance) {
  if (!(distance > 0)) throw InvalidInput("the trim distance must be above 0");
  const NearestPoint nearest(points);
  std::vector<char> near(mesh.vertices.size());
  parallel::for_blocks(near.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) near[v] = nearest(mesh.vertices[v]).distance <= distance ? 1 : 0;
  });

  Mesh kept;
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (v >= near.size()) throw InvalidInput("a triangle names vertex " + std::to_string(v) + " of " + std::to_string(near.size()));
    }
    if (near[t[0]] == 0 || near[t[1]] == 0 || near[t[2]] == 0) continue;
    kept.triangles.push_back(t);
    for (const std::uint32_t v : t) used[v] = 1;
  }
  if (kept.triangles.empty()) throw InvalidInput("trimming leaves nothing of the mesh: no triangle is within the distance of the points");

  std::vector<std::uint32_t> renamed(mesh.vertices.size(), 0);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (used[v] == 0) continue;
    renamed[v] = static_cast<std::uint32_t>(kept.vertices.size());
    kept.vertices.push_back(mesh.vertices[v]);
    if (!mesh.colors.empty()) kept.colors.push_back(mesh.colors[v]);
    if (!mesh.confidence.empty()) kept.confidence.push_back(mesh.confidence[v]);
  }
  for (auto& t : kept.triangles) t = {renamed[t[0]], renamed[t[1]], renamed[t[2]]};
  return kept;
}

}  // namespace g3r
