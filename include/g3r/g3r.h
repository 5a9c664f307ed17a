// g3r: from an unoriented point cloud to globally consistent outward normals and a watertight mesh.
//
//   g3r::Orientation o = g3r::orient(points);            // unit normals, same order and count as the points
//   g3r::Reconstruction r = g3r::reconstruct(points);    // the same, and a mesh
//
// Method: Wu, Xiao, Chen, "Surface Reconstruction via Green's 3rd Identity", SIGGRAPH 2026,
// doi 10.1145/3799902.3811154. Formulas and signs: docs/math.md.
#pragma once

#include <g3r/error.h>
#include <g3r/export.h>
#include <g3r/hints.h>
#include <g3r/mesh.h>
#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace G3R_PUBLIC g3r {

/// A named set of defaults. Every option that is set explicitly wins over the preset.
enum class Preset {
  kDefault,  ///< the best normals we know how to make
  kPaper     ///< the published method: 20 steepest-descent + 60 conjugate-gradient steps, no refinement; epsilon at least 0.15 spacings
};

/// Which equations are solved. All have the true normals as their solution; docs/math.md derives green and energy. The last three are
/// earlier methods on the same sums, to compare with: src/baselines says what each does and where it differs from its paper.
enum class Method {
  kAuto,    ///< the preset's: energy by default, green in the paper preset
  kGreen,   ///< least squares over Green's identity for all harmonics, as published
  kEnergy,  ///< the identities centred at every point: Stokes single layer energy plus winding number 1/2
  kWnnc,    ///< winding number normal consistency (Lin et al. 2024): 40 steps; see Options::wnnc_widths
  kAgr,     ///< Gauss formula in three stretched frames, damped least squares (after Ma et al. 2024)
  kPgr      ///< Gauss formula alone, damped least squares (Lin et al. 2022)
};

/// How the linear system is solved.
enum class Solver {
  kAuto,              ///< dense for small inputs under the paper preset, conjugate gradients otherwise
  kDense,             ///< assemble the 3N x 3N normal matrix and factor it; O(N^2) memory, O(N^3) time
  kConjugateGradient  ///< matrix-free iterations
};

/// A length in one of several units, or the automatic one.
struct Length {
  enum class Unit {
    kAuto,       ///< chosen from the cloud
    kInput,      ///< units of the input coordinates
    kPercent,    ///< percent of the bounding box diagonal
    kSpacing,    ///< multiples of the point spacing h
    kNormalised  ///< units of the normalised box, whose longest side is 2/1.1 (the paper's units)
  };
  Unit unit = Unit::kAuto;
  double value = 0;  ///< ignored if `unit` is kAuto
};

/// Progress and cancellation. Both are optional; both may be used from another thread.
struct Monitor {
  /// Called on the calling thread as (stage, fraction in [0, 1]); returning false cancels.
  std::function<bool(std::string_view stage, double fraction)> progress;
  /// When it becomes true the running call stops within a fraction of a second and throws Cancelled.
  const std::atomic<bool>* cancel = nullptr;
};

/// All parameters of orient(). The defaults work for every input; 0 and "" mean automatic.
struct Options {
  Preset preset = Preset::kDefault;
  Method method = Method::kAuto;
  Length epsilon;  ///< width of the Gaussian mollifier of the Laplace kernel, > 0
  /// Standard deviation of the points from their surface, of each coordinate; 0: clean. Method energy only. If it is given, reconstruct()
  /// hands it to the field mesher.
  Length noise;
  int degree = -1;          ///< of method green, which giving one selects: highest degree of the harmonic polynomials, 0..8; -1: 2
  std::string harmonics;    ///< subset instead of a degree: "1,x,y,z", "degree:0-2", "x,y,z,xy"
  std::string wnnc_widths;  ///< method wnnc: "density", or the authors' "clean", "scan", "noise-0.25", "noise-0.5", "noise-1", "sparse"
  Solver solver = Solver::kAuto;
  std::string schedule;   ///< iterations, for example "20 sd 60 cg"
  double tolerance = -1;  ///< stop when the relative residual of the normal equations falls below; 0: never; -1: preset's
  double accuracy = -1;   ///< relative l2 error allowed in the sums, 1e-6..1e-1; 0: direct sums; -1: 1e-2, or 2e-2 where that is enough
  bool condition_number = false;  ///< also compute the condition number; throws InvalidInput unless the solver is dense
  int threads = 0;                ///< 0: all cores. The result does not depend on it
  /// Where the sums run: "cpu"; "gpu", the first GPU; "gpu:N", number N of compute_devices(); "auto": the first GPU if there is one and the
  /// points are many enough, else, or if it fails, the processor. A GPU's result differs in the last digits. Throws Unavailable if the
  /// device that is asked for is not there or fails.
  std::string device = "auto";
  std::string without;  ///< names of steps to leave out, separated by commas, for ablations (docs/evidence/steps.md lists them)
  std::size_t max_memory =
      0;  ///< bytes; refuse before the solve when the plan exceeds it, or before the mesh when that turns out to. 0: no limit
  Hints hints;
};

/// One step of the iterative solver.
struct Iteration {
  std::string kind;     ///< "sd", "cg" or "wnnc"
  double residual = 0;  ///< |A^T (b - A eta)| / |A^T b| after the step; wnnc: |1/2 - W eta| / |1/2| before it
};

/// What was done and how it went; report_json() writes it out. Lengths in input units unless said otherwise.
struct Stats {
  std::size_t points = 0;  ///< given
  std::size_t used = 0;    ///< distinct finite points solved for
  std::size_t dropped_non_finite = 0;
  std::size_t outliers = 0;           ///< left out of the solve; their area and confidence are 0
  std::size_t merged_duplicates = 0;  ///< points beyond the first at the same place
  Vec3 box_centre{0, 0, 0};
  double box_side = 0;  ///< longest side of the bounding box
  double spacing = 0;   ///< typical distance between neighbours, square root of area per point
  double noise = 0;     ///< standard deviation of the points from their surface, estimated unless given; 0: clean
  double epsilon = 0;
  int depth = 0;  ///< octree depth that the mesher was given; 0: the automatic one, or no mesh
  std::string preset;
  std::string method;
  std::string solver;     ///< "dense", "cg" or "wnnc"
  std::string harmonics;  ///< the functions used, for example "degree:0-2"
  std::string sums;       ///< "direct" or "hierarchical"
  double accuracy = 0;
  std::vector<Iteration> iterations;
  double tolerance = 0;
  bool converged = false;  ///< the last residual is 0.1 at most, or the tolerance if one is given; or nothing depends on it, as all is open
  bool consistent = true;  ///< false: more than a fifth of the points could face either way: there may be no clear inside
  bool doubtful = false;   ///< a warning says that the result is most likely not what was measured, though the solver found no fault
  double open_share = 0;   ///< share of the points, 0..1, on open surfaces; all, if they are to face what has seen them
  double undecided_share = 0;  ///< of all points, those on open surfaces either side of which could be the outside, after the hints
  HintStats hints;
  double condition_number = 0;  ///< 0 unless asked for
  double confidence_mean = 0;
  double confidence_below_half = 0;                     ///< share of the points, 0..1
  std::vector<std::pair<std::string, double>> seconds;  ///< per stage, in order
  std::size_t planned_memory_bytes = 0;                 ///< of reconstruct(): with the field mesher; shapes of thin walls take more
  std::size_t peak_memory_bytes = 0;                    ///< of the whole process
  int threads = 0;
  std::string device;  ///< "cpu", or the name of the device that the sums ran on; empty: none did
  std::string driver;  ///< of the device
  /// Per stage, what of its seconds was spent on sums and neighbours on the device, with copies to and from it; empty for the processor.
  std::vector<std::pair<std::string, double>> device_seconds;
  std::vector<std::string> warnings;
};

/// Normals for every input point, in input order.
struct Orientation {
  std::vector<Vec3> normals;      ///< N unit outward normals; (0, 0, 0) only for points that are not finite
  std::vector<double> areas;      ///< N areas in squared input units (a duplicate carries its share); 0 for non-finite points,
                                  ///< infinite where the square is more than a double holds (extents beyond 1e154)
  std::vector<float> confidence;  ///< N values in [0, 1]: 1 = sure of the side, 0.5 = a choice, 0 = most likely wrong
  Stats stats;
};

/// Orients an unoriented cloud of a closed surface. O(N log N) time, O(N) memory.
/// Throws InvalidInput (fewer than 4 distinct finite points, all on a line, an option out of range), Unavailable
/// (Options::device), Cancelled, std::bad_alloc. The result depends neither on the order of the points nor on the number of threads.
[[nodiscard]] Orientation orient(const PointsView& points, const Options& options = {}, const Monitor& monitor = {});

/// How a surface is made from oriented points.
enum class Mesher {
  kAuto,    ///< the field mesher; screened Poisson in the paper preset where it was built in
  kField,   ///< contours the winding field: closed and manifold by construction
  kPoisson  ///< screened Poisson reconstruction (Kazhdan and Hoppe 2013); throws Unavailable when built without Open3D
};

/// Parameters of the mesher.
struct MeshOptions {
  Mesher mesher = Mesher::kAuto;
  int depth = 0;  ///< octree depth, 4..12; 0: from the density of the points (10 for screened Poisson in the paper preset)

  /// Whether surface far from every point is cut away, which leaves an open boundary.
  enum class Trim {
    kOff,      ///< closed
    kAuto,     ///< farther than 4 spacings of the cloud, or of the place where that is denser; 1.4 where it is so sparse that this is more
    kDistance  ///< farther than trim_distance
  };
  Trim trim = Trim::kOff;
  double trim_distance = 0;      ///< input units, > 0 with Trim::kDistance
  std::size_t keep_largest = 0;  ///< keep only this many components, those with most area near points first, after trimming; 0: all
  /// Components of less area than this many points stand for are dropped, 0: none; the largest always stays. Empty: 8, and where points
  /// scatter by s spacings 8 (1 + 4 s^2).
  std::optional<double> min_component;
  /// Keep surface without support: points that no surface goes through (strays, such as outliers that the solve did not find) shape the
  /// mesh too, and components stay however few points hold them, unless `min_component` says otherwise. Otherwise strays are left out, and
  /// with them components that are no larger than clusters of so many strays are by chance.
  bool keep_all = false;
  std::size_t faces = 0;  ///< simplify to about this many triangles; 0: off
  /// Standard deviation of the points from their surface, for the field mesher; 0: clean. Automatic: it makes its own estimate. Of
  /// mesh_oriented(); reconstruct() takes Options::noise.
  Length noise;
  int threads = 0;  ///< of mesh_oriented(), 0: all cores; reconstruct() takes Options::threads. The result does not depend on it
  std::string device = "auto";  ///< of mesh_oriented(), see Options::device; reconstruct() takes that
  std::size_t max_memory = 0;   ///< of mesh_oriented(), see Options::max_memory; reconstruct() takes that
};

/// A mesh together with the normals it was made from.
struct Reconstruction {
  Orientation orientation;
  Mesh mesh;
  MeshCheck check;
};

/// Orients a cloud and meshes it: outward, closed unless trimmed, in input units. O(N log N) time, O(N) memory, of which the mesher takes
/// most (Stats::planned_memory_bytes). Throws like orient(), InvalidInput for mesh options out of range, InvalidInput for coordinates
/// beyond 1e50 or an extent below 1e-70, of which areas and volumes cannot be told, and Unavailable when built without a mesher.
[[nodiscard]] Reconstruction reconstruct(const PointsView& points, const Options& options = {}, const MeshOptions& mesh_options = {},
                                         const Monitor& monitor = {});

/// What mesh_oriented() did and how it went.
struct MeshReport {
  Stats stats;      ///< as of reconstruct(), without what belongs to a solve and without times
  MeshCheck check;  ///< of the mesh
};

/// Meshes points that already have outward normals: N points and N normals (any length but zero).
/// Points with a non-finite coordinate or a zero normal are left out.
/// The field mesher takes the areas from the spacing of the points. O(N log N) time, O(N) memory. `report` (may be null) is filled in.
/// Throws InvalidInput (fewer than 4 points left, numbers that differ, an option out of range, no surface found), Cancelled, Unavailable
/// (without the mesher or device that is asked for, beyond max_memory), std::bad_alloc.
[[nodiscard]] Mesh mesh_oriented(const PointsView& points, const PointsView& normals, const MeshOptions& options = {},
                                 const Monitor& monitor = {}, MeshReport* report = nullptr);

/// Gives every vertex the mean colour and confidence of the 4 points nearest to it, weighed by 1 / distance^2, replacing what it had.
/// N points, and N colours and confidences (either may be empty). Points at one place count once, with the mean of what they have; points
/// and confidences that are not finite take no part, nor do points so far from the others that double precision cannot hold both; where
/// all 4 have no confidence it is 0. With `normals` (N outward ones, or none) the 4 are on the side of a wall or gap that the vertex is on:
/// where points that face away are among them, it is the nearest up to 4 of the 16 nearest that do not, if there are any. The result does
/// not depend on the order of the points. O(N + V log N). Throws InvalidInput if the numbers differ, Cancelled.
void carry_attributes(Mesh& mesh, const PointsView& points, const std::vector<std::array<std::uint8_t, 3>>& colors,
                      const std::vector<float>& confidence, const Monitor& monitor = {}, const PointsView& normals = {});

/// What orient() would begin with, without solving: counts, box, spacing, noise, epsilon, memory plan. Where the result of that leaves many
/// signs unsure, orient() tries another noise, and its report has the noise and epsilon of what it took. O(N log N). Throws InvalidInput
/// like orient(), std::bad_alloc.
[[nodiscard]] Stats plan(const PointsView& points, const Options& options = {});

/// What reconstruct() would do with this cloud: the same, with the mesher's memory in the plan.
[[nodiscard]] Stats plan(const PointsView& points, const Options& options, const MeshOptions& mesh_options);

/// The report as JSON, schema version 1 (docs/report.md), in UTF-8. `mesh` may be null.
[[nodiscard]] std::string report_json(const Stats& stats, const MeshCheck* mesh = nullptr);

/// The winding field w and its gradient, evaluable anywhere:
///   w(x) = sum_i g_s(|y_i - x|) (y_i - x) . eta_i       about 1 inside, 0 outside, 1/2 on the surface
/// with eta_i = areas[i] * normals[i] and g_s the Gaussian-mollified kernel of width s (docs/math.md).
class Field {
 public:
  /// From oriented points; `width` s in input units, 0: 0.55 spacings. `device`: where it is evaluated, see Options::device; it is held as
  /// long as the field. Points of which the place, the normal or the area is not finite are left out. Throws InvalidInput like orient(),
  /// and where no point has an area; Unavailable.
  Field(const PointsView& points, const Orientation& orientation, double width = 0, const std::string& device = "auto");
  ~Field();
  Field(Field&&) noexcept;
  Field& operator=(Field&&) noexcept;

  /// w at Q query points, finite: Q values. O(N + Q log N) after a build of O(N log N), anywhere up to millions of widths from the points.
  /// The value at a query depends on that query alone, and on the device in its last digits. Throws Cancelled, Unavailable,
  /// std::bad_alloc.
  [[nodiscard]] std::vector<double> value(const PointsView& queries, const Monitor& monitor = {}) const;
  /// Gradient of w at Q query points, in 1 / input units: Q vectors, which near the surface point inward. Cost and errors of value().
  [[nodiscard]] std::vector<Vec3> gradient(const PointsView& queries, const Monitor& monitor = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A device that Options::device can name.
struct ComputeDevice {
  std::string name;
  std::string driver;
  bool software = false;   ///< an OpenCL that runs on the processor: never taken unless it is asked for
  std::size_t memory = 0;  ///< bytes
};

/// Devices that drivers of OpenCL and CUDA know of, GPUs first: "gpu:0", "gpu:1", ... Empty without any driver. Takes a fraction of a
/// second.
[[nodiscard]] std::vector<ComputeDevice> compute_devices();

/// Version of the library, "major.minor.patch".
[[nodiscard]] std::string_view version();

/// How the library was built and what it runs on.
struct BuildInfo {
  bool laz = false;             ///< LAZ is read and written
  bool e57 = false;             ///< E57 is read
  bool poisson = false;         ///< there is screened Poisson reconstruction, through Open3D
  std::string instruction_set;  ///< vector instructions of the sums on this processor, by Highway's name: "AVX3", "AVX2", "SSE2", "NEON"
  bool opencl = false;          ///< OpenCL is installed on this machine
  bool cuda = false;            ///< a driver of CUDA is
};

/// Takes a few milliseconds: libraries are looked for, drivers are not started. compute_devices() tells which devices they have.
[[nodiscard]] BuildInfo build_info();

}  // namespace g3r
