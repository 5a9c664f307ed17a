#include "mesh/screened_poisson.h"

#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "mesh/split_nonmanifold.h"

#include <g3r/error.h>
#include <g3r/names.h>

#include <cstdio>
#include <iostream>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <streambuf>
#include <string>
#include <thread>

#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>

namespace g3r {

namespace {

/// p -> (p - centre) / side: all coordinates within +-1/2, whatever the unit and the origin of the input.
struct UnitBox {
  Vec3 centre;
  double side;

  [[nodiscard]] Eigen::Vector3d to_unit(const Vec3& p) const {
    return {(p[0] - centre[0]) / side, (p[1] - centre[1]) / side, (p[2] - centre[2]) / side};
  }
  [[nodiscard]] Vec3 to_world(const Eigen::Vector3d& p) const {
    return {p[0] * side + centre[0], p[1] * side + centre[1], p[2] * side + centre[2]};
  }
};

/// Open3D dereferences null for the inputs refused here.
UnitBox validated_box(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, int depth) {
  if (points.size() != normals.size()) {
    throw InvalidInput("cannot mesh " + std::to_string(points.size()) + " points with " + std::to_string(normals.size()) + " normals");
  }
  if (points.size() < kLeastPoints) throw InvalidInput("meshing needs at least 4 points, got " + std::to_string(points.size()));
  if (depth < kLeastMeshDepth || depth > kMostMeshDepth) {
    throw InvalidInput("the octree depth must be in 4..12, got " + std::to_string(depth));
  }
  vector::Box box;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!vector::is_finite(points[i])) throw InvalidInput("point " + std::to_string(i) + " is not finite");
    if (!vector::is_finite(normals[i])) throw InvalidInput("the normal of point " + std::to_string(i) + " is not finite");
    if (normals[i] == Vec3{0, 0, 0}) throw InvalidInput("the normal of point " + std::to_string(i) + " is zero");
    box.extend(points[i]);
  }
  const double side = box.longest_side();
  if (!(side >= std::numeric_limits<double>::min())) throw InvalidInput("all points to be meshed are at one place");
  if (!std::isfinite(side)) throw InvalidInput("the points to be meshed are too far apart");
  return {box.centre(), side};
}

/// While it lives, what this thread writes to std::cerr vanishes and what other threads write arrives: Open3D's reconstruction prints
/// warnings there that it cannot be told to keep.
class SilentErrorStream : private std::streambuf {
 public:
  SilentErrorStream() : kept_(std::cerr.rdbuf(this)) {}
  ~SilentErrorStream() override { std::cerr.rdbuf(kept_); }
  SilentErrorStream(const SilentErrorStream&) = delete;
  SilentErrorStream& operator=(const SilentErrorStream&) = delete;

 private:
  int overflow(int c) override { return silenced() || c == EOF ? 0 : kept_->sputc(static_cast<char>(c)); }
  std::streamsize xsputn(const char* text, std::streamsize size) override { return silenced() ? size : kept_->sputn(text, size); }
  int sync() override { return silenced() ? 0 : kept_->pubsync(); }
  [[nodiscard]] bool silenced() const { return std::this_thread::get_id() == thread_; }

  std::thread::id thread_ = std::this_thread::get_id();
  std::streambuf* kept_;
};

/// Calls Open3D, which keeps its thread pool in static variables: one call at a time.
std::shared_ptr<open3d::geometry::TriangleMesh> run_open3d(const open3d::geometry::PointCloud& cloud, int depth) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const SilentErrorStream silence;
  try {
    return std::get<0>(open3d::geometry::TriangleMesh::CreateFromPointCloudPoisson(
        cloud, static_cast<std::size_t>(depth), 0, static_cast<float>(kPoissonCube), false, /*n_threads: more are not deterministic*/ 1));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw InvalidInput(std::string("screened Poisson reconstruction failed: ") + error.what());
  }
}

/// Copies the triangles with the vertices that they use, in the order of their first use.
Mesh to_mesh(const open3d::geometry::TriangleMesh& from, const UnitBox& box) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  Mesh mesh;
  std::vector<std::uint32_t> index(from.vertices_.size(), kUnused);
  mesh.vertices.reserve(from.vertices_.size());
  mesh.triangles.reserve(from.triangles_.size());
  for (const Eigen::Vector3i& t : from.triangles_) {
    std::array<std::uint32_t, 3> triangle{};
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(t[k]);
      if (index[v] == kUnused) {
        index[v] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(box.to_world(from.vertices_[v]));
      }
      triangle[static_cast<std::size_t>(k)] = index[v];
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

bool screened_poisson_available() { return true; }
void require_screened_poisson() {}

Mesh screened_poisson(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, int depth) {
  const UnitBox box = validated_box(points, normals, depth);
  open3d::geometry::PointCloud cloud;
  cloud.points_.reserve(points.size());
  cloud.normals_.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 n = vector::normalised(normals[i]);
    cloud.points_.push_back(box.to_unit(points[i]));
    cloud.normals_.emplace_back(n[0], n[1], n[2]);
  }
  // Where the surface touches itself, Open3D lets more than two triangles share an edge.
  Mesh mesh = split_nonmanifold(to_mesh(*run_open3d(cloud, depth), box));
  if (mesh.triangles.empty()) throw InvalidInput("screened Poisson reconstruction found no surface");
  return mesh;
}

}  // namespace g3r
