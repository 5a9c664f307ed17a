// Scores against a reference, as defined by the paper (docs/math.md): AE_p, PCO for normals; CD, AE_m, HD for meshes; and those that other
// papers report: RMSE and PGP of angles, F-scores, normal consistency.
#pragma once

#include <g3r/export.h>
#include <g3r/g3r.h>
#include <g3r/mesh.h>
#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace G3R_PUBLIC g3r {

/// Normals against true normals, both N >= 1, of any length. A zero normal counts as wrong, with error 1/2 and an angle of 90 degrees.
/// O(N). Throws InvalidInput for sizes that differ, a value that is not finite, a true normal that is zero.
struct NormalScore {
  double ae = 0;   ///< AE_p = mean (1 - n . n_true) / 2, in 0..1
  double pco = 0;  ///< share of points with n . n_true > 0, in 0..1
  std::size_t points = 0;
  double rmse = 0;             ///< root of the mean square of the angle to the true normal, degrees
  double rmse_unoriented = 0;  ///< the same to the true line, of any side (Guerrero et al., "PCPNet", 2018)
  double pgp5 = 0;             ///< share of points less than 5 degrees from the true line, in 0..1
  double pgp10 = 0;            ///< the same of 10 degrees
};
[[nodiscard]] NormalScore score_normals(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth);

/// At a distance d: `precision`, the share of the samples of the mesh within d of the truth, `recall`, that of the truth within d of the
/// mesh, and `f`, their harmonic mean (Knapitsch et al., "Tanks and Temples", 2017); all in 0..1.
struct FScore {
  double distance = 0;
  double precision = 0;
  double recall = 0;
  double f = 0;
};

/// What score_mesh() samples and asks.
struct MeshScoreOptions {
  std::size_t samples = 200000;        ///< points on each mesh, uniform by area, at least 1
  std::uint64_t seed = 0;              ///< of the points
  std::vector<double> distances = {};  ///< of the F-scores, in mesh units, above 0
};

/// Mesh against true mesh, both sampled. Exact closest points; lengths in mesh units. O((F + samples) log F).
/// Throws InvalidInput for a mesh that sample_mesh() does not take, an option out of range; Cancelled.
struct MeshScore {
  double chamfer = 0;             ///< CD: mean of the two one-sided mean distances to the other surface
  double ae = 0;                  ///< AE_m: mean (1 - n . n') / 2 over the same closest pairs, both directions
  double hausdorff = 0;           ///< HD: largest distance, both directions
  double normal_consistency = 0;  ///< mean |n . n'| over the pairs of AE_m (Mescheder et al., "Occupancy Networks", 2019)
  std::vector<FScore> f_scores;   ///< one for every distance, in their order
};
[[nodiscard]] MeshScore score_mesh(const Mesh& mesh, const Mesh& truth, const MeshScoreOptions& options = {}, const Monitor& monitor = {});

/// Points on a mesh, uniform by area, with the normals of their triangles.
struct Samples {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
};
/// `noise`: standard deviation of an isotropic Gaussian displacement, in mesh units. The same seed gives the same bytes everywhere,
/// and the same points under any noise. Triangles without area get none. O(F + count log F).
/// Throws InvalidInput for a mesh without area, or with a triangle whose vertex does not exist, is not finite or beyond 1e50; Cancelled.
[[nodiscard]] Samples sample_mesh(const Mesh& mesh, std::size_t count, std::uint64_t seed, double noise = 0, const Monitor& monitor = {});

}  // namespace g3r
