// The clouds that the benchmark measures on: samples of a ground-truth mesh, made worse in a named way. README.md defines each kind.
// Source of the six conditions pcpnet:NAME: Guerrero, Kleiman, Ovsjanikov, Mitra, "PCPNet: Learning Local Shape Properties from Raw Point
// Clouds", Computer Graphics Forum 37(2), 2018, doi 10.1111/cgf.13343. Its test set has 100,000 points of every shape: without noise, with
// Gaussian noise of 0.12, 0.6 and 1.2 percent of the diagonal of the bounding box, and without noise but of a density that falls from one
// end to the other (gradient) or is high and low by turns (stripes). How much denser, and in how many stripes, is not published: here it is
// 10 to 1, and five stripes of each kind along the longest side of the box.
#pragma once

#include <g3r/mesh.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace g3r::bench {

/// Mesh files of a folder, sorted by name, or only those named in `models` (file names without extension), in that order. Throws
/// InvalidInput when there is none.
[[nodiscard]] std::vector<std::filesystem::path> find_models(const std::string& folder, const std::vector<std::string>& models);

/// How a cloud is made from a mesh.
struct InputKind {
  enum class Defect { kNone, kNoise, kOutliers, kGradient, kStripes, kPatches };
  std::string name;  ///< as given, for example "noise:0.5"
  Defect defect = Defect::kNone;
  double value = 0;
  std::size_t points = 5000;  ///< where nobody says how many
};

/// "clean", "noise:P" (standard deviation in percent of the box diagonal), "outliers:P" (percent of the points), "gradient:R" (ratio of the
/// highest to the lowest density), "stripes:R" (the same, in bands), "patches:K" (number of holes), "pcpnet:NAME" with NAME one of clean,
/// 0.12, 0.6, 1.2, stripes, gradient. Throws InvalidInput for anything else.
[[nodiscard]] InputKind parse_input_kind(const std::string& text);

/// Each of several; "pcpnet" stands for its six.
[[nodiscard]] std::vector<InputKind> parse_input_kinds(const std::vector<std::string>& texts);

inline constexpr double kThinSpacings = 1.5;  ///< nearly all wrong sides are this near another one: docs/evidence/thin_parts.md
inline constexpr double kThinDeviations = 4;  ///< of the noise

/// N points with their true normals.
struct Input {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;  ///< one per surface point
  std::size_t surface = 0;    ///< points [0, surface) belong to the surface, the rest are outliers
  double noise = 0;           ///< standard deviation of the displacement
  /// For every surface point, whether a wall or a gap there is too thin for this sample: another surface point, whose true normal is more
  /// than 120 degrees away, lies within kThinSpacings or kThinDeviations.
  std::vector<bool> thin;
};

/// Samples `count` points. Depends on the mesh, kind, count and seed only, and is the same bytes on every machine. Throws InvalidInput like
/// sample_mesh().
[[nodiscard]] Input make_input(const Mesh& mesh, const InputKind& kind, std::size_t count, std::uint64_t seed);

}  // namespace g3r::bench
