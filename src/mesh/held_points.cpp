#include "mesh/held_points.h"

#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace g3r::mesh {
namespace {

using vector::dot;

// The height over the distance up to which two points are on one patch, at both: random directions have less once among the points of a
// ring.
const double kSlope = 1 / std::sqrt(static_cast<double>(kRing));
// One stray in so many seems to be held by the one next to it, measured 1 in 4 to 1 in 50. It decides how many points a part needs: with
// less, strays become parts, with more, small parts are lost.
constexpr double kLooksLikeSurface = 4;

// How two points see each other.
struct Look {
  double height;    // the greater distance from the plane of the other
  bool bends;       // whether the patch may go on round a bend
  double distance;  // between the points
};

// The nearest of a point, nearest first, and the distance of the last.
struct Ring {
  std::array<std::uint32_t, kRing> near{};
  double reach = 0;
};

double upper_median(std::array<double, kRing> values) {
  std::nth_element(values.begin(), values.begin() + kRing / 2, values.end());
  return values[kRing / 2];
}

double quantile(std::vector<double> values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

class Search {
 public:
  Search(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::atomic<bool>* cancel)
      : points_(points), normals_(normals), cancel_(cancel), held_(points.size(), 1), rings_(points.size()), doubtful_(points.size()) {
    std::iota(doubtful_.begin(), doubtful_.end(), std::uint32_t{0});
  }
  Search(const PointSet& set, const std::vector<Vec3>& normals, const std::atomic<bool>* cancel) : Search(set.points(), normals, cancel) {
    known_ = &set;
  }

  // Strays that hold each other go one after the other, until all that are left are held. `usual`: of the cloud, where it is known.
  std::vector<std::uint8_t> run(std::optional<double> usual) {
    look();
    own_.reset();  // few clouds need it again, and the heights their room
    usual_ = usual ? *usual : usual_height();
    for (take_strays(); !doubtful_.empty(); take_strays()) look();
    return std::move(held_);
  }
  [[nodiscard]] double usual() const { return usual_; }

 private:
  // From every doubtful point at those nearest to it that are still held.
  void look() {
    if (held_.size() - static_cast<std::size_t>(std::count(held_.begin(), held_.end(), std::uint8_t{0})) <= kRing) {
      doubtful_.clear();
      return;
    }
    const bool all_near_known = known_ != nullptr && doubtful_.size() == points_.size();  // at first, while all are held
    const std::uint32_t* const near = all_near_known ? known_->near().data() : nullptr;
    const Neighbours* const neighbours = all_near_known ? nullptr : &tree();
    const auto look_from = [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> index;
      std::vector<double> squared;
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t i = doubtful_[k];
        if (all_near_known) {
          set_ring(i, near + i * known_->near_count());
        } else {
          neighbours->nearest_marked(points_[i], kRing + 1, held_, index, squared);
          set_ring(i, index.data());
        }
      }
    };
    parallel::for_blocks(doubtful_.size(), parallel::kSmallBlock, look_from, cancel_);
  }

  [[nodiscard]] const Neighbours& tree() {
    if (known_ != nullptr) return known_->tree();
    if (!own_) own_.emplace(points_);
    return *own_;
  }

  // `near`: the kRing + 1 nearest, as a rule with the point itself.
  void set_ring(std::uint32_t i, const std::uint32_t* near) {
    Ring& ring = rings_[i];
    std::size_t to = 0;
    for (std::size_t m = 0; m <= kRing && to < kRing; ++m) {
      if (near[m] != i) ring.near[to++] = near[m];
    }
    const Vec3 d = vector::subtract(points_[ring.near[kRing - 1]], points_[i]);
    ring.reach = std::sqrt(dot(d, d));
  }

  [[nodiscard]] Look look_at(std::uint32_t i, std::uint32_t j) const {
    const Vec3 d = vector::subtract(points_[i], points_[j]);
    const double squared = dot(d, d), a = dot(d, normals_[i]), b = dot(d, normals_[j]);
    return {std::max(std::abs(a), std::abs(b)), dot(normals_[i], normals_[j]) - 2 * a * b / squared > kSameLocalPatch, std::sqrt(squared)};
  }

  [[nodiscard]] double usual_height() const {
    std::vector<double> heights(rings_.size());
    parallel::for_blocks(rings_.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::array<double, kRing> height{};
        for (std::size_t m = 0; m < kRing; ++m) height[m] = look_at(static_cast<std::uint32_t>(i), rings_[i].near[m]).height;
        heights[i] = upper_median(height);
      }
    });
    return quantile(std::move(heights), kNearlyAll);  // up to a tenth of the points may be strays, and do not change it
  }

  // On the patch a point may be twice as high as usual: about four standard deviations of noise. It is alone where its spacing is twice
  // that of its nearest ones: 1.5 times is the most in a thousand points of uneven surfaces.
  [[nodiscard]] bool is_stray(std::uint32_t i) const {
    const Ring& ring = rings_[i];
    std::size_t holding = 0;
    double spacing = 0;  // mean logarithm
    for (const std::uint32_t j : ring.near) {
      const Look look = look_at(i, j);
      holding += look.bends || look.height <= kSlope * look.distance + 2 * usual_ ? 1 : 0;
      spacing += std::log(rings_[j].reach) / kRing;
    }
    return holding < kPatchPoints || std::log(ring.reach) - spacing > std::log(2);
  }

  // Those that had one among their nearest are doubtful after.
  void take_strays() {
    std::vector<std::uint8_t> stray(doubtful_.size(), 0);
    parallel::for_blocks(
        doubtful_.size(), parallel::kSmallBlock,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) stray[k] = is_stray(doubtful_[k]) ? 1 : 0;
        },
        cancel_);
    std::size_t count = 0;
    for (std::size_t k = 0; k < stray.size(); ++k) {
      if (stray[k] == 0) continue;
      held_[doubtful_[k]] = 0;
      ++count;
    }
    doubtful_.clear();
    for (std::uint32_t i = 0; count > 0 && i < points_.size(); ++i) {
      const auto& near = rings_[i].near;
      if (held_[i] != 0 && std::any_of(near.begin(), near.end(), [this](std::uint32_t j) { return held_[j] == 0; })) doubtful_.push_back(i);
    }
  }

  const std::vector<Vec3>& points_;
  const std::vector<Vec3>& normals_;
  const std::atomic<bool>* cancel_;
  const PointSet* known_ = nullptr;  // the points, where more is known of them
  std::optional<Neighbours> own_;    // where it is not
  std::vector<std::uint8_t> held_;
  std::vector<Ring> rings_;
  std::vector<std::uint32_t> doubtful_;  // points whose nearest ones have changed
  double usual_ = 0;
};

double share_of_strays(const std::vector<std::uint8_t>& held) {
  return static_cast<double>(std::count(held.begin(), held.end(), std::uint8_t{0})) / static_cast<double>(held.size());
}

template <class Points>
std::vector<std::uint8_t> held_among(const Points& points, const std::vector<Vec3>& normals, const std::atomic<bool>* cancel) {
  if (points.size() < kFewestPoints) return std::vector<std::uint8_t>(points.size(), 1);
  std::vector<std::uint8_t> held = Search(points, normals, cancel).run({});
  if (share_of_strays(held) > kMostStrays) std::fill(held.begin(), held.end(), 1);
  return held;
}

}  // namespace

std::vector<std::uint8_t> held_points(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::atomic<bool>* cancel) {
  return held_among(points, normals, cancel);
}

std::vector<std::uint8_t> held_points(const PointSet& set, const std::vector<Vec3>& normals, const std::atomic<bool>* cancel) {
  return held_among(set, normals, cancel);
}

CloudHeights cloud_heights(const std::vector<Vec3>& points, const std::vector<Vec3>& normals) {
  if (points.size() < kFewestPoints) return {};
  Search search(points, normals, nullptr);
  const std::vector<std::uint8_t> held = search.run({});
  return {search.usual(), share_of_strays(held)};
}

std::vector<std::uint8_t> held_points(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const CloudHeights& cloud,
                                      const std::atomic<bool>* cancel) {
  if (points.size() < kFewestPoints || cloud.stray_share > kMostStrays) return std::vector<std::uint8_t>(points.size(), 1);
  return Search(points, normals, cancel).run(cloud.usual);
}

double least_points_of_a_part(std::size_t strays) {
  return strays == 0 ? 0 : 1 + std::log(static_cast<double>(strays) / kFalseAlarms) / std::log(kLooksLikeSurface);
}

}  // namespace g3r::mesh
