#include "mesh/simplify.h"

#include "mesh/mesh_parts.h"
#include "mesh/used_vertices.h"

#include <cmath>
#include <vector>

#include <meshoptimizer.h>

namespace g3r::mesh {
namespace {

// The targets that are tried, each of more triangles than the one before, until topology stays: each costs a simplification.
constexpr int kAttempts = 5;

// Positions in single precision relative to the box, as meshoptimizer takes them.
std::vector<float> relative_positions(const Mesh& mesh) {
  const vector::Box box = box_of_used_vertices(mesh);
  const Vec3 centre = box.centre();
  double extent = 0;
  for (std::size_t a = 0; a < 3; ++a) extent = std::max(extent, box.high[a] - box.low[a]);
  std::vector<float> out;
  out.reserve(mesh.vertices.size() * 3);
  for (const Vec3& v : mesh.vertices) {
    for (std::size_t a = 0; a < 3; ++a) out.push_back(static_cast<float>(extent > 0 ? (v[a] - centre[a]) / extent : 0));
  }
  return out;
}

bool no_worse(const MeshCheck& now, const MeshCheck& before) {
  return (now.closed || !before.closed) && (now.manifold || !before.manifold) && now.components == before.components &&
         now.genus == before.genus;
}

}  // namespace

void simplify(Mesh& mesh, std::size_t faces) {
  if (mesh.triangles.size() <= faces) return;
  const MeshCheck before = check_mesh(mesh);
  const std::vector<float> positions = relative_positions(mesh);
  const unsigned int* indices = mesh.triangles.front().data();
  const std::size_t index_count = mesh.triangles.size() * 3;
  const double ratio = static_cast<double>(faces) / static_cast<double>(mesh.triangles.size());
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    // The error allowed is all of the extent of the mesh, so that the number of triangles alone decides.
    const double share = std::pow(ratio, 1 - static_cast<double>(attempt) / kAttempts);
    const std::size_t target = static_cast<std::size_t>(share * static_cast<double>(mesh.triangles.size())) * 3;
    std::vector<unsigned int> out(index_count);
    out.resize(meshopt_simplify(out.data(), indices, index_count, positions.data(), mesh.vertices.size(), 3 * sizeof(float), target, 1.0F,
                                0, nullptr));
    Mesh candidate = mesh;
    candidate.triangles.resize(out.size() / 3);
    for (std::size_t i = 0; i < out.size(); ++i) candidate.triangles[i / 3][i % 3] = out[i];
    if (candidate.triangles.empty() || !no_worse(check_mesh(candidate), before)) continue;
    mesh = std::move(candidate);
    drop_unused_vertices(mesh);
    return;
  }
}

}  // namespace g3r::mesh
