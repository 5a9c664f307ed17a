// Uniform sampling of a mesh by area.
#include <g3r/error.h>
#include <g3r/metrics.h>

#include <algorithm>

#include "base/vector.h"
#include "mesh/used_vertices.h"
#include "metrics/random.h"

namespace g3r {

namespace {

// Streams of the seed: positions do not change when noise is added.
constexpr std::uint64_t kPositionStream = 0;
constexpr std::uint64_t kNoiseStream = 1;

constexpr std::size_t kAskEvery = 65536;  // Samples between two looks at whether to go on: a few milliseconds.

using vector::add;
using vector::cross;
using vector::dot;
using vector::scale;
using vector::subtract;

void ask(const Monitor& monitor, std::size_t done, std::size_t count) {
  if (monitor.cancel != nullptr && monitor.cancel->load(std::memory_order_relaxed)) throw Cancelled();
  if (monitor.progress && !monitor.progress("sample", static_cast<double>(done) / static_cast<double>(count))) throw Cancelled();
}

}  // namespace

Samples sample_mesh(const Mesh& mesh, std::size_t count, std::uint64_t seed, double noise, const Monitor& monitor) {
  if (!(noise >= 0) || !std::isfinite(noise)) throw InvalidInput("the noise of a sample must be finite and not negative");
  const vector::Box box = box_of_used_vertices(mesh);
  if (mesh.triangles.empty()) throw InvalidInput("a mesh without triangles cannot be sampled");

  // Normals scaled by area, in units of the box: the squares of tiny lengths would vanish.
  const double side = box.longest_side();
  const auto area_vector = [&](const std::array<std::uint32_t, 3>& t) {
    const Vec3 a = mesh.vertices[t[0]];
    return cross(scale(subtract(mesh.vertices[t[1]], a), 1 / side), scale(subtract(mesh.vertices[t[2]], a), 1 / side));
  };
  std::vector<double> area_up_to(mesh.triangles.size());
  double total = 0;
  for (std::size_t f = 0; f < mesh.triangles.size() && side > 0; ++f) {
    const Vec3 n = area_vector(mesh.triangles[f]);
    area_up_to[f] = total += std::sqrt(dot(n, n));
  }
  if (!(total > 0)) throw InvalidInput("a mesh without area cannot be sampled");

  Samples samples;
  samples.points.reserve(count);
  samples.normals.reserve(count);
  Random position(seed, kPositionStream);
  Random displacement(seed, kNoiseStream);
  for (std::size_t i = 0; i < count; ++i) {
    if (i % kAskEvery == 0) ask(monitor, i, count);
    // The first sum above the drawn value belongs to a triangle with an area.
    const auto drawn = std::upper_bound(area_up_to.begin(), area_up_to.end(), position.uniform() * total) - area_up_to.begin();
    const auto& t = mesh.triangles[std::min(static_cast<std::size_t>(drawn), mesh.triangles.size() - 1)];
    double u = position.uniform(), v = position.uniform();
    if (u + v > 1) {  // the other half of the parallelogram, folded back
      u = 1 - u;
      v = 1 - v;
    }
    const Vec3 a = mesh.vertices[t[0]];
    Vec3 p = add(a, add(scale(subtract(mesh.vertices[t[1]], a), u), scale(subtract(mesh.vertices[t[2]], a), v)));
    if (noise > 0) {
      for (double& x : p) x += noise * displacement.normal();
    }
    samples.points.push_back(p);
    samples.normals.push_back(vector::normalised(area_vector(t)));
  }
  return samples;
}

}  // namespace g3r
