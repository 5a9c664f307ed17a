#include "mesh/field_local_fit.h"

#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace g3r::mesh {
namespace {

using Eigen::Vector3d;

// Weights are about exp(-t) for t up to this and 0 beyond; it is a power of two, for bell().
constexpr double kFaint = 16;
// The share of the distances of a patch's points from another patch, less those on the other side, from which it lies on one side of it:
// three quarters of them. A patch that goes on on both sides of another does not surely end there; 0.8 gives the same genus.
constexpr double kOneSide = 0.5;
// Spacings from all tangent planes from which curvature cannot change the side of a place, so that nothing is fitted: half of the time.
constexpr double kClear = 0.2;
// A factor larger than what rounding can make of a squared distance: without it the search might miss a point as near.
constexpr double kWider = 1 + kRounding;
// The share of one patch's squared misfit that several ones may leave at most: a crease of a CAD model passes, undersampled detail does not
// (without, the dragon's AE_m is 1.05 instead of 0.88, docs/evidence/meshes.md).
constexpr double kSplitGain = 0.05;

using Member = FitPoint;
// The patch of a member that none has taken yet, and of one that makes no patch with those like it.
enum : int { kUnassigned = -1, kLeftOut = -2 };

// About exp(-t), 0 at kFaint.
double bell(double t) {
  const double a = 1 - t / kFaint, a2 = a * a, a4 = a2 * a2, a8 = a4 * a4;
  return a8 * a8;
}

// Squared misfit of a member to a patch, positions and slopes weighed as in the fit, in units of h^2.
double misfit(const QuadraticPatch& s, const Member& m, double h) {
  Vector3d g;
  const double d = s.distance(m.p, &g) / h;
  return m.weight * (d * d + kSlopeWeight * (g - m.n).squaredNorm());
}

// Whether two of the patches face each other or away from each other.
bool are_walls(const LocalSurface& s, int a, int b) {
  const auto normal = [&](int k) { return s.patch[static_cast<std::size_t>(k)].frame.row(2); };
  return normal(a).dot(normal(b)) < -kSlant;
}

// Where the members of a patch are as seen from another one.
struct Seen {
  double mean = 0;        // signed distance
  bool one_side = false;  // most of them are on the side of the mean
};

// Patch `b` from patch `a`. Members that are nearer to the opposite wall of `a`, the third patch, are beside that one: where a gap opens or
// a wall ends, the surface goes on on both sides. Of a patch with no other members they tell all the same.
Seen see(const LocalSurface& s, const std::vector<Member>& members, int a, int b) {
  const int third = 3 - a - b;
  const bool opposite = s.count == 3 && are_walls(s, a, third) && !are_walls(s, a, b);
  for (const bool all : {!opposite, true}) {
    double sum = 0, size = 0, total = 0;
    for (const Member& m : members) {
      if (m.patch != b) continue;
      const double d = s.patch[static_cast<std::size_t>(a)].distance(m.p);
      if (!all && std::abs(s.patch[static_cast<std::size_t>(third)].distance(m.p)) < std::abs(d)) continue;
      sum += m.weight * d;
      size += m.weight * std::abs(d);
      total += m.weight;
    }
    if (total > 0) return {sum / total, std::abs(sum) > kOneSide * size};
  }
  return {};
}

Joint joint_of(const Seen& a, const Seen& b) {
  if (a.mean < 0 && b.mean < 0) return Joint::kConvex;
  if (a.mean > 0 && b.mean > 0) return Joint::kConcave;
  return Joint::kNone;
}

// Joins the patches of a fit at x.
void join(LocalSurface& s, const std::vector<Member>& members, const Vector3d& x) {
  bool meet = true;
  for (int b = 1; b < s.count; ++b) {
    for (int a = 0; a < b; ++a) {
      const Seen b_from_a = see(s, members, a, b), a_from_b = see(s, members, b, a);
      const Joint joint = joint_of(b_from_a, a_from_b);
      s.joint[static_cast<std::size_t>(a + b - 1)] = joint;
      meet = joint != Joint::kNone && b_from_a.one_side && a_from_b.one_side;
    }
  }
  s.unjoined = s.count == 2 && !s.walls && !meet && (s.patch[0].distance(x) > 0) != (s.patch[1].distance(x) > 0);
}

// The nearest point left seeds a patch, which takes those with similar normals: similar to the seed's, then to their mean. False if no
// point is left.
bool grow_patch(LocalSurface& s, std::vector<Member>& members) {
  const auto seed = std::find_if(members.begin(), members.end(), [](const Member& m) { return m.patch == kUnassigned; });
  if (seed == members.end()) return false;
  Vector3d axis = seed->n;
  std::size_t taken = 0;
  for (int pass = 0; pass < 2; ++pass) {
    Vector3d mean = Vector3d::Zero();
    taken = 0;
    for (Member& m : members) {
      if (m.patch != kUnassigned && m.patch != s.count) continue;
      const bool same = m.n.dot(axis) > kSamePatch || &m == &*seed;
      m.patch = same ? s.count : kUnassigned;
      if (!same) continue;
      mean += m.weight * m.n;
      ++taken;
    }
    axis = mean.normalized();
  }
  if (taken < std::min(kPatchPoints, members.size()) && s.count > 0) {
    for (Member& m : members) {
      if (m.patch == s.count) m.patch = kLeftOut;
    }
    return true;
  }
  s.patch[static_cast<std::size_t>(s.count)] = fit_quadratic_patch(members, s.count, s.spacing, kSlopeWeight);
  ++s.count;
  return true;
}

bool has_walls(const LocalSurface& s) {
  for (int a = 0; a < s.count; ++a) {
    for (int b = 0; b < a; ++b) {
      if (are_walls(s, a, b)) return true;
    }
  }
  return false;
}

// Whether all points belong to the one patch, and their tangent planes have x on the side that it has it on. Planes nearer than half
// a spacing need not: curvature does that to them.
bool is_simple(const LocalSurface& s, const std::vector<Member>& members, const Vector3d& x) {
  const double f = s.patch[0].distance(x);
  return std::all_of(members.begin(), members.end(), [&](const Member& m) {
    const double plane = m.n.dot(x - m.p);
    return m.patch == 0 && ((plane > 0) == (f > 0) || std::abs(plane) < 0.5 * s.spacing);
  });
}

// Undersampled detail also makes normals differ. Several patches are kept only if they explain the points far better than one smooth
// patch does; patches that face each other are always kept.
void prefer_one_patch(LocalSurface& s, std::vector<Member>& members) {
  if (s.walls) return;
  double split = 0, whole = 0;
  std::array<int, kFitPoints> patch{};
  for (std::size_t i = 0; i < members.size(); ++i) {
    Member& m = members[i];
    if (m.patch >= 0) split += misfit(s.patch[static_cast<std::size_t>(m.patch)], m, s.spacing);
    patch[i] = m.patch;
    if (m.patch >= 0) m.patch = 0;
  }
  const QuadraticPatch one = fit_quadratic_patch(members, 0, s.spacing, kSlopeWeight);
  for (const Member& m : members) whole += m.patch == 0 ? misfit(one, m, s.spacing) : 0;
  if (split > kSplitGain * whole) {
    s.count = 1;
    s.patch[0] = one;
  } else {
    for (std::size_t i = 0; i < members.size(); ++i) members[i].patch = patch[i];
  }
}

// The value of one patch at a place.
struct Part {
  double f;
  int patch;
};

// Of the solid that two patches bound; a, the nearer one, where they do not meet.
Part combine(const Part& a, const Part& b, Joint joint) {
  if (joint == Joint::kConvex) return a.f >= b.f ? a : b;
  if (joint == Joint::kConcave) return a.f <= b.f ? a : b;
  return a;
}

// The pair that is joined in another way than the other two pairs is joined first. `joint`: of a-b, a-c, b-c.
Part join_three(const Part& a, const Part& b, const Part& c, const std::array<Joint, 3>& joint) {
  const auto [ab, ac, bc] = joint;
  if (bc != Joint::kNone && ab == ac) return combine(a, combine(b, c, bc), ab);
  if (ac != Joint::kNone && ab == bc) return combine(combine(a, c, ac), b, ab);
  return combine(combine(a, b, ab), c, ac);
}

}  // namespace

double LocalSurface::distance(const Vector3d& x, int* active) const {
  const auto at = [&](std::size_t k) { return Part{patch[k].distance(x), static_cast<int>(k)}; };
  Part result = at(0);
  if (count == 2) {
    result = combine(result, at(1), joint[0]);
  } else if (count == 3) {
    result = join_three(at(0), at(1), at(2), joint);
  }
  if (active != nullptr) *active = result.patch;
  return result.f;
}

LocalFit::LocalFit(const OrientedPoints& points, const Neighbours& neighbours, const std::vector<std::uint32_t>& near)
    : points_(points),
      near_(near),
      count_(near_.size() / points.positions.size()),
      neighbours_(neighbours),
      widest_(*std::max_element(points.spacing.begin(), points.spacing.end())) {}

// The point nearest to x and its squared distance; kNone if it is surely farther than `reach` of its spacings. Places are mostly asked for
// one after the other, so the search goes from the last point found to the nearest of its neighbours, until no point that is not its
// neighbour can be nearer. Where it starts does not change what is found.
std::uint32_t LocalFit::nearest(const Vector3d& x, double reach, double& squared) const {
  thread_local std::uint32_t last = 0;
  const std::vector<Vec3>& p = points_.positions;
  if (last >= p.size()) last = 0;
  const Vec3 place{x[0], x[1], x[2]};
  const auto squared_distance = [](const Vec3& a, const Vec3& b) {  // as the tree of neighbours_ computes it
    const double dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
    return dx * dx + dy * dy + dz * dz;
  };
  const double most = reach * widest_;
  squared = kWider * most * most;
  while (true) {
    const std::uint32_t centre = last;
    const std::uint32_t* const near = near_.data() + centre * count_;
    const double to_centre = squared_distance(place, p[centre]);
    double best = to_centre;
    bool tie = false;
    for (std::size_t k = 0; k < count_; ++k) {
      const double d = squared_distance(place, p[near[k]]);
      if (d > best || near[k] == last) continue;
      tie = d == best;
      best = d;
      last = near[k];
    }
    const double others = std::sqrt(squared_distance(p[centre], p[near[count_ - 1]])) - std::sqrt(to_centre);
    if (!tie && others > 0 && kWider * best < others * others) {
      squared = best;
      return last;
    }
    squared = std::min(squared, kWider * best);
    if (last == centre || tie) break;
  }
  const std::uint32_t found = neighbours_.nearest(place, squared, kNone);
  if (found != kNone) last = found;
  return found;
}

// Is x well on one side of the tangent planes of all points next to point i, and do these belong to one patch? Then their mean plane is fit
// enough to say which.
bool LocalFit::clear_of(std::uint32_t i, const Vector3d& x, double scale, QuadraticPatch& plane) const {
  const Vector3d axis = to_eigen(points_.normals[i]), p0 = to_eigen(points_.positions[i]);
  const bool outside = axis.dot(x - p0) > 0;
  const double first = (x - p0).squaredNorm(), clear = kClear * points_.spacing[i];
  Vector3d mean_p = Vector3d::Zero(), mean_n = Vector3d::Zero();
  double total = 0;
  for (std::size_t k = 0; k < std::min(kFitPoints, count_); ++k) {
    const std::uint32_t j = near_[i * count_ + k];
    const Vector3d p = to_eigen(points_.positions[j]), n = to_eigen(points_.normals[j]);
    const double d = n.dot(x - p);
    if ((d > 0) != outside || std::abs(d) < clear || n.dot(axis) <= kSamePatch) return false;
    const double weight = bell(std::min(((x - p).squaredNorm() - first) * scale, kFaint));
    mean_p += weight * p;
    mean_n += weight * n;
    total += weight;
  }
  plane.origin = mean_p / total;
  plane.frame = tangent_frame(mean_n.normalized());
  return true;
}

LocalSurface LocalFit::fit(const Vector3d& x, double reach, const Vector3d* direction, Detail detail) const {
  thread_local std::vector<Member> members;
  double squared = 0;
  const std::uint32_t nearest = this->nearest(x, reach, squared);
  LocalSurface out;
  if (nearest == kNone) return out;
  out.spacing = points_.spacing[nearest];
  const double h = out.spacing;
  if (std::sqrt(squared) > reach * h) return out;
  const double scale = 1 / (2 * kWidth * kWidth * h * h);
  if (detail == Detail::kSide && clear_of(nearest, x, scale, out.patch[0])) {
    out.count = 1;
    out.simple = true;
    return out;
  }
  gather(x, nearest, scale, direction, members);
  for (int seed = 0; seed < kMostPatches && grow_patch(out, members); ++seed) continue;
  out.walls = has_walls(out);
  if (out.count == 1) {
    out.simple = is_simple(out, members, x);
  } else if (out.count > 1) {
    prefer_one_patch(out, members);
  }
  join(out, members, x);
  return out;
}

// The points that take part in the fit at x, nearest first, with their weights.
void LocalFit::gather(const Vector3d& x, std::uint32_t nearest, double scale, const Vector3d* direction,
                      std::vector<Member>& members) const {
  // The nearest ones, by insertion: the neighbours are nearly in order.
  std::array<std::pair<double, std::uint32_t>, kFitPoints> near;  // squared distances and points
  std::size_t used = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    const std::uint32_t i = near_[nearest * count_ + k];
    const std::pair now{(to_eigen(points_.positions[i]) - x).squaredNorm(), i};
    if (used == kFitPoints && now >= near[used - 1]) continue;
    std::size_t place = used < kFitPoints ? used++ : used - 1;
    for (; place > 0 && now < near[place - 1]; --place) near[place] = near[place - 1];
    near[place] = now;
  }
  members.clear();
  double first = -1;
  for (std::size_t k = 0; k < used; ++k) {
    const auto [r2, i] = near[k];
    const Vector3d n = to_eigen(points_.normals[i]);
    if (direction != nullptr && n.dot(*direction) < -kSlant) continue;  // on the other wall
    if (first < 0) first = r2;
    const double exponent = (r2 - first) * scale;
    if (exponent >= kFaint) break;
    members.push_back({to_eigen(points_.positions[i]), n, bell(exponent), kUnassigned});
  }
}

std::vector<double> wall_thickness(const OrientedPoints& points, const std::vector<std::uint32_t>& near) {
  const std::size_t n = points.positions.size(), stride = near.size() / n, k = std::min(stride, kFitPoints);
  std::vector<double> out(n, std::numeric_limits<double>::infinity());
  parallel::for_blocks(n, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d p = to_eigen(points.positions[i]), normal = to_eigen(points.normals[i]);
      for (std::size_t j = 0; j < k; ++j) {
        const std::uint32_t other = near[i * stride + j];
        if (normal.dot(to_eigen(points.normals[other])) > -kAlong) continue;  // sharp edges turn less
        out[i] = std::min(out[i], std::abs(normal.dot(to_eigen(points.positions[other]) - p)));
      }
    }
  });
  return out;
}

}  // namespace g3r::mesh
