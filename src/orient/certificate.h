// Whether the sides of normals are right, from their own field: no truth is needed.
#pragma once

#include "cloud/sites.h"
#include "sum/sum_plan.h"

#include <g3r/points.h>

#include <atomic>
#include <vector>

namespace g3r {

/// What the winding field w of normals n_i with the areas of their sites says at every site p_i, by probes p_i +- d m_i at d = 1, 2 and 4
/// spacings, m_i the axis of the site on the side of n_i: normals that lie in the surface do not choose their own probes
/// (docs/math.md, "Certificate"):
///   - `jump`, the largest over d of w(p_i - d m_i) - w(p_i + d m_i): 1 wherever the sides around p_i agree, on closed surfaces and on open
///     ones (Gauss's jump relation of the double layer), about 0 or less where they do not;
///   - `jump_defect`, the mean over d of |1 - that difference|;
///   - `scaled_defect`, the same of c w, with c such that the median of c w inside (w > 1/2, far from any site) is 1, where there is any:
///     areas of even samples and of points that scatter are up to 1.3 times too large, and 1 - jump_defect is 0.8 at best there;
///   - `unrest`, the mean over d = 2, 4 and 8 of min(|c w|, |1 - c w|): 0 beside a closed surface, whose field is
///     constant on either side, up to a half beside an open one. Probes nearer to a site than 1.9 spacings, or farther than `reach`, are
///     left out; negative if none is left.
struct Certificate {
  std::vector<double> jump;
  std::vector<double> jump_defect;
  std::vector<double> scaled_defect;
  std::vector<double> unrest;
};

/// `normals`: of the sites, unit vectors. `reach`: of every site, the size of its part; farther away the field of any part is 0. Eight
/// evaluations of the field at all sites. Throws Cancelled. O(M log M).
[[nodiscard]] Certificate certify(const Sites& sites, const std::vector<Vec3>& normals, const std::vector<double>& reach,
                                  const SumPlan& sums, const std::atomic<bool>* cancel);

/// Certificate::jump_defect alone, of each of several hypotheses.
struct JumpDefects {
  std::vector<std::vector<double>> all;
  /// Over the distances alone at which both probes of a site are nearer to it than to another surface: no site is half as far from them.
  /// Beyond the next surface the field is that one's, and its jump says nothing of the sides here. Negative where there is none.
  std::vector<std::vector<double>> own;
};
/// `hypotheses`: the normals that they have; six evaluations of the field of each.
[[nodiscard]] JumpDefects jump_defects(const Sites& sites, std::vector<std::vector<Vec3>> hypotheses, const SumPlan& sums,
                                       const std::atomic<bool>* cancel);

/// Whether sides of the first mean jump defect are shown to be better than those of the second, of the same sites: by half of the defect,
/// or by the chance of the others. A defect is the chance that a side is wrong, and where one of the two is right it is the second's with
/// the chance (1 - than) defect / ((1 - than) defect + than (1 - defect)): at most kFalseAlarms where those jump nowhere, however little
/// the first are certain of. Single lines of soundings have 0.50 to 0.57 instead of 0.99; the sides of thin wires, which are right, 0.94,
/// and those of their neighbours 0.62.
[[nodiscard]] bool is_shown_better(double defect, double than);

}  // namespace g3r
