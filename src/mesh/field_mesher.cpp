#include "mesh/field_mesher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "base/median.h"
#include "base/whole_bytes.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "g3r/error.h"
#include "mesh/fair.h"
#include "mesh/field_contour.h"
#include "mesh/field_denoise.h"
#include "mesh/field_local_fit.h"
#include "mesh/field_octree.h"
#include "mesh/field_placement.h"
#include "mesh/handle_removal.h"
#include "mesh/mesh_finish.h"
#include "mesh/side_smoothing.h"
#include "mesh/smooth_spacing.h"
#include "mesh/untangle.h"

namespace g3r {
namespace {

using mesh::LocalFit;
using mesh::LocalFitOptions;
using mesh::LocalSurface;
using mesh::Octree;
using mesh::Opinions;
using mesh::OrientedPoints;
using mesh::RefineDisc;

constexpr std::size_t kNear = 28;  // neighbours kept of each point; the 16 nearest to a place are nearly always among those of its nearest
constexpr double kCell = 0.8;      // finest cell, in median spacings
constexpr double kDisc = 1.4;      // spacings: radius of the disc around each point that is refined; spans the holes of random sampling
constexpr double kDiscHalf = 0.3;  // spacings: its half thickness; covers curvature within the disc
constexpr double kMargin = 1.15;   // side of the octree over the longest side of the bounding box, at least
constexpr int kBaseLevel = 4;      // coarsest leaves
constexpr int kMaxSpread = 4;      // levels that locally dense or sparse sampling may add or take away
constexpr double kLocalReach = 1.8;          // spacings from the nearest point within which the fitted surface gives the side
constexpr double kThin = 1.3;                // walls and gaps get cells of at most their thickness over this,
constexpr double kMaxThin = 2.0;             // but not smaller than a normal cell over this
constexpr double kLeastSpacing = 1e-2;       // of the median; clusters of almost equal points are no denser for the fits than this
constexpr std::size_t kLevelPoints = 10000;  // the median of so many values is good to 1 % of their scatter
constexpr double kNoisy = 0.15;              // spacings: positions that scatter more than this are smoothed first
constexpr double kFieldSure = 0.2;           // |w - level| from which the field overrules the fitted surface
constexpr double kBeyond = 0.05;             // of the longest side: so far from the box of the points
constexpr double kBeyondSpacings = 2;        // (and so many spacings) all is outside; fast sums end there, single ones are slow

constexpr std::size_t kCornersAtOnce = std::size_t{1} << 17;  // of which more than the side is kept in memory,
constexpr std::size_t kAskedPerPoint = 2;  // and of whose field is asked at once: few, and the points are summed anew each time

constexpr double kFitSay = 2 * kFieldSure;  // in opinions the field counts 2 (w - level), the fitted surface at most this,
constexpr double kFitFar = 0.3;             // and that from so many spacings away
constexpr double kFlipped = 0.1;            // spacings: distance from the surface of corners that were flipped to remove a handle

constexpr double kBaseBytes = 26 << 20;  // code, libraries (those of E57 are a third), thread stacks;
constexpr double kBytesPerPoint = 500;   // with those of the winding field;
constexpr double kBytesPerLeaf = 210;    // measured, docs/evidence/meshes.md,
constexpr double kBytesPerThin = 430;    // for those that thin walls and gaps add: most of their corners are in doubt
constexpr double kBytesPerAsked = 200;   // and for all where the depth is given;
constexpr double kPlainLeaves = 8.5;     // per point of a shape without thin walls: 5.7 to 8.6 measured,
constexpr double kLeavesPerPoint = 9.5;  // and what is planned
constexpr double kThickness = 0.75;      // of the refined layer, in cells of the automatic depth,
constexpr double kLayers = 2;            // and cells around it whatever their size

// A way to read the opinions: after so many averagings, at some level.
struct Reading {
  std::size_t averagings;
  double level;
};
constexpr std::array<Reading, 6> kReadings{{{2, 0}, {0, 0}, {1, 0.2}, {1, -0.2}, {1, 0.5}, {1, -0.5}}};

// What a proposal may change: fewer corners in a group, and so smaller ones that can be taken, if it goes one way only.
enum class Way { kBoth, kFill, kCut };

void report(const Monitor& monitor, double fraction) {
  if (monitor.cancel != nullptr && monitor.cancel->load()) throw Cancelled();
  if (monitor.progress && !monitor.progress("mesh", fraction)) throw Cancelled();
}

// What the fits see of the cloud.
struct Prepared {
  OrientedPoints points;                         // positions that scatter are moved onto the surface they scatter about
  std::unique_ptr<const Neighbours> neighbours;  // of these positions
  std::vector<std::uint32_t> near;               // of_all(kNear)
  double noise = 0;                              // of the positions as they came, in spacings; 0 where it is too little to tell
};

// In place: the neighbours refer to the positions.
void prepare(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const Length& given_noise, const Monitor& monitor,
             Prepared& prepared) {
  OrientedPoints& out = prepared.points;
  out = {points, normals, {}};
  const auto find_neighbours = [&] {
    prepared.neighbours = std::make_unique<Neighbours>(out.positions);
    prepared.near = prepared.neighbours->of_all(kNear);
  };
  find_neighbours();
  out.spacing = mesh::smooth_spacing(out.positions, prepared.near);
  for (Vec3& n : out.normals) {
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) throw InvalidInput("a normal is zero");
    for (double& c : n) c /= length;
  }
  const double typical = median(out.spacing);
  if (!(typical > 0)) throw InvalidInput("all points are at one place");
  for (double& h : out.spacing) h = std::max(h, kLeastSpacing * typical);
  mesh::Noise noise = mesh::estimate_noise(out, *prepared.neighbours);
  if (given_noise.unit != Length::Unit::kAuto) noise.position = given_noise.value / typical;
  report(monitor, 0.05);
  if (noise.position > kNoisy) {
    prepared.noise = noise.position;
    mesh::denoise(out, *prepared.neighbours, noise, monitor.cancel);
    find_neighbours();
  }
}

// Of the points, or evenly many of them: the median of the field there is its level on the surface.
std::vector<Vec3> level_places(const std::vector<Vec3>& points) {
  const std::size_t count = std::min(points.size(), kLevelPoints);
  std::vector<Vec3> places(count);
  for (std::size_t i = 0; i < count; ++i) places[i] = points[static_cast<std::size_t>(std::uint64_t{i} * points.size() / count)];
  return places;
}

// `depth`: 0 for the automatic one.
std::size_t memory_for(std::size_t points, double leaves, int depth) {
  const double plain = std::min(leaves, kPlainLeaves * static_cast<double>(points));
  const double octree = depth > 0 ? kBytesPerAsked * leaves : kBytesPerLeaf * plain + kBytesPerThin * (leaves - plain);
  return whole_bytes(kBaseBytes + kBytesPerPoint * static_cast<double>(points) + octree);
}

struct Box {
  Vec3 low, high;
  [[nodiscard]] double longest() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }
  [[nodiscard]] double centre(std::size_t a) const { return 0.5 * (low[a] + high[a]); }
};

Box box_of(const std::vector<Vec3>& points) {
  Box box{points[0], points[0]};
  for (const Vec3& p : points) {
    for (std::size_t a = 0; a < 3; ++a) box.low[a] = std::min(box.low[a], p[a]), box.high[a] = std::max(box.high[a], p[a]);
  }
  return box;
}

// `thickness`: of the walls at each point, empty to disregard it.
Octree make_octree(const OrientedPoints& points, const std::vector<double>& thickness, const MeshOptions& options, const Monitor& monitor) {
  const Box box = box_of(points.positions);
  const double h = median(points.spacing);
  double side = box.longest() * kMargin + 8 * h;
  int level = options.depth;
  if (level == 0) {
    level = std::clamp(static_cast<int>(std::ceil(std::log2(side / (kCell * h)))), kBaseLevel, mesh::kMaxOctreeLevel);
    side = std::max(side, kCell * h * std::exp2(level));
  }
  Vec3 corner{};
  for (std::size_t a = 0; a < 3; ++a) corner[a] = box.centre(a) - 0.5 * side;
  std::vector<RefineDisc> requests(points.positions.size());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    double size = points.spacing[i];
    if (!thickness.empty() && thickness[i] < kThin * kCell * size) size = std::max(thickness[i] / (kThin * kCell), size / kMaxThin);
    const int spread = static_cast<int>(std::lround(std::log2(h / size)));
    const int wanted = level + std::clamp(spread, -kMaxSpread, options.depth == 0 ? kMaxSpread : 0);
    const double reach = std::min(points.spacing[i], h * std::exp2(kMaxSpread));  // its leaves are no larger
    requests[i] = {points.positions[i], points.normals[i], kDisc * reach, kDiscHalf * reach,
                   std::clamp(wanted, kBaseLevel, mesh::kMaxOctreeLevel)};
  }
  return Octree(corner, side, requests, std::min(kBaseLevel, level), monitor.cancel);
}

void require_memory_for(std::size_t points, const Octree& octree, int depth, std::size_t max_memory) {
  const std::size_t needed = memory_for(points, static_cast<double>(octree.leaf_count()), depth);
  if (max_memory == 0 || needed <= max_memory) return;
  throw Unavailable("the mesh needs " + std::to_string(needed >> 20U) + " MiB, the limit is " + std::to_string(max_memory >> 20U) +
                    " MiB; raise the limit, lower the depth or thin the cloud");
}

// The corners of an octree.
struct Corners {
  std::vector<float> value;  // of each: positive inside, about minus the distance to the surface
  Opinions opinions;         // of those that could be on either side
};

// Which side of the surface places are on: a positive value inside. Near the points it is minus the distance to the fitted surface,
// unless the field is sure of the contrary; elsewhere it is the field, scaled to a length.
class Side {
 public:
  Side(const LocalFit& local, const FieldSampler& sampler, const OrientedPoints& points)
      : local_(local),
        sampler_(sampler),
        spacing_(median(points.spacing)),
        box_(box_of(points.positions)),
        asked_at_once_(std::max(kCornersAtOnce, kAskedPerPoint * points.positions.size())) {
    reach_ = 0.5 * box_.longest() + std::max(kBeyond * box_.longest(), kBeyondSpacings * spacing_);
    std::vector<double> field;
    sampler_.sample(level_places(points.positions), field, nullptr);
    level_ = median(std::move(field));
  }

  [[nodiscard]] Corners of(const Octree& octree, const std::atomic<bool>* cancel) const {
    Corners corners;
    corners.value.resize(octree.corner_count());
    std::vector<Place> places;
    std::vector<Asked> asked;
    for (std::size_t first = 0; first < corners.value.size(); first += kCornersAtOnce) {
      places.resize(std::min(corners.value.size() - first, kCornersAtOnce));
      parallel::for_blocks(
          places.size(), 256,
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) places[i] = fit_at(octree.corner_position(first + i));
          },
          cancel);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const auto c = static_cast<std::uint32_t>(first + i);
        const Place& place = places[i];
        corners.value[c] = place.value;
        if (place.kind == Place::kUnknown) asked.push_back({c, kNoOpinion});
        if (place.kind != Place::kDoubtful) continue;
        asked.push_back({c, static_cast<std::uint32_t>(corners.opinions.corner.size())});
        corners.opinions.add(c, place.opinion, place.axis);
      }
      if (asked.size() < asked_at_once_) continue;
      ask_field(octree, asked, corners);
      asked.clear();
    }
    ask_field(octree, asked, corners);
    return corners;
  }

  // By the fitted surface alone; outside where there is none.
  [[nodiscard]] std::vector<std::uint8_t> by_fit(const std::vector<Vec3>& places) const {
    std::vector<std::uint8_t> inside(places.size());
    parallel::for_blocks(places.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Eigen::Vector3d x(places[i][0], places[i][1], places[i][2]);
        const LocalSurface fit = local_.fit(x, kLocalReach, nullptr, LocalFit::Detail::kSide);
        inside[i] = fit.count > 0 && fit.distance(x) < 0 ? 1 : 0;
      }
    });
    return inside;
  }

 private:
  struct Place {
    enum Kind : std::uint8_t { kSure, kDoubtful, kUnknown };
    Kind kind = kSure;
    float value = 0;
    float opinion = 0;
    std::array<float, 3> axis{};
  };
  static constexpr std::uint32_t kNoOpinion = std::numeric_limits<std::uint32_t>::max();
  struct Asked {
    std::uint32_t corner;
    std::uint32_t opinion;  // its place among the opinions, or kNoOpinion
  };

  [[nodiscard]] Place fit_at(const Vec3& at) const {
    const Eigen::Vector3d x(at[0], at[1], at[2]);
    const LocalSurface fit = local_.fit(x, kLocalReach, nullptr, LocalFit::Detail::kSide);
    Place place;
    if (fit.count == 0) {
      place.kind = is_beyond(at) ? Place::kSure : Place::kUnknown;
      place.value = static_cast<float>(-spacing_);
      return place;
    }
    const double value = -fit.distance(x);
    place.value = static_cast<float>(value);
    if (fit.simple) return place;
    place.kind = Place::kDoubtful;
    place.opinion = static_cast<float>(kFitSay * std::clamp(value / (kFitFar * fit.spacing), -1.0, 1.0));
    for (std::size_t a = 0; a < 3; ++a) place.axis[a] = static_cast<float>(fit.sheet[0].frame(2, static_cast<Eigen::Index>(a)));
    return place;
  }

  void ask_field(const Octree& octree, const std::vector<Asked>& asked, Corners& corners) const {
    std::vector<Vec3> queries(asked.size());
    for (std::size_t k = 0; k < asked.size(); ++k) queries[k] = octree.corner_position(asked[k].corner);
    std::vector<double> field;
    sampler_.sample(queries, field, nullptr);
    for (std::size_t k = 0; k < asked.size(); ++k) {
      const double f = field[k] - level_;
      float& value = corners.value[asked[k].corner];
      const bool known = asked[k].opinion != kNoOpinion;
      if (!known || (std::abs(f) >= kFieldSure && (value > 0) != (f > 0))) value = static_cast<float>(f * spacing_);
      if (!known) continue;
      float& opinion = corners.opinions.side[asked[k].opinion];
      opinion = static_cast<float>(std::clamp(2 * f + opinion, -1.0, 1.0));
    }
  }

  [[nodiscard]] bool is_beyond(const Vec3& x) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::abs(x[a] - box_.centre(a)) > reach_) return true;
    }
    return false;
  }

  const LocalFit& local_;
  const FieldSampler& sampler_;
  double spacing_;
  Box box_;
  std::size_t asked_at_once_;
  double reach_ = 0;  // half the side of the cube that everything inside is in
  double level_ = 0;  // of the field on the surface
};

// Reads the doubtful signs in other ways where that leaves fewer handles. Returns whether any was changed.
bool remove_handles(const Octree& octree, const Opinions& opinions, const mesh::InsideTest& centre_inside,
                    std::vector<std::uint8_t>& inside, const mesh::DualSurface& surface, const std::atomic<bool>* cancel) {
  if (mesh::count_handles(surface) == 0) return false;
  const std::vector<std::vector<float>> averages = mesh::smooth_sides(octree, opinions, inside, 2, cancel);
  const auto sign = [&](const Reading& reading, std::uint32_t place) -> std::uint8_t {
    const std::vector<float>& side = reading.averagings == 0 ? opinions.side : averages[reading.averagings - 1];
    return side[place] > reading.level ? 1 : 0;
  };
  std::vector<std::uint8_t> in_doubt(inside.size(), 0);
  std::vector<std::uint32_t> doubtful;  // places among the opinions
  for (std::uint32_t k = 0; k < opinions.corner.size(); ++k) {
    const std::uint32_t c = opinions.corner[k];
    if (octree.on_boundary(c)) continue;
    if (std::all_of(kReadings.begin(), kReadings.end(), [&](const Reading& r) { return sign(r, k) == inside[c]; })) continue;
    in_doubt[c] = 1;
    doubtful.push_back(k);
  }
  mesh::HandleRemoval removal(octree, in_doubt, inside, surface, centre_inside, cancel);
  bool changed = false;
  for (const Reading& reading : kReadings) {
    for (const Way way : {Way::kBoth, Way::kFill, Way::kCut}) {
      if (removal.handles() == 0) return changed;
      std::vector<std::uint8_t> proposal = inside;
      for (const std::uint32_t k : doubtful) {
        const std::uint8_t now = sign(reading, k);
        if (way == Way::kBoth || (now != 0) == (way == Way::kFill)) proposal[opinions.corner[k]] = now;
      }
      changed = removal.propose(proposal, inside) || changed;
    }
  }
  return changed;
}

// Steps 2 to 6: all that they hold but the mesh is gone when its crossings are searched for.
Mesh raw_mesh(const Prepared& prepared, const FieldSampler& sampler, const MeshOptions& options, const Monitor& monitor,
              std::size_t max_memory) {
  const OrientedPoints& oriented = prepared.points;
  const double spacing = median(oriented.spacing);
  const LocalFit local(oriented, *prepared.neighbours, prepared.near, LocalFitOptions{});
  const Octree octree =
      make_octree(oriented, prepared.noise > 0 ? std::vector<double>{} : mesh::wall_thickness(oriented, prepared.near), options, monitor);
  require_memory_for(oriented.positions.size(), octree, options.depth, max_memory);
  report(monitor, 0.3);
  const Side side(local, sampler, oriented);
  Corners corners = side.of(octree, monitor.cancel);
  std::vector<float>& value = corners.value;
  std::vector<std::uint8_t> inside(value.size());
  for (std::size_t c = 0; c < value.size(); ++c) inside[c] = value[c] > 0 && !octree.on_boundary(c) ? 1 : 0;
  report(monitor, 0.6);

  const auto centre_inside = [&](const std::vector<Vec3>& centres) { return side.by_fit(centres); };
  mesh::DualSurface surface = mesh::contour(octree, inside, centre_inside, monitor.cancel);
  if (remove_handles(octree, corners.opinions, centre_inside, inside, surface, monitor.cancel)) {
    surface = {};
    surface = mesh::contour(octree, inside, centre_inside, monitor.cancel);
  }
  corners.opinions = {};
  for (std::size_t c = 0; c < inside.size(); ++c) {
    if ((value[c] > 0) != (inside[c] != 0) && !octree.on_boundary(c))
      value[c] = static_cast<float>((inside[c] != 0 ? kFlipped : -kFlipped) * spacing);
  }
  report(monitor, 0.7);
  mesh::PlacedVertices placed = mesh::place_vertices(octree, surface, value, local, monitor.cancel);
  report(monitor, 0.95);
  return mesh::triangulate(surface, std::move(placed.positions), placed.normals);
}

}  // namespace

std::size_t field_mesh_memory(std::size_t points, double spacing, double longest_side, int depth) {
  double leaves = kLeavesPerPoint;
  if (depth > 0 && longest_side > 0) {
    const double finer = kCell * spacing * std::exp2(depth) / (kMargin * longest_side + 8 * spacing);
    leaves *= std::max(1.0, finer * finer * (kThickness * finer + kLayers) / (kThickness + kLayers));
  }
  return memory_for(points, leaves * static_cast<double>(points), depth);
}

Mesh field_mesh(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const FieldSampler& sampler, const MeshOptions& options,
                const Monitor& monitor, std::size_t max_memory, mesh::LeftOut* left_out) {
  if (points.size() != normals.size()) throw InvalidInput("points and normals differ in number");
  if (points.size() < 4) throw InvalidInput("a mesh needs at least 4 points");
  if (options.depth != 0 && (options.depth < 4 || options.depth > 12)) throw InvalidInput("mesh depth must be 4 to 12");
  report(monitor, 0);
  Prepared prepared;
  prepare(points, normals, options.noise, monitor, prepared);
  report(monitor, 0.2);
  Mesh mesh = raw_mesh(prepared, sampler, options, monitor, max_memory);
  mesh::make_fair(mesh, prepared.points.positions, mesh::points_in_lines(prepared.points.positions, prepared.near), monitor.cancel);
  prepared.neighbours.reset();
  std::vector<std::uint32_t>().swap(prepared.near);  // not only emptied
  mesh::untangle(mesh, monitor.cancel);
  mesh::LeftOut nothing;
  mesh::finish_mesh(mesh, prepared.points.positions, prepared.points.spacing, prepared.noise, options,
                    left_out != nullptr ? *left_out : nothing);
  report(monitor, 1);
  return mesh;
}

}  // namespace g3r
