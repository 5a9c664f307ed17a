// WNNC: normals that agree with the gradient of their own winding field.
//
// Source: Lin, Shi, Liu, "Fast and Globally Consistent Normal Orientation based on the Winding Number Normal Consistency", ACM Trans.
// Graph. 43(6), 2024, and the authors' published program for the widths. Per iteration, with a hard cut-off width that falls linearly:
//   r = W^T (1/2 - W eta),  eta += |r|^2/|W r|^2 r           one steepest-descent step with exact line search on |W eta - 1/2|^2
//   n_i = -grad w (x_i) / |grad w (x_i)|,  eta_i = |eta_i| n_i
// The normals are the n of the last iteration. Their program normalises as g3r does (longest side 2/1.1), so its widths are in our unit
// box; its sums are a treecode of order 0, ours are as accurate as the plan says.
#pragma once

#include "base/stages.h"
#include "sum/sum_plan.h"

#include <g3r/points.h>

#include <cstdint>
#include <string>
#include <vector>

namespace g3r {

inline constexpr int kWnncIterations = 40;

/// Cut-off widths of the first and the last iteration, in units of the points.
struct WnncWidths {
  double widest = 0;
  double narrowest = 0;
};

/// By name. Relative to the spacing h: "density" (or "") 2.8 h to 0.35 h. The authors', in the unit box: "clean" 0.016 to 0.002, "scan"
/// 0.04 to 0.01, "noise-0.25" 0.08 to 0.02, "noise-0.5" 0.12 to 0.03, "noise-1" 0.16 to 0.04 (noise in percent of the box diagonal),
/// "sparse" 0.2 to 0.05. Throws InvalidInput for another name.
[[nodiscard]] WnncWidths wnnc_widths(const std::string& name, double spacing);

struct WnncResult {
  std::vector<Vec3> eta;          ///< after the last descent step, before its direction is replaced
  std::vector<Vec3> normals;      ///< N unit vectors
  std::vector<double> strength;   ///< N: |grad w|
  std::vector<double> residuals;  ///< |1/2 - W eta| / |1/2| before each descent step
};

/// Points in canonical order with their Morton codes. Four sums per iteration. Throws Cancelled.
[[nodiscard]] WnncResult solve_wnnc(const std::vector<Vec3>& points, const WnncWidths& widths, const SumPlan& plan, Stages& stages);

}  // namespace g3r
