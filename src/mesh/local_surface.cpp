#include "mesh/local_surface.h"

#include "cloud/constants.h"
#include "mesh/constants.h"

#include <algorithm>
#include <cmath>

namespace g3r::mesh {
namespace {

using Eigen::Vector3d;

// The patch of a member that none has taken yet, and of one that makes no patch with those like it.
enum : int { kUnassigned = -1, kLeftOut = -2 };

// Squared misfit of a member to a patch, positions and slopes weighed as in the fit, in units of h^2.
double misfit(const QuadraticPatch& s, const FitPoint& m, double h) {
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
  bool one_side = false;  // a clear majority of the distances is on the side of the mean: a patch that goes on on both does not surely end
};

// Patch `b` from patch `a`. Members that are nearer to the opposite wall of `a`, the third patch, are beside that one: where a gap opens or
// a wall ends, the surface goes on on both sides. Of a patch with no other members they tell all the same.
Seen see(const LocalSurface& s, const std::vector<FitPoint>& members, int a, int b) {
  const int third = 3 - a - b;
  const bool opposite = s.count == 3 && are_walls(s, a, third) && !are_walls(s, a, b);
  for (const bool all : {!opposite, true}) {
    double sum = 0, size = 0, total = 0;
    for (const FitPoint& m : members) {
      if (m.patch != b) continue;
      const double d = s.patch[static_cast<std::size_t>(a)].distance(m.p);
      if (!all && std::abs(s.patch[static_cast<std::size_t>(third)].distance(m.p)) < std::abs(d)) continue;
      sum += m.weight * d;
      size += m.weight * std::abs(d);
      total += m.weight;
    }
    if (total > 0) return {sum / total, std::abs(sum) + size > 2 * kMostOf * size};
  }
  return {};
}

Joint joint_of(const Seen& a, const Seen& b) {
  if (a.mean < 0 && b.mean < 0) return Joint::kConvex;
  if (a.mean > 0 && b.mean > 0) return Joint::kConcave;
  return Joint::kNone;
}

// Joins the patches of a fit at x.
void join(LocalSurface& s, const std::vector<FitPoint>& members, const Vector3d& x) {
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

// Whether the patch after two that are walls closes them, as the rim of a plate does: it is square to both, and both are on one side of it.
// Of a rim narrower than the spacing one point is often all there is: without it the walls would go on.
bool ends_walls(const LocalSurface& s, const std::vector<FitPoint>& members) {
  const auto normal = [&](std::size_t k) { return s.patch[k].frame.row(2); };
  if (s.count != 2 || !are_walls(s, 0, 1)) return false;
  if (std::abs(normal(0).dot(normal(2))) > kSlant || std::abs(normal(1).dot(normal(2))) > kSlant) return false;
  const Seen first = see(s, members, 2, 0), second = see(s, members, 2, 1);
  return first.one_side && second.one_side && (first.mean < 0) == (second.mean < 0);
}

// The nearest point left seeds a patch, which takes those with similar normals: similar to the seed's, then to their mean. False if no
// point is left.
bool grow_patch(LocalSurface& s, std::vector<FitPoint>& members) {
  const auto seed = std::find_if(members.begin(), members.end(), [](const FitPoint& m) { return m.patch == kUnassigned; });
  if (seed == members.end()) return false;
  Vector3d axis = seed->n;
  std::size_t taken = 0;
  for (int pass = 0; pass < 2; ++pass) {
    Vector3d mean = Vector3d::Zero();
    taken = 0;
    for (FitPoint& m : members) {
      if (m.patch != kUnassigned && m.patch != s.count) continue;
      const bool same = m.n.dot(axis) > kSameLocalPatch || &m == &*seed;
      m.patch = same ? s.count : kUnassigned;
      if (!same) continue;
      mean += m.weight * m.n;
      ++taken;
    }
    axis = mean.normalized();
  }
  s.patch[static_cast<std::size_t>(s.count)] = fit_quadratic_patch(members, s.count, s.spacing, kSlopeWeight);
  if (taken < std::min(kPatchPoints, members.size()) && s.count > 0 && !ends_walls(s, members)) {
    for (FitPoint& m : members) {
      if (m.patch == s.count) m.patch = kLeftOut;
    }
    return true;
  }
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
bool is_simple(const LocalSurface& s, const std::vector<FitPoint>& members, const Vector3d& x) {
  const double f = s.patch[0].distance(x);
  return std::all_of(members.begin(), members.end(), [&](const FitPoint& m) {
    const double plane = m.n.dot(x - m.p);
    return m.patch == 0 && ((plane > 0) == (f > 0) || std::abs(plane) < 0.5 * s.spacing);
  });
}

// Undersampled detail also makes normals differ. Several patches are kept only if they leave little of the squared misfit of one smooth
// patch, as a crease of a CAD model does (without, the dragon's AE_m is 1.05 instead of 0.88); patches that face
// each other are always kept.
void prefer_one_patch(LocalSurface& s, std::vector<FitPoint>& members) {
  if (s.walls) return;
  double split = 0, whole = 0;
  std::array<int, kFitPoints> patch{};
  for (std::size_t i = 0; i < members.size(); ++i) {
    FitPoint& m = members[i];
    if (m.patch >= 0) split += misfit(s.patch[static_cast<std::size_t>(m.patch)], m, s.spacing);
    patch[i] = m.patch;
    if (m.patch >= 0) m.patch = 0;
  }
  const QuadraticPatch one = fit_quadratic_patch(members, 0, s.spacing, kSlopeWeight);
  for (const FitPoint& m : members) whole += m.patch == 0 ? misfit(one, m, s.spacing) : 0;
  if (split > kLittle * whole) {
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

LocalSurface surface_through(std::vector<FitPoint>& points, double spacing, const Vector3d& x) {
  LocalSurface out;
  out.spacing = spacing;
  for (FitPoint& point : points) point.patch = kUnassigned;
  for (int seed = 0; seed < kMostPatches && grow_patch(out, points); ++seed) continue;
  out.walls = has_walls(out);
  if (out.count == 1) {
    out.simple = is_simple(out, points, x);
  } else if (out.count > 1) {
    prefer_one_patch(out, points);
  }
  join(out, points, x);
  return out;
}

}  // namespace g3r::mesh
