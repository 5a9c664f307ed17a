// The steps of orient() that can be left out, by name.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <string_view>

namespace g3r {

/// In the order of the run, but for the certificate, which every solve ends with. What each does and is worth: docs/evidence/steps.md.
enum class Step {
  kViewpoint,     ///< the place is found from which one camera has seen all points, if one has
  kOutliers,      ///< points far from all others are taken out
  kNoise,         ///< the noise is estimated; without it every cloud is taken for clean
  kSites,         ///< clouds of lines are solved for on sites as far apart as the lines
  kCoarseStart,   ///< the solve starts from a solution on fewer points
  kMoreSteps,     ///< the solve goes on where many sides are unsure
  kPolish,        ///< the last iterations, with narrow kernels; without it nothing that comes after it runs
  kLocalWidths,   ///< the widths of solve and polish follow the local spacing of a clean cloud
  kOpenSurfaces,  ///< parts whose field is not that of a closed surface get their sides from their neighbours
  kApart,         ///< open surfaces and the rest are solved for apart from each other
  kJets,          ///< directions come from fitted quadratics where the points prove them
  kPlanes,        ///< directions come from planes where the points prove these
  kFacets,        ///< the points of a facet take one side
  kCreases,       ///< directions beside a crease come from the surface that holds the point
  kNoiseChoice,   ///< other noises are tried where many sides are unsure
  kProjection,    ///< noisy points are moved onto their surface, and polished there
  kNoisyJets,     ///< directions of noisy clouds come from wide quadratics
  kAreas,         ///< areas come from the density of the points instead of the solution
  kCertificate    ///< the confidence of a side is lowered where the field does not certify it
};

inline constexpr std::array<std::string_view, 19> kStepNames = {
    "viewpoint", "outliers", "noise",  "sites",   "coarse-start", "more-steps", "polish",     "local-widths", "open-surfaces", "apart",
    "jets",      "planes",   "facets", "creases", "noise-choice", "projection", "noisy-jets", "areas",        "certificate"};

using StepSet = std::bitset<kStepNames.size()>;

/// The steps of a list of names separated by commas. Throws InvalidInput that lists the names there are.
[[nodiscard]] StepSet parse_steps(std::string_view names);

/// Whether a step is one of these.
[[nodiscard]] inline bool contains(const StepSet& set, Step step) { return set.test(static_cast<std::size_t>(step)); }

}  // namespace g3r
