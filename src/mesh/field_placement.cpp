#include "mesh/field_placement.h"

#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace g3r::mesh {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// Steps towards a surface or an intersection: each squares the error, but where patches bend. With three, a thin plate has 1.5 % more CD.
constexpr int kNewtonSteps = 5;

Vec3 array(const Vector3d& p) { return {p[0], p[1], p[2]}; }

// Nearest common zero of the given patches, by Newton steps of least length. False if they are nearly parallel.
bool intersect(const LocalSurface& s, std::initializer_list<int> which, Vector3d& x) {
  for (int step = 0; step < kNewtonSteps; ++step) {
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> j(static_cast<Eigen::Index>(which.size()), 3);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> f(static_cast<Eigen::Index>(which.size()));
    Eigen::Index row = 0;
    for (const int k : which) {
      Vector3d g;
      f[row] = s.patch[static_cast<std::size_t>(k)].distance(x, &g);
      j.row(row++) = g;
    }
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> gram = j * j.transpose();
    // The squared area or volume that the normals span: the intersection of nearly parallel patches is too far off to be one.
    if (gram.determinant() < std::pow(kSlant, which.size())) return false;
    x -= j.transpose() * gram.fullPivLu().solve(f);
  }
  return x.allFinite();
}

// What a vertex is on.
enum class Feature : std::uint8_t { kNone, kCrease, kCorner };

struct OnFeature {
  Feature feature = Feature::kNone;
  double moved = 0;  // from where the field alone puts it; fits are made there
};
struct Placed {
  Vec3 position{0, 0, 0};
  Vec3 normal{0, 0, 0};
  OnFeature on_feature;
};

class Placer {
 public:
  Placer(const LocalSurface& surface, const AlignedBox3d& box) : s_(surface), box_(box) {}

  // A corner or the middle of the crease within the leaf.
  Feature feature(const Vector3d& start, Vector3d& x) const {
    const double cell = box_.sizes()[0];
    const AlignedBox3d reach(box_.min().array() - kAtOnePlace * cell, box_.max().array() + kAtOnePlace * cell);
    if (s_.count == kMostPatches) {
      x = start;
      if (intersect(s_, {0, 1, 2}, x) && reach.contains(x) && on_surface(x)) return Feature::kCorner;
    }
    double best = std::numeric_limits<double>::infinity();
    for (int b = 1; b < s_.count; ++b) {
      for (int a = 0; a < b; ++a) {
        if (s_.joint[static_cast<std::size_t>(a + b - 1)] == Joint::kNone) continue;
        Vector3d y = start;
        if (!intersect(s_, {a, b}, y) || !centre_in_box(a, b, reach, y) || !on_surface(y)) continue;
        const double d = (y - start).squaredNorm();
        if (d >= best) continue;
        best = d;
        x = y;
      }
    }
    return std::isfinite(best) ? Feature::kCrease : Feature::kNone;
  }

  Vector3d smooth(Vector3d x) const {
    for (int step = 0; step < kNewtonSteps; ++step) {
      int active = 0;
      s_.distance(x, &active);
      Vector3d g;
      const double f = s_.patch[static_cast<std::size_t>(active)].distance(x, &g);
      x -= f * g;
    }
    return x;
  }

 private:
  bool on_surface(const Vector3d& x) const { return std::abs(s_.distance(x)) < kAtOnePlace * s_.spacing; }

  // Slides a point of the crease of patches a and b to the middle of the part within the box; false if no part is.
  bool centre_in_box(int a, int b, const AlignedBox3d& reach, Vector3d& x) const {
    Vector3d ga, gb;
    s_.patch[static_cast<std::size_t>(a)].distance(x, &ga);
    s_.patch[static_cast<std::size_t>(b)].distance(x, &gb);
    const Vector3d t = ga.cross(gb).normalized();
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (int k = 0; k < 3; ++k) {
      // Infinite where the crease runs across this axis: all of it is between the two sides then, or nothing.
      const double p = (reach.min()[k] - x[k]) / t[k], q = (reach.max()[k] - x[k]) / t[k];
      low = std::max(low, std::min(p, q));
      high = std::min(high, std::max(p, q));
    }
    if (low >= high) return false;
    x += 0.5 * (low + high) * t;
    return intersect(s_, {a, b}, x) && reach.contains(x);
  }

  const LocalSurface& s_;
  const AlignedBox3d& box_;
};

// Where the dual surface's vertices go, one by one.
class Placement {
 public:
  Placement(const Octree& octree, const DualSurface& surface, const std::vector<float>& value, const LocalFit& local)
      : octree_(octree), surface_(surface), value_(value), local_(local) {}

  // The i-th patch's vertex; on a crease or corner only with `features`.
  [[nodiscard]] Placed place(std::size_t i, bool features) const {
    Vector3d start = Vector3d::Zero(), outward = Vector3d::Zero();
    for (std::size_t k = surface_.patch_begin[i]; k < surface_.patch_begin[i + 1]; ++k) {
      const Crossing& c = surface_.crossings[surface_.patch_crossings[k]];
      start += crossing_point(c);
      outward += (to_eigen(octree_.corner_position(c.outside)) - to_eigen(octree_.corner_position(c.inside))).normalized();
    }
    start /= static_cast<double>(surface_.patch_begin[i + 1] - surface_.patch_begin[i]);
    const double length = outward.norm();
    if (length > 0) outward /= length;
    const OctreeNode leaf = octree_.leaf(surface_.patch_leaf[i]);
    const Vector3d low = to_eigen(octree_.world(leaf.low[0], leaf.low[1], leaf.low[2]));
    const double cell = octree_.unit() * octree_.extent(leaf);
    const AlignedBox3d box(low, low + Vector3d::Constant(cell));

    Vector3d x = start, normal = outward;
    Feature feature = Feature::kNone;
    const LocalSurface fit = local_.fit(start, kFarSpacings, length > 0 ? &outward : nullptr);
    if (fit.count > 0) {
      const Placer placer(fit, box);
      if (features) feature = placer.feature(start, x);
      if (feature == Feature::kNone) x = placer.smooth(start);
      // A vertex may leave its leaf as far as surface curves: farther, triangles fold over each other.
      const AlignedBox3d reach(box.min().array() - kDiscHalf * cell, box.max().array() + kDiscHalf * cell);
      if (!x.allFinite()) x = start;
      x = x.cwiseMax(reach.min()).cwiseMin(reach.max());
      int active = 0;
      fit.distance(x, &active);
      fit.patch[static_cast<std::size_t>(active)].distance(x, &normal);
    }
    return {array(x), array(normal), {feature, (x - start).norm()}};
  }

  // In the middle of the line between the ends of its arc. Arcs of one face do not cross, so no two of them share it, as they share the
  // middle between their patches.
  [[nodiscard]] Vec3 place(const ArcMiddle& middle) const {
    const std::vector<Crossing>& crossings = surface_.crossings;
    return array(0.5 * (crossing_point(crossings[middle.crossings[0]]) + crossing_point(crossings[middle.crossings[1]])));
  }

 private:
  // Where the surface passes between the two corners, never at one of them.
  [[nodiscard]] Vector3d crossing_point(const Crossing& c) const {
    const Vector3d a = to_eigen(octree_.corner_position(c.inside)), b = to_eigen(octree_.corner_position(c.outside));
    const double va = std::max(static_cast<double>(value_[c.inside]), 0.0), vb = std::max(-static_cast<double>(value_[c.outside]), 0.0);
    const double t = va + vb > 0 ? std::clamp(va / (va + vb), kAtOnePlace, 1 - kAtOnePlace) : 0.5;
    return a + t * (b - a);
  }

  const Octree& octree_;
  const DualSurface& surface_;
  const std::vector<float>& value_;
  const LocalFit& local_;
};

// Leaves reach a little beyond their boxes for features, so that none between two of them, where CAD models like to have them, is missed.
// If several take the same place their vertices coincide, and triangles have no area. Of such vertices all but one, a corner if there is
// any, then the one that moved least: those that have to step aside, ascending.
std::vector<std::uint32_t> taken_twice(const std::vector<Vec3>& position, const std::vector<OnFeature>& placed, double apart) {
  std::vector<std::uint32_t> on_feature;
  std::vector<Vec3> positions;
  for (std::uint32_t i = 0; i < placed.size(); ++i) {
    if (placed[i].feature == Feature::kNone) continue;
    on_feature.push_back(i);
    positions.push_back(position[i]);
  }
  if (positions.empty()) return {};
  const Neighbours neighbours(positions);
  const auto better = [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(placed[b].feature, placed[a].moved, a) < std::tuple(placed[a].feature, placed[b].moved, b);
  };
  std::vector<std::uint32_t> losers, close;
  for (const std::uint32_t i : on_feature) {
    neighbours.within(position[i], apart, close);
    const auto yields_to = [&](std::uint32_t k) { return on_feature[k] != i && !better(i, on_feature[k]); };
    if (std::any_of(close.begin(), close.end(), yields_to)) losers.push_back(i);
  }
  return losers;
}

}  // namespace

PlacedVertices place_vertices(const Octree& octree, const DualSurface& surface, const std::vector<float>& value, const LocalFit& local,
                              const std::atomic<bool>* cancel, const std::vector<std::uint8_t>& wanted) {
  const std::size_t patches = surface.patch_count();
  const Placement placement(octree, surface, value, local);
  PlacedVertices out;
  out.positions.resize(patches + surface.midpoints.size());
  out.normals.resize(patches);
  std::vector<OnFeature> on_feature(patches);
  parallel::for_blocks(
      patches, parallel::kSmallBlock,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          if (!wanted.empty() && wanted[i] == 0) continue;
          const Placed placed = placement.place(i, true);
          out.positions[i] = placed.position;
          out.normals[i] = placed.normal;
          on_feature[i] = placed.on_feature;
        }
      },
      cancel);
  const double smallest = octree.unit() * static_cast<double>(std::uint32_t{1} << (kMaxOctreeLevel - octree.depth()));
  for (const std::uint32_t i : taken_twice(out.positions, on_feature, kAtOnePlace * smallest)) {
    const Placed beside = placement.place(i, false);
    out.positions[i] = array(0.5 * (to_eigen(out.positions[i]) + to_eigen(beside.position)));
    out.normals[i] = beside.normal;
  }
  for (std::size_t m = 0; m < surface.midpoints.size(); ++m) out.positions[patches + m] = placement.place(surface.midpoints[m]);
  return out;
}

}  // namespace g3r::mesh
