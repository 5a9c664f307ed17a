#include "describe_mesh.h"

#include "base/number_text.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/findings.h"
#include "orient/confidence.h"
#include "orient/describe.h"
#include "orient/settings.h"

#include <g3r/names.h>

#include <algorithm>
#include <string>

namespace g3r {
namespace {

bool is_noisy(const Stats& stats) { return stats.noise > mesh::kNoisy * stats.spacing; }

// Points without surface, or with that of the other side, and surface without points.
void warn_of_missing(const mesh::Unmet& unmet, const mesh::Found& found, Stats& stats) {
  if (unmet.bare > kDoubtful) {
    stats.warnings.push_back(
        percent(unmet.bare) + " of the points have no surface near them: parts whose points are much closer together than is usual" +
        (is_noisy(stats) ? ", or that are thinner than the noise" : "") + ", or points that are no surface; mesh such parts one by one");
  }
  if (unmet.turned > kDoubtful) {
    stats.warnings.push_back(
        percent(unmet.turned) + " of the points are on surface that faces away from their normals: walls or gaps below " +
        (is_noisy(stats) ? "the noise" : "the spacing") + ", normals that face the wrong way, or points that are no surface");
  }
  if (found.pointless_area > kDoubtful) {
    stats.warnings.push_back(percent(found.pointless_area) +
                             " of the surface is of parts that no point is on: normals of one part of the cloud face the other way");
  }
  stats.doubtful = stats.doubtful || std::max({unmet.bare, unmet.turned, found.pointless_area}) > kManyUnsure;
}

void warn_of_trimming(const mesh::Found& found, const MeshOptions& options, Stats& stats) {
  if (options.trim == MeshOptions::Trim::kOff) return;
  const bool by_distance = options.trim == MeshOptions::Trim::kDistance;
  if (!found.trimmed) {
    stats.warnings.push_back("nothing was trimmed: no surface is farther than " +
                             (by_distance ? short_number(options.trim_distance) : short_number(mesh::kFarSpacings) + " spacings") +
                             " from the points");
  }
  if (by_distance && options.trim_distance < mesh::kGap * stats.spacing) {
    stats.warnings.push_back("trimmed at " + short_number(options.trim_distance) +
                             ", which is less than the gaps between the points and leaves holes: " + short_number(mesh::kFarSpacings) +
                             " spacings are " + short_number(mesh::kFarSpacings * stats.spacing));
  }
}

}  // namespace

std::size_t planned_with_mesh(const Stats& stats, const MeshOptions& chosen) {
  if (chosen.mesher == Mesher::kPoisson) return stats.planned_memory_bytes;
  return std::max(stats.planned_memory_bytes, field_mesh_memory(stats.used, stats.spacing, stats.noise, stats.box_side, chosen.depth));
}

Stats describe_oriented(const PointsWithNormals& given, const OrientedCloud& oriented, const MeshOptions& options) {
  const CanonicalCloud& cloud = oriented.cloud;
  Stats stats;
  stats.used = cloud.size();
  stats.dropped_non_finite = given.non_finite;
  stats.outliers = given.far.size();
  stats.merged_duplicates = given.points.size() - oriented.undirected - cloud.size();
  stats.points = given.points.size() + given.non_finite + given.undirected + given.far.size();
  stats.box_centre = cloud.frame.centre;
  stats.box_side = kBoxSide / cloud.frame.scale;
  stats.spacing = cloud.frame.length_to_world(oriented.spacing);
  stats.noise = cloud.frame.length_to_world(given_noise(options.noise, cloud, oriented.spacing).value_or(0));
  stats.method = name_of(options.mesher);
  stats.converged = true;  // nothing had to
  stats.threads = parallel::thread_count(options.threads);
  stats.planned_memory_bytes = planned_with_mesh(stats, options);
  if (given.non_finite > 0) {
    stats.warnings.push_back(std::to_string(given.non_finite) + " points with a non-finite coordinate were left out");
  }
  warn_of_far(given.far.size(), stats);
  if (given.undirected > 0) {
    stats.warnings.push_back(std::to_string(given.undirected) +
                             " points with a normal of (0, 0, 0) or one that is not finite were left out");
  }
  if (oriented.undirected > 0) {
    stats.warnings.push_back(std::to_string(oriented.undirected) +
                             " points at places where normals are opposite and cancel out were left out");
  }
  return stats;
}

void describe_mesh(const MeshCheck& check, const MeshRun& run, const MeshOptions& options, Stats& stats) {
  stats.depth = options.depth;
  stats.planned_memory_bytes = std::max(stats.planned_memory_bytes, run.memory.needed);
  const bool is_trimmed = options.trim != MeshOptions::Trim::kOff;
  if (run.far_share > kDoubtful) {
    stats.warnings.push_back(percent(run.far_share) + " of the surface is farther than " + short_number(mesh::kFarSpacings) +
                             " spacings from any point: the cloud looks open" +
                             (is_noisy(stats) ? ", as do two walls that are no farther apart than its noise" : "") +
                             (is_trimmed ? "" : "; trim the mesh (--open)"));
    stats.doubtful = stats.doubtful || (run.far_share > kManyUnsure && !is_trimmed);
  }
  warn_of_missing(run.unmet, run.found, stats);
  warn_of_trimming(run.found, options, stats);
  warn_of_topology(check, stats);
  warn_of_faces(check.triangles, options.faces, run.new_crossings, stats.warnings);
  if (is_too_wide(stats.box_side, stats.spacing, options)) {
    stats.warnings.emplace_back(
        "the cloud is more than 800,000 spacings wide, so the mesh is coarser than the points: mesh parts that are far apart one by one");
  }
  if ((!check.closed && !is_trimmed) || !check.manifold) {
    stats.warnings.emplace_back(check.closed ? "the mesh is not manifold" : "the mesh is not closed");
  }
}

}  // namespace g3r
