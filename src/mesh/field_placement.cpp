#include "mesh/field_placement.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "cpu/parallel.h"

namespace g3r::mesh {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kTrust = 3.0;       // spacings: with no point nearer than this the fit says nothing and the field alone decides
constexpr double kReach = 0.3;       // cells that a vertex may leave its leaf by
constexpr double kShift = 0.1;      // smallest cells, along every axis, of the boxes that share the creases between leaves
constexpr double kOnSurface = 0.05;  // spacings: a point on a crease must also lie on the joined surface
constexpr double kMinSine = 0.3;     // sheets at less than about 17 degrees have no well placed intersection
constexpr int kNewtonSteps = 5;

Vec3 array(const Vector3d& p) { return {p[0], p[1], p[2]}; }

// Nearest common zero of the given sheets, by Newton steps of least length. False if they are nearly parallel.
bool intersect(const LocalSurface& s, std::initializer_list<int> which, Vector3d& x) {
  for (int step = 0; step < kNewtonSteps; ++step) {
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> j(static_cast<Eigen::Index>(which.size()), 3);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> f(static_cast<Eigen::Index>(which.size()));
    Eigen::Index row = 0;
    for (const int k : which) {
      Vector3d g;
      f[row] = s.sheet[static_cast<std::size_t>(k)].distance(x, &g);
      j.row(row++) = g;
    }
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> gram = j * j.transpose();
    if (gram.determinant() < kMinSine * kMinSine * (which.size() == 3 ? 0.3 : 1.0)) return false;
    const Vector3d dx = j.transpose() * gram.fullPivLu().solve(f);
    x -= dx;
    if (dx.squaredNorm() < 1e-16 * s.spacing * s.spacing) break;
  }
  return x.allFinite();
}

class Placer {
 public:
  /// A crease belongs to the leaves it passes through, each piece to one: two vertices at one place would make triangles without area. The
  /// boxes are shifted by the same for all leaves, because creases of CAD models like to run exactly between leaves.
  Placer(const LocalSurface& surface, const AlignedBox3d& leaf, double shift) : s_(surface), box_(leaf) {
    box_.translate(Vector3d::Constant(-shift));
  }

  // A corner or the middle of the crease within the leaf.
  bool feature(const Vector3d& start, Vector3d& x) const {
    if (s_.count == 3) {
      x = start;
      if (intersect(s_, {0, 1, 2}, x) && box_.contains(x) && on_surface(x)) return true;
    }
    constexpr std::array<std::array<int, 2>, 3> kPairs{{{0, 1}, {0, 2}, {1, 2}}};
    bool found = false;
    double best = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = kPairs[k];
      if (b >= s_.count || s_.joint[k] == Joint::kNone) continue;
      Vector3d y = start;
      if (!intersect(s_, {a, b}, y) || !centre_in_box(a, b, y) || !on_surface(y)) continue;
      const double d = (y - start).squaredNorm();
      if (found && d >= best) continue;
      found = true;
      best = d;
      x = y;
    }
    return found;
  }

  Vector3d smooth(Vector3d x) const {
    for (int step = 0; step < kNewtonSteps; ++step) {
      int active = 0;
      s_.distance(x, &active);
      Vector3d g;
      const double f = s_.sheet[static_cast<std::size_t>(active)].distance(x, &g);
      x -= f * g;
      if (std::abs(f) < 1e-8 * s_.spacing) break;
    }
    return x;
  }

 private:
  bool on_surface(const Vector3d& x) const { return std::abs(s_.distance(x)) < kOnSurface * s_.spacing; }

  // Slides a point of the crease of sheets a and b to the middle of the part within the box; false if no part is.
  bool centre_in_box(int a, int b, Vector3d& x) const {
    Vector3d ga, gb;
    s_.sheet[static_cast<std::size_t>(a)].distance(x, &ga);
    s_.sheet[static_cast<std::size_t>(b)].distance(x, &gb);
    const Vector3d t = ga.cross(gb).normalized();
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (int k = 0; k < 3; ++k) {
      if (std::abs(t[k]) < 1e-9) {
        if (x[k] < box_.min()[k] || x[k] > box_.max()[k]) return false;
        continue;
      }
      const double p = (box_.min()[k] - x[k]) / t[k], q = (box_.max()[k] - x[k]) / t[k];
      low = std::max(low, std::min(p, q));
      high = std::min(high, std::max(p, q));
    }
    if (low >= high) return false;
    x += 0.5 * (low + high) * t;
    return intersect(s_, {a, b}, x) && box_.contains(x);
  }

  const LocalSurface& s_;
  AlignedBox3d box_;
};

}  // namespace

PlacedVertices place_vertices(const Octree& octree, const DualSurface& surface, const std::vector<double>& value, const LocalFit& local,
                              const std::atomic<bool>* cancel) {
  PlacedVertices out;
  const std::size_t sheets = surface.patch_count();
  const double shift = kShift * octree.unit() * static_cast<double>(std::uint32_t{1} << (kMaxOctreeLevel - octree.depth()));
  out.positions.resize(sheets + surface.midpoints.size());
  out.normals.resize(sheets);
  parallel::for_blocks(
      sheets, 256,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          Vector3d start = Vector3d::Zero(), outward = Vector3d::Zero();
          for (std::size_t k = surface.patch_begin[i]; k < surface.patch_begin[i + 1]; ++k) {
            const Crossing& c = surface.crossings[surface.patch_crossings[k]];
            const Vector3d a = to_eigen(octree.corner_position(c.inside)), b = to_eigen(octree.corner_position(c.outside));
            const double va = std::max(value[c.inside], 0.0), vb = std::max(-value[c.outside], 0.0);
            const double t = va + vb > 0 ? std::clamp(va / (va + vb), 0.01, 0.99) : 0.5;
            start += a + t * (b - a);
            outward += (b - a).normalized();
          }
          start /= static_cast<double>(surface.patch_begin[i + 1] - surface.patch_begin[i]);
          const double length = outward.norm();
          if (length > 0) outward /= length;
          const OctreeNode& leaf = octree.nodes()[octree.leaf_nodes()[surface.patch_leaf[i]]];
          const Vector3d low = to_eigen(octree.world(leaf.low[0], leaf.low[1], leaf.low[2]));
          const double cell = octree.unit() * octree.extent(leaf);
          const AlignedBox3d box(low, low + Vector3d::Constant(cell));

          Vector3d x = start, normal = outward;
          const LocalSurface fit = local.fit(start, kTrust, length > 0 ? &outward : nullptr);
          if (fit.count > 0) {
            const Placer placer(fit, box, shift);
            if (!placer.feature(start, x)) x = placer.smooth(start);
            const AlignedBox3d reach(box.min().array() - kReach * cell, box.max().array() + kReach * cell);
            if (!x.allFinite()) x = start;
            x = x.cwiseMax(reach.min()).cwiseMin(reach.max());
            int active = 0;
            fit.distance(x, &active);
            fit.sheet[static_cast<std::size_t>(active)].distance(x, &normal);
          }
          out.positions[i] = array(x);
          out.normals[i] = array(normal);
        }
      },
      cancel);
  for (std::size_t m = 0; m < surface.midpoints.size(); ++m) {
    const Vector3d a = to_eigen(out.positions[surface.midpoints[m][0]]), b = to_eigen(out.positions[surface.midpoints[m][1]]);
    out.positions[sheets + m] = array(0.5 * (a + b));
  }
  return out;
}

}  // namespace g3r::mesh
