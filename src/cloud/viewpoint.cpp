#include "cloud/viewpoint.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/some_places.h"
#include "cloud/spacing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

namespace g3r {
namespace {

// Exact planes through a point that are looked for: those of its row, of its column, and of a facet or a step of depth.
constexpr int kMostPlanes = 3;
// Of the places that could show it, those whose rows are in sight: planes through the axis of a camera hold its middle row and column from
// any place on the axis, 2 of sqrt(N) rows; frames whose depths are in coarse steps have a sixth or more.
constexpr double kFewestRows = 0.1;

bool is_along(const Vec3& viewpoint, const Vec3& point, const Vec3& normal) {
  return std::abs(vector::dot(normal, vector::normalised(vector::subtract(viewpoint, point)))) <= kExactScatter;
}

// Unit vectors from a place.
std::vector<Vec3> directions_from(const Vec3& place, const std::vector<Vec3>& points) {
  std::vector<Vec3> directions;
  directions.reserve(points.size());
  for (const Vec3& p : points) directions.push_back(vector::normalised(vector::subtract(p, place)));
  return directions;
}

class ViewpointSearch {
 public:
  explicit ViewpointSearch(const PointSet& set) : points_(set.points()), within_(kExactScatter * set.spacing()) {
    std::vector<double> squared;
    const SomePlaces some = SomePlaces::at_least(kFewPlaces, points_.size());
    for (std::size_t s = 0; s < some.size(); ++s) {
      Place place;
      set.tree().nearest(points_[some[s]], kPlaneNeighbours, place.index, squared);
      std::vector<std::uint32_t> index = place.index;
      for (int k = 0; k < kMostPlanes; ++k) {
        ExactPlane plane = find_exact_plane(points_, index, set.spacing());
        if (plane.points.empty()) break;
        index = beside_plane(index, plane.points);
        place.planes.push_back(std::move(plane));
      }
      places_.push_back(std::move(place));
    }
  }

  // Where exact planes meet, three of places far apart in the cloud, that is on the lines in which two of them cross at most places.
  [[nodiscard]] std::optional<Vec3> common_place() const {
    std::vector<Plane> planes;
    for (const Place& place : places_) {
      if (place.planes.size() < 2) continue;
      for (const ExactPlane& p : place.planes) planes.push_back({p.normal, vector::dot(p.normal, points_[place.index[0]])});
    }
    std::optional<Vec3> best;
    std::ptrdiff_t most = 0;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const auto farther = [&](std::size_t thirds) { return planes[(i + thirds * planes.size() / 3) % planes.size()]; };
      const std::optional<Vec3> meeting = meeting_place(planes[i], farther(1), farther(2));
      if (!meeting) continue;
      const auto seen = std::count_if(places_.begin(), places_.end(), [&](const Place& place) { return is_in_sight(place, *meeting); });
      if (seen <= most) continue;
      most = seen;
      best = meeting;
    }
    return best;
  }

  // How many places have their rows in sight of the candidate; 0 if it is not where a camera stood.
  [[nodiscard]] std::size_t support(const Vec3& candidate) const {
    if (!is_before_all(candidate)) return 0;
    const std::size_t rows = rows_in_sight(candidate);
    return rows > 0 && is_pixel_grid(candidate) ? rows : 0;
  }

 private:
  // A point of the cloud, first, and the nearest others, with exact planes through it, no two of which hold another point together.
  struct Place {
    std::vector<std::uint32_t> index;
    std::vector<ExactPlane> planes;
  };

  // normal . x = offset
  struct Plane {
    Vec3 normal{};
    double offset = 0;
  };

  enum class Answer { kNo, kYes, kSilent };

  // Nothing where the planes are nearly parallel to one line.
  static std::optional<Vec3> meeting_place(const Plane& a, const Plane& b, const Plane& c) {
    const Vec3 bc = vector::cross(b.normal, c.normal);
    const Vec3 ca = vector::cross(c.normal, a.normal);
    const Vec3 ab = vector::cross(a.normal, b.normal);
    const double determinant = vector::dot(a.normal, bc);
    if (std::abs(determinant) < kLineBreadth * kLineBreadth) return std::nullopt;
    return vector::scale(vector::add(vector::add(vector::scale(bc, a.offset), vector::scale(ca, b.offset)), vector::scale(ab, c.offset)),
                         1 / determinant);
  }

  [[nodiscard]] const Vec3& point_of(const Place& place) const { return points_[place.index.front()]; }

  [[nodiscard]] Vec3 sight_to(const Place& place, const Vec3& candidate) const {
    return vector::normalised(vector::subtract(point_of(place), candidate));
  }

  // Whether two of the planes hold the candidate, and with it the line of sight.
  [[nodiscard]] bool is_in_sight(const Place& place, const Vec3& candidate) const {
    const Vec3* one = nullptr;
    for (const ExactPlane& plane : place.planes) {
      if (!is_along(candidate, point_of(place), plane.normal)) continue;
      if (one != nullptr && vector::length(vector::cross(*one, plane.normal)) > kLineBreadth) {
        return !hides_another(place.index, sight_to(place, candidate));
      }
      one = &plane.normal;
    }
    return false;
  }

  // Whether all points are on one side of a plane through the candidate.
  [[nodiscard]] bool is_before_all(const Vec3& candidate) const {
    Vec3 middle{};
    for (const Vec3& p : points_) middle = vector::add(middle, vector::normalised(vector::subtract(p, candidate)));
    return std::all_of(points_.begin(), points_.end(),
                       [&](const Vec3& p) { return vector::dot(middle, vector::subtract(p, candidate)) > 0; });
  }

  // 0 if there are so few by chance.
  [[nodiscard]] std::size_t rows_in_sight(const Vec3& candidate) const {
    std::size_t yes = 0;
    std::size_t heard = 0;
    for (const Place& place : places_) {
      const Answer answer = ask(place, candidate);
      heard += answer != Answer::kSilent ? 1 : 0;
      yes += answer == Answer::kYes ? 1 : 0;
    }
    return yes >= proving_number(heard, kFalseAlarms, 1) && static_cast<double>(yes) >= kFewestRows * static_cast<double>(heard) ? yes : 0;
  }

  // Whether a row and a column of the points lie in planes through the candidate, or one of those that are on no facet with the first.
  [[nodiscard]] Answer ask(const Place& place, const Vec3& candidate) const {
    std::vector<std::uint32_t> index = place.index;
    bool on_facet = false;
    for (const ExactPlane& plane : place.planes) {
      if (is_along(candidate, point_of(place), plane.normal)) continue;
      on_facet = true;
      index = beside_plane(index, plane.points);
    }
    if (index.size() <= kPlaneTerms) return Answer::kSilent;
    // Two, beside the one and the other that the plane goes through: no place of 4 points or more has too few.
    const std::size_t proof = proving_number(index.size() - 2, kExactScatter, kPlaneNeighbours) + 2;
    const Vec3 sight = sight_to(place, candidate);
    if (hides_another(index, sight)) return Answer::kNo;
    const std::vector<std::uint32_t> row = most_in_sight(index, sight);
    if (row.size() < proof) return Answer::kNo;
    return on_facet || most_in_sight(beside_plane(index, row), sight).size() >= proof ? Answer::kYes : Answer::kNo;
  }

  [[nodiscard]] bool hides_another(const std::vector<std::uint32_t>& index, const Vec3& sight) const {
    return std::any_of(index.begin() + 1, index.end(), [&](std::uint32_t i) {
      return vector::length(vector::cross(sight, vector::subtract(points_[i], points_[index.front()]))) <= within_;
    });
  }

  // The most of the points that a plane through the first and along the line of sight holds.
  [[nodiscard]] std::vector<std::uint32_t> most_in_sight(const std::vector<std::uint32_t>& index, const Vec3& sight) const {
    std::vector<std::uint32_t> most;
    for (std::size_t s = 1; s < index.size(); ++s) {
      const Vec3 normal = vector::normalised(vector::cross(sight, vector::subtract(points_[index[s]], points_[index.front()])));
      std::vector<std::uint32_t> held;
      std::copy_if(index.begin(), index.end(), std::back_inserter(held), [&](std::uint32_t i) {
        return std::abs(vector::dot(normal, vector::subtract(points_[i], points_[index.front()]))) <= within_;
      });
      if (held.size() > most.size()) most = std::move(held);
    }
    return most;
  }

  [[nodiscard]] bool is_pixel_grid(const Vec3& candidate) const {
    const std::vector<Vec3> sights = directions_from(candidate, points_);
    const Neighbours tree(sights);
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    std::vector<double> nearest;
    for (const Place& place : places_) {
      tree.nearest(sights[place.index.front()], 2, index, squared);
      nearest.push_back(std::sqrt(squared.back()));
    }
    const double typical = median(nearest);
    const auto uneven =
        std::count_if(nearest.begin(), nearest.end(), [&](double d) { return d < kClearlyLess * typical || typical < kClearlyLess * d; });
    return static_cast<double>(uneven) <= kFalseAlarms * static_cast<double>(nearest.size());
  }

  const std::vector<Vec3>& points_;
  double within_;  // of an exact plane or line
  std::vector<Place> places_;
};

}  // namespace

std::optional<Vec3> find_viewpoint(const PointSet& set, const Vec3& origin) {
  if (set.size() < kFewestSurfacePoints) return std::nullopt;
  const ViewpointSearch search(set);
  Vec3 place = origin;
  std::size_t most = search.support(place);
  if (const std::optional<Vec3> common = search.common_place()) {
    const std::size_t support = search.support(*common);
    if (support > most) place = *common;
    most = std::max(most, support);
  }
  if (most == 0) return std::nullopt;
  const Vec3 opposite = vector::subtract(vector::scale(vector::mean(set.points()), 2), place);
  return search.support(opposite) > 0 ? std::nullopt : std::optional(place);
}

bool may_be_seen_from(const std::vector<Vec3>& points, const Vec3& place) {
  if (points.size() < kFewestSurfacePoints) return false;
  const std::vector<Vec3> sights = directions_from(place, points);
  const Neighbours tree(sights);
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  const auto nearest = [&](std::uint32_t i) {
    std::vector<std::uint32_t> two;
    tree.nearest(sights[i], 2, two, squared);
    return std::sqrt(squared.back());
  };
  const SomePlaces some = SomePlaces::at_least(kFewPlaces, points.size());
  std::size_t too_near = 0;
  for (std::size_t s = 0; s < some.size(); ++s) {
    const auto i = static_cast<std::uint32_t>(some[s]);
    tree.nearest(sights[i], kClosest + 1, index, squared);
    std::vector<double> around;
    for (const std::uint32_t k : index) {
      if (k != i) around.push_back(nearest(k));
    }
    too_near += nearest(i) < kClearlyLess * median(around) ? 1 : 0;
  }
  return static_cast<double>(too_near) <= kFalseAlarms * static_cast<double>(some.size());
}

bool may_be_seen(const std::vector<Vec3>& points, const Views& views) {
  std::vector<std::vector<Vec3>> seen(views.places.size());
  for (std::size_t i = 0; i < points.size(); ++i) seen[views.of_point.empty() ? 0 : views.of_point[i]].push_back(points[i]);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (!seen[k].empty() && !may_be_seen_from(seen[k], views.places[k])) return false;
  }
  return true;
}

bool is_along_sight(const PointSet& set, std::size_t point, const Vec3& normal) {
  return set.views().known() && is_along(set.views().place_of(point), set.points()[point], normal);
}

}  // namespace g3r
