// Numbers that several fits share, each with one meaning.
#pragma once

#include <cstddef>
#include <numbers>

namespace g3r {

/// Of a size, up to which another one is clearly less: neither chance nor shape halves what should be as large.
inline constexpr double kClearlyLess = 0.5;
/// Of votes or values, a majority that noise, hidden and grazing points do not make.
inline constexpr double kMostOf = 2.0 / 3;
/// Points of less breadth (middle principal spread over the largest) lie along a line: it has planes all around, and any slope across it
/// fits.
inline constexpr double kLineBreadth = 0.15;
/// Cosine of two normals, 26 degrees, from which they are of one smooth patch: creases turn more, and smooth surfaces less from one point
/// to the next.
inline constexpr double kSamePatch = 0.9;
/// Cosine of two normals, 60 degrees, from which they are of one side of a surface: across an edge or under noise they differ as much.
inline constexpr double kSameSide = 0.5;
/// Standard deviations from a surface within which its points lie, all but one in 80: fewer leave some out, more let in others.
inline constexpr double kSigmas = 2.5;
/// Standard deviations from one side of a noisy layer to the other.
inline constexpr double kNoiseBreadth = 2 * kSigmas;
/// From one scale to the next, of spacings, scatter and the widths that go with them.
inline constexpr double kLevelRatio = 2;
/// From one reach of a fit to the next, twice its area; over an estimate of noise, what is clearly more than it.
inline constexpr double kWider = std::numbers::sqrt2;
/// Scales, each kLevelRatio times as coarse as the one before, on which a surface is looked at: on fewer, noise, gaps between lines and
/// strays hide it, on more it bends.
inline constexpr std::size_t kScales = 3;
/// On the squares of the unknowns of a fit, relative: points on a line leave some of them open. Above rounding, and far below what moves a
/// fit.
inline constexpr double kRidge = 1e-9;
/// Places of a cloud that stand for all where a median or a quantile of all is wanted: of fewer it would vary with the choice.
inline constexpr std::size_t kPlaces = 2000;
/// The same where each costs a hundred times as much.
inline constexpr std::size_t kFewPlaces = 500;
/// Nearest points that say what a surface is like at a place: fewer follow the noise or the sampling, more reach across walls.
inline constexpr std::size_t kPatchNeighbours = 12;
/// As many of each where they may be of two surfaces.
inline constexpr std::size_t kTwoPatches = 2 * kPatchNeighbours;
/// A neighbourhood is no larger part of a cloud than one in so many points: larger ones follow its shape.
inline constexpr std::size_t kSmallPart = 16;
/// Points of a cloud, at least, for neighbourhoods to be small parts of it: of fewer nothing is said about noise, dimension and sensors.
inline constexpr std::size_t kFewestSurfacePoints = kSmallPart * kPatchNeighbours;
/// So many times as many points of a surface reach twice as far.
inline constexpr std::size_t kTwiceAsFar = 4;
/// Reach in spacings of Gaussian weights over near points: without them CAD models have up to 1.13 times the error.
inline constexpr double kWeightReach = 1.5;
/// Points for every number of a fit to noisy points, at least: of fewer it follows the noise.
inline constexpr std::size_t kPerTerm = 2;
/// Monomials of u and v up to a degree: the numbers of a height field.
constexpr std::size_t terms_of(std::size_t degree) { return (degree + 1) * (degree + 2) / 2; }
/// Numbers of a plane.
inline constexpr std::size_t kPlaneTerms = terms_of(1);
/// Numbers of a quadratic height field, 1, u, v, u^2, uv, v^2: one point more says how far they are off.
inline constexpr std::size_t kQuadraticTerms = terms_of(2);
/// Those beside the constant, which layers of one surface share: an index, as matrices are indexed.
inline constexpr std::ptrdiff_t kVaryingTerms = kQuadraticTerms - 1;
/// Rounds in which points look for the layer that they are of, at most: most change theirs 4 times, and more cost time only.
inline constexpr int kLayerRounds = 20;
/// Numbers of a cubic height field, whose residuals follow the noise on more points than those of a quadratic.
inline constexpr std::size_t kCubicTerms = terms_of(3);

}  // namespace g3r
