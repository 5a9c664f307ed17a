#include "cloud/disk_sample.h"

#include "base/vector.h"
#include "cloud/morton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace g3r {
namespace {

// The points taken so far, in cells as wide as the distance: what is nearer than that lies in the same cell or in an adjacent one.
class TakenPoints {
 public:
  explicit TakenPoints(double distance) : cell_(distance) {}

  // Takes point i if none that has been taken is nearer than the distance; returns whether it did.
  bool take_if_alone(const std::vector<Vec3>& points, std::uint32_t i) {
    const auto is_near = [&](std::uint32_t j) {
      const Vec3 d = vector::subtract(points[i], points[j]);
      return vector::dot(d, d) < cell_ * cell_;
    };
    if (!taken_.empty() && is_near(last_)) return false;  // as half of them are, in Morton order
    std::array<std::int64_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<std::int64_t>(std::floor(points[i][a] / cell_));
    for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x) {
      for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y) {
        for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z) {
          const auto found = taken_.find(key({x, y, z}));
          if (found == taken_.end()) continue;
          if (std::any_of(found->second.begin(), found->second.end(), is_near)) return false;
        }
      }
    }
    taken_[key(at)].push_back(i);
    last_ = i;
    return true;
  }

 private:
  // Different cells may have the same key, which costs time only.
  static std::uint64_t key(const std::array<std::int64_t, 3>& at) {
    std::uint64_t key = 0;
    for (const std::int64_t i : at) key = (key << kGridBits) ^ static_cast<std::uint64_t>(i);
    return key;
  }

  double cell_;
  std::uint32_t last_ = 0;  // the point that was taken last
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> taken_;
};

}  // namespace

std::vector<Vec3> disk_sample(const std::vector<Vec3>& points, double distance) {
  std::vector<Vec3> sample;
  TakenPoints taken(distance);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (taken.take_if_alone(points, i)) sample.push_back(points[i]);
  }
  return sample;
}

}  // namespace g3r
