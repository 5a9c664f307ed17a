#include "orient/open_sheets.h"

#include "cloud/plane_fit.h"
#include "cloud/sheet.h"
#include "cpu/parallel.h"
#include "median.h"
#include "mesh/disjoint_sets.h"
#include "vector.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

namespace g3r {
namespace {

using vector::dot;

constexpr std::size_t kAdjacent = 8;         // nearest points that a point is connected with
constexpr std::size_t kAround = 16;          // nearest points of which none may be wrong where nothing is flat
constexpr std::size_t kPlanePoints = 9;      // of a plane, the point itself included
constexpr double kFlat = 0.15;               // flatness of plainly flat places
constexpr double kBroad = 0.3;               // breadth of plainly flat places: on a wire all planes along it fit
constexpr double kNoisyDisc = 200;           // points of a plane under noise, times (noise / spacing)^2: 8 standard deviations
constexpr double kMostPlanePoints = 450;     // of a plane under noise
constexpr double kNoisyFlat = 0.35;          // flatness of plainly flat places under noise
constexpr std::size_t kProbes = 500;         // places looked at where a look at all takes long
constexpr double kProbedWrong = 0.005;       // share of these that have to be wrong
constexpr std::size_t kKurtosisPoints = 17;  // of a plane whose kurtosis is taken, at least
constexpr double kOneSheet = 0.87;           // kurtosis over that of a Gaussian: 0.9 to 1 on sheets, less between two walls;
constexpr std::size_t kMany = 24;            // from so many points on
constexpr double kOneSheetOfMany = 0.937;    // it is 0.941 to 1 on sheets
constexpr std::size_t kKurtoses = 4000;      // whose median is taken, at most: that of 500 differs by up to 0.015
constexpr double kParallel = 0.95;           // cosine between the planes of adjacent points; less where the samples are strokes
constexpr double kFacing = 4;                // spacings within which another wall explains wrong normals
constexpr double kOpposite = 0.7;            // cosine to the normal of a plane from which on a point faces it
constexpr double kBeyondNoise = 4;           // standard deviations that a point of the same sheet may be off its plane
constexpr double kSmooth = 0.03;             // misfit of a quadratic height field, in spacings, that proves one sheet
constexpr double kWrongCosine = 0.866025;    // 30 degrees
constexpr std::size_t kFewestWrong = 30;     // side by side that make an open sheet,
constexpr double kLeastWrong = 0.02;         // and share of all that are connected with them,
constexpr double kLeastWrongNoisy = 0.15;    // under noise
constexpr double kSamePlane = 0.9;           // cosine between normals of neighbours on one sheet
constexpr double kSlope = 0.5;               // height above the other's plane over distance, of neighbours on one sheet
constexpr double kAgree = 0.5;               // cosine between given normals that stay together
constexpr double kKept = 0.5;                // cosine between plane and given normal where nothing is flat, for the latter to be kept
constexpr double kDecided = 1.0 / 3;         // sum of the signs over their number: two thirds agree
constexpr double kFewestVotes = 0.2;         // majority over the number of points; a valley on a grid has 0.08, half a sphere 0.7
constexpr float kUndecided = 0.5F;           // certainty of a side chosen
constexpr double kLevel = 1e-6;              // part of the mean normal that counts as none
constexpr std::size_t kBlock = 256;          // points per parallel block

struct Plane {
  Vec3 normal{0, 0, 1};
  bool flat = false;
};

// Planes through the surroundings of every place.
class Planes {
 public:
  Planes(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near, const NoisyCloud* noisy)
      : points_(points), near_(near), noisy_(noisy) {
    if (noisy == nullptr) return;
    const double ratio = noisy->noise / noisy->spacing;
    count_ = std::max(kPlanePoints, static_cast<std::size_t>(std::min(kNoisyDisc * ratio * ratio, kMostPlanePoints)));
    flat_ = kNoisyFlat;
  }

  [[nodiscard]] bool is_flat(const PlaneFit& fit) const { return fit.flatness < flat_ && fit.breadth > kBroad; }

  [[nodiscard]] PlaneFit at(std::size_t i) const { return fit(i, count_); }
  [[nodiscard]] double least_kurtosis() const { return count_ < kMany ? kOneSheet : kOneSheetOfMany; }

  // Kurtosis of the distances from the plane over that of Gaussian ones; 1 on a smooth sheet, be it curved.
  [[nodiscard]] double kurtosis_at(std::size_t i) const {
    const std::size_t count = std::max(kKurtosisPoints, count_);
    const PlaneFit plane = fit(i, count);
    if (noisy_ == nullptr && is_smooth(i, count, plane.normal)) return 1;
    const auto total = static_cast<double>(count);
    return plane.kurtosis / (3 * (total - 1) / (total + 1));
  }

  // Whether there is another wall close by, in front of or behind the plane.
  [[nodiscard]] bool is_faced_at(std::size_t i, const Vec3& normal, const Neighbours& neighbours) const {
    const double spacing = noisy_ != nullptr ? noisy_->spacing : spacing_at(i, kAround + 1);
    const double thickness = noisy_ != nullptr ? kBeyondNoise * noisy_->noise : 0;
    std::vector<std::uint32_t> found;
    neighbours.within(points_[i], kFacing * spacing + thickness, found);
    return std::any_of(found.begin(), found.end(), [&](std::uint32_t j) {
      const Vec3 d = vector::subtract((noisy_ != nullptr ? noisy_->points : points_)[j], points_[i]);
      const double height = std::abs(dot(d, normal));
      return height > thickness && height > kOpposite * std::sqrt(dot(d, d));
    });
  }

  [[nodiscard]] std::vector<Plane> everywhere() const {
    std::vector<Plane> planes(points_.size());
    parallel::for_blocks(points_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const PlaneFit fit = at(i);
        planes[i] = {fit.normal, is_flat(fit)};
      }
    });
    return planes;
  }

 private:
  [[nodiscard]] PlaneFit fit(std::size_t i, std::size_t count) const {
    if (noisy_ == nullptr) return fit_plane(points_, nearest_to(i), count);
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    noisy_->neighbours.nearest(points_[i], count, index, squared);
    return fit_plane(noisy_->points, index.data(), index.size());
  }

  // Of a clean cloud: the nearest points of a point, the spacing of the first `count`, whether they lie on one smooth sheet.
  [[nodiscard]] const std::uint32_t* nearest_to(std::size_t i) const { return near_.data() + i * (near_.size() / points_.size()); }
  [[nodiscard]] double spacing_at(std::size_t i, std::size_t count) const {
    const Vec3 furthest = vector::subtract(points_[nearest_to(i)[count - 1]], points_[i]);
    return std::sqrt(dot(furthest, furthest) * std::numbers::pi / static_cast<double>(count));
  }
  [[nodiscard]] bool is_smooth(std::size_t i, std::size_t count, const Vec3& normal) const {
    const double spacing = spacing_at(i, count);
    return quadratic_residual(points_, nearest_to(i), count, normal, spacing) < kSmooth * spacing;
  }

  const std::vector<Vec3>& points_;
  const std::vector<std::uint32_t>& near_;
  const NoisyCloud* noisy_;
  std::size_t count_ = kPlanePoints;
  double flat_ = kFlat;
};

bool is_wrong(const Vec3& plane, const Vec3& normal) { return std::abs(dot(plane, normal)) < kWrongCosine; }

// Whether a look at some places finds wrong normals. Planes of many points take long.
bool probes_find_wrong(const Planes& planes, const std::vector<Vec3>& normals) {
  std::size_t probes = 0;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < normals.size(); i += std::max<std::size_t>(1, normals.size() / kProbes)) {
    const PlaneFit fit = planes.at(i);
    ++probes;
    wrong += planes.is_flat(fit) && is_wrong(fit.normal, normals[i]) ? 1 : 0;
  }
  return static_cast<double>(wrong) >= kProbedWrong * static_cast<double>(probes);
}

// Whether the points around the wrong ones of a component lie on one sheet by itself, and not on two walls or along strokes, which lie in
// planes of their own.
bool is_one_sheet(const Planes& fits, const std::vector<Plane>& planes, const std::vector<std::uint32_t>& near,
                  const Neighbours& neighbours, const std::vector<std::uint32_t>& wrong) {
  std::vector<double> kurtosis;
  std::vector<double> parallel;
  std::size_t faced = 0;
  for (std::size_t k = 0; k < wrong.size(); k += std::max<std::size_t>(1, wrong.size() / kKurtoses)) {
    const std::uint32_t i = wrong[k];
    kurtosis.push_back(fits.kurtosis_at(i));
    double sum = 0;
    for (std::size_t m = 1; m <= kAdjacent; ++m) {
      sum += std::abs(dot(planes[i].normal, planes[near[i * (near.size() / planes.size()) + m]].normal));
    }
    parallel.push_back(sum / static_cast<double>(kAdjacent));
    faced += fits.is_faced_at(i, planes[i].normal, neighbours) ? 1 : 0;
  }
  return 2 * faced < kurtosis.size() && median(kurtosis) >= fits.least_kurtosis() && median(parallel) >= kParallel;
}

// Disjoint sets whose members are on the same or on opposite sides of each other.
class SidedSets {
 public:
  explicit SidedSets(std::size_t n) : parent_(n), turned_(n, 0) { std::iota(parent_.begin(), parent_.end(), std::uint32_t{0}); }

  struct Place {
    std::uint32_t root;
    bool turned;  // against the root
  };
  [[nodiscard]] Place find(std::uint32_t i) {
    Place place{i, false};
    while (parent_[place.root] != place.root) {
      place.turned ^= turned_[place.root] != 0;
      place.root = parent_[place.root];
    }
    for (bool turned = place.turned; parent_[i] != i;) {  // the path becomes one step
      const bool rest = turned ^ (turned_[i] != 0);
      turned_[i] = turned ? 1 : 0;
      turned = rest;
      i = std::exchange(parent_[i], place.root);
    }
    return place;
  }
  void join(std::uint32_t i, std::uint32_t j, bool turned) {
    const Place a = find(i);
    const Place b = find(j);
    if (a.root == b.root) return;
    parent_[std::max(a.root, b.root)] = std::min(a.root, b.root);
    turned_[std::max(a.root, b.root)] = turned != (a.turned != b.turned) ? 1 : 0;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> turned_;  // against the parent
};

struct Edge {
  float cost;
  std::uint32_t a, b;
  bool turned;
};

// Body of a loop over the pairs of a point and its adjacent ones.
template <class Body>
void for_adjacent(const std::vector<std::uint32_t>& near, std::size_t points, const Body& body) {
  const std::size_t stride = near.size() / points;
  for (std::uint32_t i = 0; i < points; ++i) {
    for (std::size_t k = 1; k <= kAdjacent; ++k) body(i, near[i * stride + k]);
  }
}

// The component of every point, or kNone: those in which many wrong points lie side by side.
std::vector<std::uint32_t> components_of_sheets(const std::vector<std::uint32_t>& near, const std::vector<std::uint8_t>& wrong,
                                                double least_wrong) {
  const std::size_t n = wrong.size();
  DisjointSets groups(n);
  for_adjacent(near, n, [&](std::uint32_t i, std::uint32_t j) {
    if (wrong[i] != 0 && wrong[j] != 0) groups.join(i, j);
  });
  std::vector<std::size_t> size(n, 0);
  for (std::size_t i = 0; i < n; ++i) size[groups.find(i)] += wrong[i];
  if (*std::max_element(size.begin(), size.end()) < kFewestWrong) return {};
  DisjointSets components(n);
  for_adjacent(near, n, [&](std::uint32_t i, std::uint32_t j) { components.join(i, j); });
  std::vector<std::uint8_t> has_group(n, 0);
  std::vector<double> members(n, 0);
  std::vector<double> wrong_members(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t component = components.find(i);
    if (size[i] >= kFewestWrong) has_group[component] = 1;
    ++members[component];
    wrong_members[component] += wrong[i];
  }
  std::vector<std::uint32_t> sheet(n, OpenSheets::kNone);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t component = components.find(i);
    const bool is_sheet = has_group[component] != 0 && wrong_members[component] >= least_wrong * members[component];
    if (is_sheet) sheet[i] = static_cast<std::uint32_t>(component);
  }
  return sheet;
}

// By the first axis from z to x that the sum of the normals is not level to.
bool faces_down(const Vec3& sum) {
  const double size = std::max({std::abs(sum[0]), std::abs(sum[1]), std::abs(sum[2])});
  for (const std::size_t axis : {std::size_t{2}, std::size_t{1}, std::size_t{0}}) {
    if (std::abs(sum[axis]) > kLevel * size) return sum[axis] < 0;
  }
  return false;
}

// Sides of all points on sheets relative to each other: along the edges of least cost between adjacent points.
SidedSets join_sides(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near, double noise,
                     const std::vector<Plane>& planes, const std::vector<std::uint32_t>& sheet, const std::vector<std::uint8_t>& trusted,
                     const std::vector<Vec3>& normals) {
  const auto on_one_sheet = [&](std::uint32_t i, std::uint32_t j) {
    if (std::abs(dot(planes[i].normal, planes[j].normal)) < kSamePlane) return false;
    const Vec3 d = vector::subtract(points[j], points[i]);
    const double height = kSlope * std::sqrt(dot(d, d)) + 2 * noise;
    return std::abs(dot(d, planes[i].normal)) < height && std::abs(dot(d, planes[j].normal)) < height;
  };
  std::vector<Edge> edges;
  for_adjacent(near, points.size(), [&](std::uint32_t i, std::uint32_t j) {
    if (sheet[i] == OpenSheets::kNone) return;
    const double cosine = dot(trusted[i] != 0 ? normals[i] : planes[i].normal, trusted[j] != 0 ? normals[j] : planes[j].normal);
    Edge edge{static_cast<float>(1 - std::abs(cosine)), std::min(i, j), std::max(i, j), cosine < 0};
    if (trusted[i] != 0 && trusted[j] != 0 && !(edge.turned && on_one_sheet(i, j))) {
      edge.turned = false;
      edge.cost = cosine > kAgree ? -1.0F : static_cast<float>(1 - cosine);
    }
    edges.push_back(edge);
  });
  parallel::sort(edges.begin(), edges.end(),
                 [](const Edge& x, const Edge& y) { return std::tie(x.cost, x.a, x.b, x.turned) < std::tie(y.cost, y.a, y.b, y.turned); });
  SidedSets sides(points.size());
  for (const Edge& edge : edges) sides.join(edge.a, edge.b, edge.turned);
  return sides;
}

}  // namespace

OpenSheets find_open_sheets(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& known_near, const NoisyCloud* noisy,
                            std::vector<Vec3>& normals) {
  const std::size_t n = points.size();
  OpenSheets found;
  if (n < kFewestWrong) return found;
  const Planes fits(points, known_near, noisy);
  if (noisy != nullptr && !probes_find_wrong(fits, normals)) return found;
  const std::vector<std::uint32_t> own_near = noisy != nullptr ? Neighbours(points).of_all(kAround + 1) : std::vector<std::uint32_t>();
  const std::vector<std::uint32_t>& near = noisy != nullptr ? own_near : known_near;
  const std::vector<Plane> planes = fits.everywhere();
  std::vector<std::uint8_t> wrong(n);
  for (std::size_t i = 0; i < n; ++i) wrong[i] = planes[i].flat && is_wrong(planes[i].normal, normals[i]) ? 1 : 0;
  found.sheet = components_of_sheets(near, wrong, noisy == nullptr ? kLeastWrong : kLeastWrongNoisy);
  std::map<std::uint32_t, std::vector<std::uint32_t>> wrong_of;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (wrong[i] != 0 && !found.sheet.empty() && found.sheet[i] != OpenSheets::kNone) wrong_of[found.sheet[i]].push_back(i);
  }
  if (wrong_of.empty()) return {};
  const Neighbours neighbours(noisy != nullptr ? noisy->points : points);
  std::vector<std::uint8_t> is_sheet(n, 0);
  for (const auto& [sheet, some] : wrong_of) is_sheet[sheet] = is_one_sheet(fits, planes, near, neighbours, some) ? 1 : 0;
  for (std::uint32_t& sheet : found.sheet) {
    if (sheet != OpenSheets::kNone && is_sheet[sheet] == 0) sheet = OpenSheets::kNone;
  }
  if (std::all_of(found.sheet.begin(), found.sheet.end(), [](std::uint32_t s) { return s == OpenSheets::kNone; })) return {};
  // Sides are those of the given normals where these lie along plain planes, of the planes elsewhere.
  std::vector<std::uint8_t> trusted(n);
  for (std::size_t i = 0; i < n; ++i) trusted[i] = planes[i].flat && wrong[i] == 0 ? 1 : 0;
  SidedSets sides = join_sides(points, near, noisy == nullptr ? 0 : noisy->noise, planes, found.sheet, trusted, normals);
  std::vector<double> agreeing(n, 0);  // less those that do not, per set
  std::vector<double> voters(n, 0);
  std::vector<double> size(n, 0);
  std::vector<Vec3> sum(n, Vec3{0, 0, 0});
  for (std::uint32_t i = 0; i < n; ++i) {
    if (found.sheet[i] == OpenSheets::kNone) continue;
    const std::uint32_t sheet = found.sheet[i];
    const bool turned = sides.find(i).turned;
    ++size[sheet];
    Vec3 side = planes[i].normal;
    if ((trusted[i] != 0 && dot(side, normals[i]) < 0) != turned) side = vector::scale(side, -1);
    if (trusted[i] != 0) {
      agreeing[sheet] += turned ? -1 : 1;
      ++voters[sheet];
    }
    sum[sheet] = vector::add(sum[sheet], side);
    bool keeps = !planes[i].flat && std::abs(dot(side, normals[i])) > kKept;
    for (std::size_t k = 1; k <= kAround && keeps; ++k) keeps = wrong[near[i * (near.size() / n) + k]] == 0;
    normals[i] = keeps ? vector::scale(normals[i], dot(side, normals[i]) < 0 ? -1 : 1) : side;
  }
  found.certainty.assign(n, 1);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (found.sheet[i] == OpenSheets::kNone) continue;
    const std::uint32_t sheet = found.sheet[i];
    const bool decided = std::abs(agreeing[sheet]) > std::max(kDecided * voters[sheet], kFewestVotes * size[sheet]);
    if (decided ? agreeing[sheet] < 0 : faces_down(sum[sheet])) normals[i] = vector::scale(normals[i], -1);
    if (!decided) found.certainty[i] = kUndecided;
  }
  return found;
}

}  // namespace g3r
