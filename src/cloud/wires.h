// Whether samples that look like lines are wires.
#pragma once

#include "cloud/point_set.h"

namespace g3r {

/// Whether the points that lie along lines with their neighbours lie around these lines, as on wires and bars: such lines are surfaces, and
/// not the samples of one. Seen along it a wire is as broad as thick and empty in its middle, what noise makes of a line is not: within
/// half of their root mean square distance from the axis are 1 - e^(-1/4) = 0.22 of points of normal noise (Rayleigh distribution) and 1/8
/// of those of a round disk, and of no density that falls from the middle fewer. Midway between the two decides, and a lesser spread across
/// the line of half the greater (measured: 0.06 to 0.10 on clean tubes of 0.4 spacings and more across, up to 0.16 where they bend within
/// 12 points, 0.20 to 0.31 on noisy contours). Looks at the 12 nearest of some 2000 points, where their breadth is less than a half
/// (kClearlyLess) and they are farther from the line than rounding moves them; false where there are none. O(N log N).
[[nodiscard]] bool are_wires(const PointSet& set);

}  // namespace g3r
