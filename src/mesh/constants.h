// Counts and lengths that several steps of the mesher share, each with one meaning.
#pragma once

#include "cloud/spacing.h"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace g3r::mesh {

/// No point, vertex, triangle or leaf.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
/// The tasks that a walk through a tree is cut into, whatever the number of threads, so that their order is always the same: fewer leave
/// threads idle.
inline constexpr std::size_t kTasks = 256;
/// The nearest points that tell what a place is like are those that the spacing is defined by: more reach across thin walls.
inline constexpr std::size_t kRing = kClosest;
/// The points of a fit, the nearest ones to the place: a quadratic has six numbers and normals double the data; more reach across walls.
inline constexpr std::size_t kFitPoints = 2 * kRing;
/// Cosine of two normals, 32 degrees, up to which points are on one patch of a LocalSurface: creases of CAD models turn more, and smooth
/// surfaces less from one point to the next, with the noise that the normals of an oriented cloud may have. (For exact points: kSamePatch.)
inline constexpr double kSameLocalPatch = 0.85;
/// The points of a patch beside a point that make it one: corners of cubes have so many, fewer are noise, and random points have one.
inline constexpr std::size_t kPatchPoints = 3;
/// The points of a cloud, or pairs of them, below which nothing is said of what is rare in it: it would be a matter of chance.
inline constexpr std::size_t kFewestPoints = 100;
/// The share of a whole that is little beside it, and that nearly all of it has: of a variance, of the misfit of a surface, of pairs; of
/// heights, of points.
inline constexpr double kLittle = 0.05;
inline constexpr double kNearlyAll = 0.9;
/// The share of a length up to which it is rounding.
inline constexpr double kRounding = 1e-9;
/// The side of the leaves around points of a clean cloud, in typical spacings: smaller ones add vertices and no detail, larger ones lose
/// some.
inline constexpr double kFinestCell = 0.8;
/// Half of the widest gap between points of a random sample of a surface, in spacings: the disc around a point that is refined, as the
/// holes of the sample would be coarse with less, and the distance up to which surface is held by it.
inline constexpr double kGap = 1.4;
/// The half thickness in spacings of the disc around each point whose leaves are refined: the surface curves away from the tangent plane by
/// so much within it.
inline constexpr double kDiscHalf = 0.3;
/// The noise in spacings that counts as none, twice of which is within the disc: fits hide less of it by themselves, and smoothing would
/// round detail.
inline constexpr double kNoisy = kDiscHalf / 2;
/// The spacings beyond which surface without a point is a guess.
inline constexpr double kFarSpacings = 4;
/// The share of a length (the side of a leaf or the spacing, which differ little, or an edge) up to which two places are one. A vertex on a
/// crease may leave its leaf by so much: with none, a crease between two leaves is in neither. Nearer ones of two leaves would coincide,
/// and one steps aside. A point is on the joined surface up to it: patches may cross where they do not meet. And surface crosses no edge
/// nearer to an end than this: triangles would be slivers.
inline constexpr double kAtOnePlace = 0.05;
/// The cosine below which two directions are rather square to each other, 73 degrees, and the sine below which they are rather parallel, 17
/// degrees: sharp edges of a fit turn less, and surfaces that meet in a crease turn more.
inline constexpr double kSlant = 0.3;
/// The cosine of 45 degrees, from which a direction is rather along another than across it.
inline constexpr double kAlong = 0.7;
/// The rings of triangles or vertices around a place that feel what is changed there: with one ring gears come out otherwise, with two they
/// do not.
inline constexpr int kRings = 3;
/// The share of the way to the mean of its neighbours that a vertex goes where surface is smoothed: with all of it, neighbours swing about
/// each other.
inline constexpr double kSmoothingStep = 0.5;

}  // namespace g3r::mesh
