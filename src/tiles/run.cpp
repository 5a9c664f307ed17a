// Each tile: a solve in core of its cloud, turned part by part to the sides of the thinned cloud.
#include "base/vector.h"
#include "cpu/parallel.h"
#include "io/output_file.h"
#include "orient/start.h"
#include "orient/steps.h"
#include "sum/device_scope.h"
#include "tiles/coarse_sides.h"
#include "tiles/manifest.h"
#include "tiles/records.h"
#include "tiles/tile_cloud.h"

#include <g3r/tiles.h>

#include <algorithm>
#include <map>
#include <utility>

namespace g3r::tiles {
namespace {

double dot(const Vec3& a, const std::array<float, 3>& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Signs of the parts: that of the sum over the points that are in the thinned cloud too, of the cosine between both normals times the
// confidence of the coarse side; points on open surfaces do not count, as theirs follow it one by one. Of what lies beyond ring 0, and of
// parts without such points, that of the sum over all.
std::map<std::uint32_t, double> signs_of_parts(const TileCloud& cloud, const std::vector<Vec3>& normals, const CoarseSides& coarse) {
  std::map<std::uint32_t, double> votes;
  double all = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const CoarseNormal& there = coarse.nearest[i];
    if (cloud.coarse[i] == kNotCoarse || there.open != 0) continue;
    const double vote = there.confidence * dot(normals[i], there.normal);
    votes[cloud.part[i]] += vote;
    all += vote;
  }
  votes[kNoPart] = all;
  for (auto& [part, vote] : votes) vote = (vote == 0 ? all : vote) < 0 ? -1 : 1;
  return votes;
}

Orientation solve(const TileCloud& cloud, Known known, const TileWorker& worker, const Monitor& monitor) {
  Options options;
  options.threads = worker.threads;
  options.device = worker.device;
  options.without = kStepNames[static_cast<std::size_t>(Step::kAreas)];  // of which a tile says nothing
  return orient_from(cloud.points, std::move(known), options, monitor);
}

// The gradient at the own points on open surfaces.
std::vector<Vec3> gradient_of_open(const TileCloud& cloud, const CoarseSides& coarse) {
  std::vector<Vec3> gradient;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (cloud.own[i] != 0 && coarse.nearest[i].open != 0) gradient.push_back(coarse.gradient[i]);
  }
  return gradient;
}

// Which points are on open surfaces, as the thinned cloud has found; empty: none is.
std::vector<std::uint8_t> open_points(const CoarseSides& coarse) {
  std::vector<std::uint8_t> open;
  for (const CoarseNormal& there : coarse.nearest) open.push_back(there.open != 0 ? 1 : 0);
  const bool any = std::find(open.begin(), open.end(), std::uint8_t{1}) != open.end();
  return any ? open : std::vector<std::uint8_t>{};
}

// The sides of the own points: of those on an open surface each takes that of the thinned cloud's field, and the confidence there, for the
// equations say nothing of it and all tiles choose as one; the others turn with their part.
std::vector<Result> results_of(const TileCloud& cloud, const Orientation& solved, const CoarseSides& coarse,
                               const std::vector<Vec3>& open_gradient) {
  std::map<std::uint32_t, double> signs = signs_of_parts(cloud, solved.normals, coarse);
  std::vector<Result> results;
  auto gradient = open_gradient.begin();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (cloud.own[i] == 0) continue;
    const CoarseNormal& there = coarse.nearest[i];
    const auto part = signs.find(cloud.part[i]);
    double turn = part != signs.end() ? part->second : signs[kNoPart];
    if (there.open != 0) turn = vector::dot(solved.normals[i], *gradient++) < 0 ? -1 : 1;
    Result result{cloud.index[i], {}, there.open != 0 ? there.confidence : solved.confidence[i]};
    for (std::size_t a = 0; a < 3; ++a) result.normal[a] = static_cast<float>(turn * solved.normals[i][a]);
    results.push_back(result);
  }
  std::sort(results.begin(), results.end(), [](const Result& a, const Result& b) { return a.index < b.index; });
  return results;
}

void solve_tile(const std::string& folder, const Manifest& m, const Cells& cells, std::size_t t, const TileWorker& worker,
                const Monitor& monitor) {
  TileCloud cloud = read_tile_cloud(folder, m, cells, m.tiles[t]);
  CoarseSides coarse = parallel::with_threads(worker.threads, [&] {
    const gpu::Scope device(worker.device, cloud.points.size());
    return coarse_sides(folder, m, cloud, monitor.cancel);
  });
  const std::vector<Vec3> open_gradient = gradient_of_open(cloud, coarse);
  Known known{std::move(coarse.gradient), std::move(cloud.relative_spacing), cloud.own, open_points(coarse)};
  const Orientation solved =
      solve(cloud, std::move(known), worker, named(monitor, "tile " + std::to_string(t + 1) + " of " + std::to_string(m.tiles.size())));
  io::OutputFile out(result_path(folder, t), monitor.cancel);
  out.write_records(results_of(cloud, solved, coarse, open_gradient));
  out.commit();
}

}  // namespace
}  // namespace g3r::tiles

namespace g3r {

TileStatus run_tiles(const std::string& folder, const TileWorker& worker, const Monitor& monitor) {
  tiles::require_worker(worker);
  const tiles::Manifest manifest = tiles::read_manifest(folder);
  const tiles::Cells cells = tiles::read_cells(folder, manifest);
  for (std::size_t t = worker.number - 1; t < manifest.tiles.size(); t += worker.workers) {
    if (!tiles::is_done(folder, manifest, t)) tiles::solve_tile(folder, manifest, cells, t, worker, monitor);
  }
  return tiles::status_of(folder, manifest);
}

}  // namespace g3r
