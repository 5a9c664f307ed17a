#include "cloud/canonical_cloud.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/morton.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"

#include <g3r/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace g3r {
namespace {

// The distance from a line, over its length, up to which points count as collinear: it is rounding.
constexpr double kLineThickness = 1e-12;
// The distance from the middle of the frame along an axis, at most, of points that are left out: from farther away the cloud is one point,
// and powers of the distance leave the range of double.
constexpr double kFarthest = 1 / std::numeric_limits<double>::epsilon();

struct Bounds {
  vector::Box box;
  std::size_t finite_points = 0;

  Bounds& operator+=(const Bounds& other) {
    box.extend(other.box);
    finite_points += other.finite_points;
    return *this;
  }
};

// Of the finite points that are not marked in `left_out`.
Bounds bounds_of(const PointsView& points, const std::vector<std::uint8_t>& left_out = {}) {
  return parallel::sum_blocks(points.count, parallel::kBlock, Bounds{}, [&](std::size_t begin, std::size_t end) {
    Bounds b;
    for (std::size_t i = begin; i < end; ++i) {
      if (!left_out.empty() && left_out[i] != 0) continue;
      if (const Vec3 p = points[i]; vector::is_finite(p)) b += {{p, p}, 1};
    }
    return b;
  });
}

Frame frame_of(const vector::Box& box) {
  Frame frame;
  for (std::size_t a = 0; a < 3; ++a) frame.centre[a] = box.low[a] + (box.high[a] - box.low[a]) / 2;
  const double side = box.longest_side();
  if (!std::isfinite(side)) throw InvalidInput("the extent of the coordinates is more than a double can hold; scale them down");
  if (side <= 0) throw InvalidInput("all points lie at the same place: at least 4 distinct points are needed");
  frame.scale = kBoxSide / side;
  if (!std::isfinite(frame.scale))
    throw InvalidInput("the extent is too small: the points are closer together than a double can resolve; scale them up");
  return frame;
}

double norm(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

// The longest of the vectors that `of` makes of the points; 0 where all are.
template <class Of>
Vec3 longest(const std::vector<Vec3>& points, const Of& of) {
  struct Longest {
    Vec3 vector{0, 0, 0};
    double length = 0;
    Longest& operator+=(const Longest& other) { return other.length > length ? *this = other : *this; }
  };
  return parallel::sum_blocks(points.size(), parallel::kBlock, Longest{},
                              [&](std::size_t begin, std::size_t end) {
                                Longest out;
                                for (std::size_t i = begin; i < end; ++i) {
                                  const Vec3 v = of(points[i]);
                                  out += {v, norm(v)};
                                }
                                return out;
                              })
      .vector;
}

// A place that is left out: in its direction, however far it is.
Vec3 to_unit_within_reach(const Frame& frame, const Vec3& p) {
  const Vec3 half =
      vector::subtract(vector::scale(p, 0.5), vector::scale(frame.centre, 0.5));  // the whole may be beyond the range of double
  const double largest = std::max({std::abs(half[0]), std::abs(half[1]), std::abs(half[2])});
  if (largest <= kFarthest / 2 / frame.scale) return frame.to_unit(p);
  return vector::scale(vector::scale(half, 1 / largest), kFarthest);
}

// Numbers the places of the points that are left out after those of the cloud, in the order of their coordinates.
std::vector<Vec3> add_left_out(const PointsView& points, const std::vector<std::uint8_t>& left_out, CanonicalCloud& cloud) {
  std::vector<std::pair<Vec3, std::uint32_t>> places;
  for (std::uint32_t i = 0; i < left_out.size(); ++i) {
    if (left_out[i] != 0 && vector::is_finite(points[i])) places.emplace_back(points[i], i);
  }
  std::sort(places.begin(), places.end());
  std::vector<Vec3> others;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto& [place, i] = places[k];
    if (k == 0 || place != places[k - 1].first) {
      others.push_back(to_unit_within_reach(cloud.frame, place));
      cloud.multiplicity.push_back(0);
    }
    ++cloud.multiplicity.back();
    cloud.point_of[i] = static_cast<std::uint32_t>(cloud.multiplicity.size() - 1);
  }
  return others;
}

}  // namespace

// Distance of all points from the line through their mean and the point farthest from it.
void require_not_collinear(const std::vector<Vec3>& points, std::size_t outliers) {
  Vec3 mean{0, 0, 0};
  for (const Vec3& p : points) {
    for (std::size_t a = 0; a < 3; ++a) mean[a] += p[a] / static_cast<double>(points.size());
  }
  const auto from_mean = [&mean](const Vec3& p) { return Vec3{p[0] - mean[0], p[1] - mean[1], p[2] - mean[2]}; };
  const Vec3 axis = longest(points, from_mean);
  const double length = norm(axis);
  for (const Vec3& p : points) {
    const Vec3 d = from_mean(p);
    const double off_line =
        std::hypot(d[1] * axis[2] - d[2] * axis[1], d[2] * axis[0] - d[0] * axis[2], d[0] * axis[1] - d[1] * axis[0]) / length;
    if (off_line > kLineThickness * length) return;
  }
  const std::string but = outliers == 0 ? "" : " but " + std::to_string(outliers) + (outliers == 1 ? " outlier" : " outliers");
  throw InvalidInput("all points" + but + " lie on one line (collinear): a surface needs points beside that line");
}

CanonicalCloud canonical_cloud(const PointsView& points) {
  std::vector<Vec3> none;
  CanonicalCloud cloud = canonical_cloud(points, {}, none);
  require_not_collinear(cloud.points());
  return cloud;
}

CanonicalCloud canonical_cloud(const PointsView& points, const std::vector<std::uint8_t>& left_out, std::vector<Vec3>& others) {
  if (points.count >= kNoPoint) throw InvalidInput("more than 4294967294 points; split the cloud");
  const Bounds bounds = bounds_of(points, left_out);
  if (bounds.finite_points < kLeastPoints) {
    throw InvalidInput("too few points: " + std::to_string(bounds.finite_points) + " of " + std::to_string(points.count) +
                       " are finite, at least 4 distinct points are needed");
  }
  CanonicalCloud cloud;
  cloud.frame = frame_of(bounds.box);

  std::vector<std::uint32_t> input;
  input.reserve(bounds.finite_points);
  for (std::size_t i = 0; i < points.count; ++i) {
    const bool is_place = vector::is_finite(points[i]);
    cloud.non_finite += is_place ? 0 : 1;
    if (is_place && (left_out.empty() || left_out[i] == 0)) input.push_back(static_cast<std::uint32_t>(i));
  }
  const std::size_t n = input.size();
  std::vector<Vec3> unit(n);
  parallel::for_all(n, [&](std::size_t i) { unit[i] = cloud.frame.to_unit(points[input[i]]); });
  const std::vector<std::uint32_t> order = morton_order(unit);
  std::vector<std::uint32_t> number(n);  // how many distinct ones there are up to a point
  parallel::for_all(n, [&](std::size_t k) { number[k] = k == 0 || unit[order[k]] != unit[order[k - 1]] ? 1 : 0; });
  std::partial_sum(number.begin(), number.end(), number.begin());
  std::vector<Vec3> kept(number.back());
  cloud.multiplicity.resize(kept.size());
  cloud.point_of.assign(points.count, kNoPoint);
  parallel::for_all(n, [&](std::size_t k) {
    const std::uint32_t place = number[k] - 1;
    cloud.point_of[input[order[k]]] = place;
    if (k > 0 && number[k - 1] == number[k]) return;
    kept[place] = unit[order[k]];
    for (std::size_t same = k; same < n && number[same] == number[k]; ++same) ++cloud.multiplicity[place];
  });
  cloud.set = PointSet(std::move(kept));
  if (cloud.size() < kLeastPoints) {
    throw InvalidInput("too few distinct points: " + std::to_string(cloud.size()) + " (the rest are duplicates), at least 4 are needed");
  }
  others = add_left_out(points, left_out, cloud);
  return cloud;
}

bool is_small_in_frame(const CanonicalCloud& cloud) { return bounds_of(cloud.points()).box.longest_side() < kClearlyLess * kBoxSide; }

bool is_flat(const CanonicalCloud& cloud) {
  // The plane through the first point, the point farthest from it, and the point farthest from the line through both.
  const Vec3& origin = cloud.points().front();
  const auto to = [&origin](const Vec3& p) { return vector::subtract(p, origin); };
  const Vec3 axis = longest(cloud.points(), to);
  const Vec3 normal = longest(cloud.points(), [&](const Vec3& p) { return vector::cross(axis, to(p)); });
  const double allowed = kLeastSpacing * norm(normal);
  return std::all_of(cloud.points().begin(), cloud.points().end(), [&](const Vec3& p) {
    const Vec3 d = to(p);
    return std::abs(d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2]) <= allowed;
  });
}

}  // namespace g3r
