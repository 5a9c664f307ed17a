#include "mesh/separate_vertices.h"

#include "base/suits_float.h"
#include "base/vector.h"
#include "cpu/parallel_sort.h"
#include "mesh/constants.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>
#include <vector>

namespace g3r::mesh {
namespace {

constexpr double kFloatStep = std::numeric_limits<float>::epsilon();

using Place = std::array<float, 3>;

// Where vertices are once rounded to float about an origin.
class Rounding {
 public:
  explicit Rounding(const Vec3& origin) : origin_(origin) {}

  [[nodiscard]] Place of(const Vec3& v) const {
    Place place{};
    for (std::size_t a = 0; a < 3; ++a) {
      constexpr double kMost = std::numeric_limits<float>::max();
      place[a] = static_cast<float>(std::clamp(v[a] - origin_[a], -kMost, kMost));
    }
    return place;
  }

  // The step of float at the largest coordinate.
  [[nodiscard]] double step(const Vec3& v) const {
    const Vec3 d = vector::subtract(v, origin_);
    return kFloatStep * std::max({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2]), double{std::numeric_limits<float>::min()}});
  }

  // Takes all places and marks the vertices, all but the first, that share one.
  void take(const std::vector<Vec3>& vertices, std::vector<std::uint8_t>& shared) {
    std::vector<std::pair<Place, std::uint32_t>> places(vertices.size());
    for (std::uint32_t v = 0; v < places.size(); ++v) places[v] = {of(vertices[v]), v};
    parallel::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a < b; });
    taken_.reserve(places.size());
    for (const auto& [place, v] : places) {
      if (!taken_.empty() && taken_.back() == place) {
        shared[v] = 1;
      } else {
        taken_.push_back(place);
      }
    }
  }
  void take(const Vec3& v) { added_.insert(of(v)); }
  [[nodiscard]] bool is_free(const Vec3& v) const {
    const Place place = of(v);
    return !std::binary_search(taken_.begin(), taken_.end(), place) && added_.count(place) == 0;
  }

 private:
  Vec3 origin_;
  std::vector<Place> taken_;  // ascending
  std::set<Place> added_;
};

// What a vertex that moves has around it.
struct Around {
  Vec3 normal{0, 0, 0};
  double shortest = HUGE_VAL;  // edge of some length
};

// For the marked vertices, by their order.
std::vector<Around> look_around(const Mesh& mesh, const std::vector<std::uint8_t>& marked, const std::vector<std::uint32_t>& vertices) {
  std::vector<Around> out(vertices.size());
  for (const auto& t : mesh.triangles) {
    if (marked[t[0]] == 0 && marked[t[1]] == 0 && marked[t[2]] == 0) continue;
    std::array<Vec3, 3> side{};
    for (std::size_t k = 0; k < 3; ++k) side[k] = vector::subtract(mesh.vertices[t[(k + 1) % 3]], mesh.vertices[t[k]]);
    const Vec3 normal = vector::cross(side[0], side[1]);
    for (std::size_t k = 0; k < 3; ++k) {
      if (marked[t[k]] == 0) continue;
      Around& around = out[static_cast<std::size_t>(std::lower_bound(vertices.begin(), vertices.end(), t[k]) - vertices.begin())];
      around.normal = vector::add(around.normal, normal);
      for (const std::size_t s : {k, (k + 2) % 3}) {
        const double length = std::hypot(side[s][0], side[s][1], side[s][2]);
        if (length > 0) around.shortest = std::min(around.shortest, length);
      }
    }
  }
  return out;
}

// Inwards first: where two parts of a solid touch, they part. False if no place is free.
bool move(const Around& around, std::vector<Rounding>& roundings, Vec3& vertex) {
  Vec3 normal = vector::normalised(around.normal);
  if (normal == Vec3{0, 0, 0}) normal = {1, 0, 0};
  double step = 0;  // a move by less than one may round to the old place
  for (const Rounding& rounding : roundings) step = std::max(step, rounding.step(vertex));
  // So little of the shortest edge turns no triangle over.
  for (double length = 2 * step; length <= kAtOnePlace * around.shortest; length *= 2) {
    for (const double way : {-length, length}) {
      const Vec3 to = vector::add(vertex, vector::scale(normal, way));
      if (!std::all_of(roundings.begin(), roundings.end(), [&](const Rounding& r) { return r.is_free(to); })) continue;
      for (Rounding& rounding : roundings) rounding.take(to);
      vertex = to;
      return true;
    }
  }
  return false;
}

}  // namespace

std::size_t separate_vertices(Mesh& mesh) {
  vector::Box box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  if (mesh.vertices.empty()) return 0;
  std::vector<Rounding> roundings{Rounding(box.centre())};
  if (suits_float(box)) roundings.emplace_back(Vec3{0, 0, 0});
  std::vector<std::uint8_t> shared(mesh.vertices.size(), 0);
  for (Rounding& rounding : roundings) rounding.take(mesh.vertices, shared);
  std::vector<std::uint32_t> movers;
  for (std::uint32_t v = 0; v < shared.size(); ++v) {
    if (shared[v] != 0) movers.push_back(v);
  }
  if (movers.empty()) return 0;
  const std::vector<Around> around = look_around(mesh, shared, movers);
  std::size_t moved = 0;
  for (std::size_t k = 0; k < movers.size(); ++k) moved += move(around[k], roundings, mesh.vertices[movers[k]]) ? 1 : 0;
  return moved;
}

}  // namespace g3r::mesh
