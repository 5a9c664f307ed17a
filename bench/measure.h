// One measurement: one model, one kind of input, one method.
#pragma once

#include <g3r/g3r.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "inputs.h"
#include "variant.h"

namespace g3r::bench {

/// Scores of the mesh made from the oriented points; lengths in units of the ground-truth mesh.
struct MeshRow {
  double chamfer = 0, ae = 0, hausdorff = 0;  ///< CD, AE_m, HD of score_mesh()
  MeshCheck check;
  double seconds = 0;      ///< wall clock
  double cpu_seconds = 0;  ///< processor time of all threads
};

/// A row of the table. Scores are over the surface points; a row with an error has none.
struct Row {
  std::string model, input, method;  ///< no method: the mesh could not be used, see error
  std::size_t points = 0;
  std::string error;       ///< empty, or why there is no result
  std::string mesh_error;  ///< empty, or why there is no mesh

  double ae = 0;                            ///< AE_p, 0..1
  double pco = 0;                           ///< 0..1
  std::array<double, 4> angle_quantiles{};  ///< angle to the true normal in degrees: 50, 90, 95, 99 %
  double confidence_auc = -1;               ///< chance that a point on the right side has the higher confidence than one on the wrong
                                            ///< side; -1 if all are on one side
  double right_and_sure = 0;                ///< share of the points that are on the right side with a confidence above 0.9
  double wrong_and_sure = 0;                ///< the same of those on the wrong side
  double outlier_confidence = -1;           ///< mean over the outliers; -1 without any
  double thin = 0;                          ///< share of Input::thin
  double wrong_thin = -1;                   ///< the same of the points on the wrong side; -1 without any
  double seconds = 0;                       ///< of orient(): all stages but the mesh, wall clock
  double cpu_seconds = 0;                   ///< of orient(): processor time of all threads
  Stats stats;
  std::optional<MeshRow> mesh;
};

/// Orients the input, scores it, and meshes it if asked to. Errors of g3r become Row::error or mesh_error.
[[nodiscard]] Row measure(const std::string& model, const Mesh& truth, const Input& input, const InputKind& kind, const Variant& variant,
                          bool with_mesh, std::uint64_t seed);

/// Chance that a random item of `high` is above a random item of `low`, ties counting half: the area under the ROC curve. O(n log n).
[[nodiscard]] double area_under_curve(std::vector<float> high, std::vector<float> low);

}  // namespace g3r::bench
