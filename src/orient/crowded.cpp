#include "orient/crowded.h"

#include "cloud/constants.h"

#include <algorithm>
#include <utility>

namespace g3r {

double narrowing(double relative) { return relative < kClearlyLess ? relative : 1; }

Widths narrowed(double width, const std::vector<double>& spacing, double typical) {
  if (std::all_of(spacing.begin(), spacing.end(), [&](double h) { return narrowing(h / typical) == 1; })) return Widths(width);
  std::vector<double> widths = spacing;
  for (double& h : widths) h = width * narrowing(h / typical);
  return Widths(std::move(widths));
}

}  // namespace g3r
