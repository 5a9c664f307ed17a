// The clouds that the benchmark measures on: samples of a ground-truth mesh, made worse in a named way. README.md defines each kind.
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
  enum class Defect { kNone, kNoise, kOutliers, kGradient, kPatches };
  std::string name;  ///< as given, for example "noise:0.5"
  Defect defect = Defect::kNone;
  double value = 0;
};

/// "clean", "noise:P" (standard deviation in percent of the box diagonal), "outliers:P" (percent of the points), "gradient:R" (ratio of the
/// highest to the lowest density), "patches:K" (number of holes). Throws InvalidInput for anything else.
[[nodiscard]] InputKind parse_input_kind(const std::string& text);

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
