#include "orient/facet_normals.h"

#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace g3r {
namespace {

using vector::add;
using vector::dot;
using vector::scale;
using vector::subtract;

// Standard deviation of points about the planes of their facets, kPlaneTerms numbers of each of which are fitted.
double deviation_from(const Facets& facets, const std::vector<Vec3>& points) {
  double squares = 0;
  double count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (facets.of[i] == Facets::kNone) continue;
    const double height = facets.planes[facets.of[i]].height(points[i]);
    squares += height * height;
    ++count;
  }
  const double free = count - static_cast<double>(kPlaneTerms * facets.count);
  return free > 0 ? std::sqrt(squares / free) : 0;
}

// A facet that points around one are on.
struct NearFacet {
  const FacetPlane* plane = nullptr;
  std::vector<std::uint32_t> points;
  Vec3 normal{0, 0, 0};  // of the plane, on the side of most of these points
  double height = 0;     // of the one above the plane
};

// The surfaces that one point after the other may be of.
class Mixture {
 public:
  Mixture(const PointSet& set, const Facets& facets, const std::vector<Vec3>& normals, double deviation)
      : points_(set.points()), near_(set.near()), facets_(facets), normals_(normals), deviation_(deviation) {}

  // Their mean normal at point i, not of unit length; 0 where it is on no facet.
  [[nodiscard]] Vec3 normal(std::size_t i) {
    Vec3 mean = gather(i);
    bool is_on_facet = false;
    for (const NearFacet& f : facets_near_) {
      if (is_behind(f.normal, i)) continue;
      is_on_facet = is_on_facet || std::abs(f.height) <= kSigmas * deviation_;
      double weight = std::exp(-f.height * f.height / (2 * deviation_ * deviation_));
      for (const NearFacet& g : facets_near_) weight *= share_before(g, f);
      mean = add(mean, scale(f.normal, weight));
    }
    return is_on_facet ? mean : Vec3{0, 0, 0};
  }

 private:
  // On the other side of a wall.
  [[nodiscard]] bool is_behind(const Vec3& normal, std::size_t i) const { return dot(normal, normals_[i]) < -kSameSide; }

  // Finds the facets near point i, and returns the mean of the other normals there by their weights.
  Vec3 gather(std::size_t i) {
    facets_near_.clear();
    Vec3 others{0, 0, 0};
    for (std::size_t k = 0; k < kSpacingNeighbours; ++k) {
      const std::uint32_t j = near_[i * kSpacingNeighbours + k];
      if (facets_.of[j] != Facets::kNone) {
        facet_near(facets_.planes[facets_.of[j]]).points.push_back(j);
      } else if (k > 0 && !is_behind(normals_[j], i)) {
        const double height = dot(normals_[j], subtract(points_[i], points_[j]));
        const double weight = std::exp(-height * height / (4 * deviation_ * deviation_)) / std::numbers::sqrt2;
        others = add(others, scale(normals_[j], weight / (kSpacingNeighbours - 1)));
      }
    }
    for (NearFacet& f : facets_near_) {
      const auto along =
          std::count_if(f.points.begin(), f.points.end(), [&](std::uint32_t j) { return dot(f.plane->normal, normals_[j]) >= 0; });
      f.normal = 2 * static_cast<std::size_t>(along) < f.points.size() ? scale(f.plane->normal, -1) : f.plane->normal;
      f.height = dot(f.normal, subtract(points_[i], f.plane->middle));
    }
    return others;
  }

  NearFacet& facet_near(const FacetPlane& plane) {
    for (NearFacet& f : facets_near_) {
      if (f.plane == &plane) return f;
    }
    facets_near_.emplace_back();
    facets_near_.back().plane = &plane;
    return facets_near_.back();
  }

  // How much of the noise about the point may come from facet f, if that ends at the plane of g.
  [[nodiscard]] double share_before(const NearFacet& g, const NearFacet& f) const {
    const double cosine = dot(f.normal, g.normal);
    if (std::abs(cosine) > kSamePatch) return 1;  // of one surface, or beside each other
    const double sine = std::sqrt(1 - cosine * cosine);
    double below = 0, above = 0, sum = 0;
    for (const std::uint32_t j : f.points) {
      const double height = dot(g.normal, subtract(points_[j], g.plane->middle));
      below = std::min(below, height);
      above = std::max(above, height);
      sum += height;
    }
    if (std::min(-below, above) > kSigmas * deviation_ * sine) return 1;
    const double beyond = (g.height - cosine * f.height) / sine;
    return normal_distribution((sum < 0 ? -beyond : beyond) / deviation_);
  }

  const std::vector<Vec3>& points_;
  const std::vector<std::uint32_t>& near_;
  const Facets& facets_;
  const std::vector<Vec3>& normals_;
  const double deviation_;
  std::vector<NearFacet> facets_near_;
};

}  // namespace

void follow_facets(const PointSet& set, const Facets& facets, const std::vector<std::uint8_t>& wanted, std::vector<Vec3>& normals) {
  if (facets.count == 0) return;
  const double deviation = std::max(deviation_from(facets, set.points()), kExactScatter * set.spacing());
  std::vector<Vec3> out = normals;
  parallel::for_blocks(set.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    Mixture mixture(set, facets, normals, deviation);
    for (std::size_t i = begin; i < end; ++i) {
      if (!wanted.empty() && wanted[i] == 0) continue;
      const Vec3 n = vector::normalised(mixture.normal(i));
      if (dot(n, n) > 0) out[i] = n;
    }
  });
  normals = std::move(out);
}

}  // namespace g3r
