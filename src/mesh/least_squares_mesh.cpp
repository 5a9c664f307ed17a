#include "mesh/least_squares_mesh.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "mesh/counted_lists.h"
#include "mesh/half_edges.h"

#include <g3r/error.h>

#include <algorithm>
#include <cmath>

namespace g3r::mesh {
namespace {

using vector::add;
using vector::dot;
using vector::scale;
using vector::subtract;

// The steps of conjugate gradients at most, and the share of the first residual that is enough: what is left moves no vertex visibly.
constexpr int kGradientSteps = 300;
constexpr double kResidualShare = 1e-4;

double product(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return parallel::sum_blocks(a.size(), parallel::kSmallBlock, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += dot(a[i], b[i]);
    return sum;
  });
}

}  // namespace

VertexRings vertex_rings(const Mesh& mesh) {
  VertexRings rings;
  const auto for_each_neighbour = [&](const auto& use) {
    for_each_edge(mesh, [&](const HalfEdge* half_edges, std::size_t) {
      use(half_edges->low, half_edges->high);
      use(half_edges->high, half_edges->low);
    });
  };
  fill_lists(mesh.vertices.size(), for_each_neighbour, rings.begin, rings.vertex);
  return rings;
}

LeastSquaresMesh::LeastSquaresMesh(const VertexRings& rings, const std::vector<std::uint8_t>& free)
    : rings_(rings), free_(free), counts_(free.size(), 0), inverse_(free.size(), 0) {
  const auto is_free = [&](std::uint32_t v) { return free[v] != 0; };
  for (std::uint32_t v = 0; v < free.size(); ++v) {
    const auto ring = rings.of(v);
    counts_[v] = is_free(v) || std::any_of(ring.begin(), ring.end(), is_free) ? 1 : 0;
    inverse_[v] = 1 / static_cast<double>(std::max<std::size_t>(1, ring.size()));
  }
}

Vec3 LeastSquaresMesh::laplacian(const std::vector<Vec3>& at, std::size_t v) const {
  Vec3 sum{0, 0, 0};
  for (const std::uint32_t other : rings_.of(v)) sum = add(sum, at[other]);
  return subtract(at[v], scale(sum, inverse_[v]));
}

// Half the gradient of the energy, 0 at the vertices that stay; without the places of the anchors, of which it is affine, its linear part.
void LeastSquaresMesh::gradient(const std::vector<Vec3>& at, const std::vector<Anchor>& anchors, bool is_affine, std::vector<Vec3>& out) {
  const std::size_t n = at.size();
  shares_.resize(n, Vec3{0, 0, 0});
  out.resize(n, Vec3{0, 0, 0});
  parallel::for_blocks(n, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (counts_[v] != 0) shares_[v] = scale(laplacian(at, v), inverse_[v]);
    }
  });
  parallel::for_blocks(n, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (free_[v] == 0) continue;
      const auto ring = rings_.of(v);
      out[v] = scale(shares_[v], static_cast<double>(ring.size()));
      for (const std::uint32_t other : ring) out[v] = subtract(out[v], shares_[other]);
    }
  });
  // The distance of a point from the surface weighs half as much as the Laplacian of a vertex: less smooths, and leaves the points.
  for (const Anchor& anchor : anchors) {
    Vec3 miss = is_affine ? scale(anchor.point, -1) : Vec3{0, 0, 0};
    for (std::size_t k = 0; k < anchor.vertex.size(); ++k) miss = add(miss, scale(at[anchor.vertex[k]], anchor.weight[k]));
    for (std::size_t k = 0; k < anchor.vertex.size(); ++k) {
      const std::uint32_t v = anchor.vertex[k];
      if (free_[v] != 0) out[v] = add(out[v], scale(miss, 0.5 * anchor.weight[k]));
    }
  }
}

void LeastSquaresMesh::minimise(const std::vector<Anchor>& anchors, std::vector<Vec3>& at, std::optional<double>& enough,
                                const std::atomic<bool>* cancel) {
  std::vector<Vec3> residual, image;
  gradient(at, anchors, true, residual);
  for (Vec3& r : residual) r = scale(r, -1);
  std::vector<Vec3> direction = residual;
  double squared = product(residual, residual);
  if (!enough) enough = kResidualShare * kResidualShare * squared;
  for (int step = 0; step < kGradientSteps && squared > *enough; ++step) {
    if (cancel != nullptr && cancel->load()) throw Cancelled();
    gradient(direction, anchors, false, image);
    const double alpha = squared / product(direction, image);
    if (!std::isfinite(alpha)) return;
    parallel::for_all(at.size(), [&](std::size_t v) {
      at[v] = add(at[v], scale(direction[v], alpha));
      residual[v] = subtract(residual[v], scale(image[v], alpha));
    });
    const double now = product(residual, residual);
    parallel::for_all(at.size(), [&](std::size_t v) { direction[v] = add(residual[v], scale(direction[v], now / squared)); });
    squared = now;
  }
}

}  // namespace g3r::mesh
