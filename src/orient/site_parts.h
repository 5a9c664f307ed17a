// The connected parts of a cloud on the finest scale of its certificate, and what the field says of them.
#pragma once

#include "cloud/point_set.h"
#include "cloud/sites.h"
#include "orient/certificate.h"
#include "sum/sum_plan.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Sites of the finest scale of the certificate, at most: more take more time and say no more about sides.
inline constexpr std::size_t kMostSites = 200000;

/// Gives back the neighbours of more points than that: sums that follow take more than these do. Up to there the certificate takes more
/// than both.
void make_room_for_sums(const PointSet& set);

/// The least distance of the sites of that scale, of a cloud of so many points with this typical spacing and noise (same unit, that of the
/// result); 0: every point is one. O(1).
[[nodiscard]] double site_distance(std::size_t points, double spacing, double noise);

/// Mean of `value` over the given sites, negative values being left out; 0 where there is no other.
[[nodiscard]] double mean_over(const std::vector<std::uint32_t>& sites, const std::vector<double>& value);

/// The sites of that scale and the parts that adjacent ones (adjacent_sites()) hang together in. Parts are numbered by their first sites.
class SiteParts {
 public:
  /// `set`: kept by reference; `noise`: standard deviation; `sums`, `cancel`: for the fields. O(N log N).
  SiteParts(const PointSet& set, double noise, const SumPlan& sums, const std::atomic<bool>* cancel);

  [[nodiscard]] const PointSet& set() const { return set_; }
  [[nodiscard]] const Sites& sites() const { return sites_; }
  /// Whether the sites are fewer than the points for the sake of the noise, whatever the number of points.
  [[nodiscard]] bool thinned_for_noise() const { return thinned_for_noise_; }
  [[nodiscard]] std::size_t count() const { return members_.size(); }
  /// The sites of a part, ascending.
  [[nodiscard]] const std::vector<std::uint32_t>& members(std::size_t part) const { return members_[part]; }
  [[nodiscard]] std::uint32_t of_point(std::size_t i) const { return part_[sites_.site_of[i]]; }

  /// mean_over() the sites of every part.
  [[nodiscard]] std::vector<double> means(const std::vector<double>& value) const;

  /// The certificate of normals of the N points (certify()). The size of a part is that of a square of as many sites.
  [[nodiscard]] Certificate test(const std::vector<Vec3>& normals) const;

  /// jump_defects() of several normals of the N points.
  [[nodiscard]] JumpDefects jump_defects(const std::vector<std::vector<Vec3>>& hypotheses) const;

  /// Twice the mean of w at some sites, w of these alone: 1 on a closed surface, 0 on a plane, -1 on one inside out. `normals`: of all
  /// sites.
  [[nodiscard]] double enclosure(const std::vector<std::uint32_t>& some, const std::vector<Vec3>& normals) const;

 private:
  const PointSet& set_;
  SumPlan sums_;
  const std::atomic<bool>* cancel_;
  Sites sites_;
  bool thinned_for_noise_;
  std::vector<std::uint32_t> part_;                  // of every site
  std::vector<std::vector<std::uint32_t>> members_;  // the sites of every part
  std::vector<double> reach_;                        // of every site: half the side of that square
};

}  // namespace g3r
