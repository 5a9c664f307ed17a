#include "orient/certificate.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "orient/crowded.h"
#include "orient/settings.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace g3r {
namespace {

// Distances of the probes beside a site, 1, 2, 4 and 8 spacings: walls are seen at the smaller ones, at which the jump is looked at,
// emptiness at the larger.
constexpr std::size_t kProbes = kScales + 1;
double distance_of(std::size_t probe) { return std::ldexp(1.0, static_cast<int>(probe)); }

// The winding number on a surface, by mathematics.
constexpr double kOnSurface = 0.5;
// Spacings from any site from which a probe is quiet, so that the field there knows of no single ones: with 2 the probe's own site, which
// is at 2 by rounding, would count against it.
constexpr double kQuiet = 1.9;

// The field of the sites with the normals of several hypotheses, at probes on either side of them. It has the width of the equations:
// single sites are not seen at the nearest probes, walls of a spacing are.
class Probed {
 public:
  Probed(const Sites& sites, std::vector<std::vector<Vec3>> hypotheses, const SumPlan& sums, const std::atomic<bool>* cancel)
      : sites_(sites),
        cancel_(cancel),
        field_(sites.points(), narrowed(kEpsilon * sites.set.spacing(), sites.set.smoothed_spacing(), sites.set.spacing()), sums, cancel),
        etas_(std::move(hypotheses)),
        axis_(sites.axis) {
    for (std::size_t i = 0; i < axis_.size(); ++i) {
      const double side = sites.side(i);
      if (vector::dot(etas_.front()[i], axis_[i]) < 0) axis_[i] = vector::scale(axis_[i], -1);
      for (std::vector<Vec3>& eta : etas_) eta[i] = vector::scale(eta[i], side * side);
    }
  }

  // So many spacings behind every site, then before every site, as the first hypothesis has it.
  [[nodiscard]] std::vector<Vec3> at(double distance) const {
    const std::size_t count = axis_.size();
    std::vector<Vec3> probes(2 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 step = vector::scale(axis_[i], distance * sites_.spacing()[i]);
      probes[i] = vector::subtract(sites_.points()[i], step);
      probes[count + i] = vector::add(sites_.points()[i], step);
    }
    return probes;
  }

  // Of every hypothesis at the probes, behind every site and then before it, as that one has it.
  [[nodiscard]] std::vector<std::vector<double>> windings(const std::vector<Vec3>& probes) const {
    std::vector<std::vector<double>> w = field_.windings_at(etas_, probes, cancel_);
    const std::size_t count = axis_.size();
    for (std::size_t h = 1; h < w.size(); ++h) {
      for (std::size_t i = 0; i < count; ++i) {
        if (vector::dot(etas_[h][i], axis_[i]) < 0) std::swap(w[h][i], w[h][count + i]);
      }
    }
    return w;
  }

 private:
  const Sites& sites_;
  const std::atomic<bool>* cancel_;
  FastSum field_;
  std::vector<std::vector<Vec3>> etas_;
  std::vector<Vec3> axis_;  // on the side of the first hypothesis
};

// Adds to the mean over all distances of |1 - jump| that of one, of the field times a factor.
void add_defects(const std::vector<double>& w, double factor, std::vector<double>& defect) {
  const std::size_t count = defect.size();
  for (std::size_t i = 0; i < count; ++i) defect[i] += std::abs(1 - factor * (w[i] - w[count + i])) / static_cast<double>(kScales);
}

// Which of the probes so many spacings beside the sites are nearer to their own than to another surface: no site is clearly nearer.
std::vector<std::uint8_t> are_own(const Sites& sites, const std::vector<Vec3>& probes, double distance) {
  const std::size_t count = sites.size();
  const Neighbours& tree = sites.set.tree();
  std::vector<std::uint8_t> own(probes.size());
  parallel::for_blocks(probes.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      own[k] = tree.any_within(probes[k], kClearlyLess * distance * sites.spacing()[k % count]) ? 0 : 1;
    }
  });
  return own;
}

// Which of the probes so many spacings beside the sites are quiet, and no farther away than `reach`, one for each site.
std::vector<std::uint8_t> are_quiet(const Sites& sites, const std::vector<Vec3>& probes, double distance,
                                    const std::vector<double>& reach) {
  const std::size_t count = sites.size();
  const std::vector<double>& spacing = sites.spacing();
  const Neighbours& tree = sites.set.tree();
  std::vector<std::uint8_t> quiet(probes.size(), 0);
  parallel::for_blocks(probes.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const double h = spacing[k % count];
      quiet[k] = distance * h <= reach[k % count] && !tree.any_within(probes[k], kQuiet * h) ? 1 : 0;
    }
  });
  return quiet;
}

// The field at the probes of one distance.
struct AtDistance {
  std::vector<double> winding;
  std::vector<std::uint8_t> is_quiet;  // of the probes; empty: none is
};

// Areas are known up to a factor near 1, those of points that scatter are too large, of a grid too small: inside, w is 1. The factor that
// makes it so; 1 where no quiet probe is inside.
double factor_of_areas(const std::array<AtDistance, kProbes>& field) {
  std::vector<double> inside;
  for (const AtDistance& at : field) {
    for (std::size_t k = 0; k < at.is_quiet.size(); ++k) {
      if (at.is_quiet[k] != 0 && at.winding[k] > kOnSurface) inside.push_back(at.winding[k]);
    }
  }
  return inside.empty() ? 1 : 1 / median(inside);
}

// Certificate::unrest of `count` sites.
std::vector<double> unrest_of(const std::array<AtDistance, kProbes>& field, double factor, std::size_t count) {
  std::vector<double> unrest(count, 0);
  std::vector<double> quiet(count, 0);
  for (const AtDistance& at : field) {
    for (std::size_t k = 0; k < at.is_quiet.size(); ++k) {
      if (at.is_quiet[k] == 0) continue;
      const double value = factor * at.winding[k];
      unrest[k % count] += std::min(std::abs(value), std::abs(1 - value));
      ++quiet[k % count];
    }
  }
  for (std::size_t i = 0; i < count; ++i) unrest[i] = quiet[i] > 0 ? unrest[i] / quiet[i] : -1;
  return unrest;
}

}  // namespace

JumpDefects jump_defects(const Sites& sites, std::vector<std::vector<Vec3>> hypotheses, const SumPlan& sums,
                         const std::atomic<bool>* cancel) {
  const std::size_t count = sites.size();
  const std::vector<std::vector<double>> none(hypotheses.size(), std::vector<double>(count, 0));
  JumpDefects out{none, none};
  if (hypotheses.empty()) return out;
  const Probed probed(sites, std::move(hypotheses), sums, cancel);
  std::vector<double> looked(count, 0);
  for (std::size_t d = 0; d < kScales; ++d) {
    const std::vector<Vec3> probes = probed.at(distance_of(d));
    const std::vector<std::uint8_t> own = are_own(sites, probes, distance_of(d));
    const std::vector<std::vector<double>> w = probed.windings(probes);
    for (std::size_t h = 0; h < w.size(); ++h) add_defects(w[h], 1, out.all[h]);
    for (std::size_t i = 0; i < count; ++i) {
      if (own[i] == 0 || own[count + i] == 0) continue;
      ++looked[i];
      for (std::size_t h = 0; h < w.size(); ++h) out.own[h][i] += std::abs(1 - (w[h][i] - w[h][count + i]));
    }
  }
  for (std::vector<double>& defect : out.own) {
    for (std::size_t i = 0; i < count; ++i) defect[i] = looked[i] > 0 ? defect[i] / looked[i] : -1;
  }
  return out;
}

Certificate certify(const Sites& sites, const std::vector<Vec3>& normals, const std::vector<double>& reach, const SumPlan& sums,
                    const std::atomic<bool>* cancel) {
  const std::size_t count = sites.size();
  const Probed probed(sites, {normals}, sums, cancel);
  Certificate out;
  out.jump.assign(count, -HUGE_VAL);
  out.jump_defect.assign(count, 0);
  out.scaled_defect.assign(count, 0);
  std::array<AtDistance, kProbes> field;
  for (std::size_t d = 0; d < kProbes; ++d) {
    const std::vector<Vec3> probes = probed.at(distance_of(d));
    field[d].winding = std::move(probed.windings(probes).front());
    const std::vector<double>& w = field[d].winding;
    if (d > 0) field[d].is_quiet = are_quiet(sites, probes, distance_of(d), reach);  // at the first its own site is too near
    if (d >= kScales) continue;
    add_defects(w, 1, out.jump_defect);
    for (std::size_t i = 0; i < count; ++i) out.jump[i] = std::max(out.jump[i], w[i] - w[count + i]);
  }
  const double factor = factor_of_areas(field);
  for (std::size_t d = 0; d < kScales; ++d) add_defects(field[d].winding, factor, out.scaled_defect);
  out.unrest = unrest_of(field, factor, count);
  return out;
}

bool is_shown_better(double defect, double than) {
  if (defect >= than || defect >= 1) return false;
  const double first = (1 - defect) * than;
  const double second = defect * std::max(0.0, 1 - than);
  return defect <= kClearlyLess * than || second <= kFalseAlarms * (first + second);
}

}  // namespace g3r
