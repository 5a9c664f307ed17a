// Each tile: a solve in core of its cloud, turned part by part to the sides of the thinned cloud.
#include "cpu/parallel.h"
#include "field/oriented_cloud.h"
#include "io/output_file.h"
#include "orient/confidence.h"
#include "orient/settings.h"
#include "orient/start.h"
#include "orient/steps.h"
#include "sum/fast_sum.h"
#include "tiles/manifest.h"
#include "tiles/records.h"
#include "tiles/tile_cloud.h"

#include <g3r/tiles.h>

#include <algorithm>
#include <map>

namespace g3r::tiles {
namespace {

double dot(const Vec3& a, const std::array<float, 3>& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Signs of the parts: that of the sum over the points that are in the thinned cloud too, of the cosine between both normals times the
// confidence of the coarse side. Of what lies beyond ring 0, and of parts without such points, that of the sum over all.
std::map<std::uint32_t, double> signs_of_parts(const TileCloud& cloud, const std::vector<Vec3>& normals, const std::string& folder) {
  std::vector<CoarseNormal> coarse;
  const RecordFile<CoarseNormal> file(coarse_path(folder));
  file.append(0, file.size(), coarse);
  std::map<std::uint32_t, double> votes;
  double all = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (cloud.coarse[i] == kNotCoarse) continue;
    const CoarseNormal& there = coarse[static_cast<std::size_t>(cloud.coarse[i])];
    const double vote = there.confidence * dot(normals[i], there.normal);
    votes[cloud.part[i]] += vote;
    all += vote;
  }
  votes[kNoPart] = all;
  for (auto& [part, vote] : votes) vote = (vote == 0 ? all : vote) < 0 ? -1 : 1;
  return votes;
}

// The winding gradient of the thinned cloud at the points of the tile: its own solve starts there, as in core from a quarter of the points.
std::vector<Vec3> start_from_coarse(const std::string& folder, const Manifest& m, const std::vector<Vec3>& points, const Monitor& monitor) {
  const RecordFile<Record> places(points_path(folder, m.stride));
  const RecordFile<CoarseNormal> found(coarse_path(folder));
  std::vector<Record> records;
  std::vector<CoarseNormal> coarse;
  places.append(0, places.size(), records);
  found.append(0, places.size(), coarse);
  std::vector<Vec3> thinned(records.size());
  std::vector<Vec3> normals(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    thinned[i] = records[i].point;
    for (std::size_t a = 0; a < 3; ++a) normals[i][a] = coarse[i].normal[a];
  }
  std::vector<Record>().swap(records);
  std::vector<CoarseNormal>().swap(coarse);
  const OrientedCloud oriented = oriented_cloud(thinned, normals);
  std::vector<Vec3> targets(points.size());
  std::transform(points.begin(), points.end(), targets.begin(), [&](const Vec3& p) { return oriented.cloud.frame.to_unit(p); });
  const FastSum field(oriented.cloud.points(), oriented.cloud.morton(), Widths(kRefinementWidth * oriented.spacing),
                      sum_plan(kContinuedAccuracy, oriented.cloud.size()), monitor.cancel);
  return field.winding_gradient_at(oriented.eta, targets, monitor.cancel);
}

// Other noises than the estimate are tried where the tile's own points ask for it, or the thinned cloud is open, as in core.
Orientation solve(const std::string& folder, const TileCloud& cloud, const Manifest& m, const TileWorker& worker, const Monitor& monitor) {
  std::vector<Vec3> points(cloud.records.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = cloud.records[i].point;
  Options options;
  options.threads = worker.threads;
  options.device = worker.device;
  Known known;
  known.gradient = parallel::with_threads(worker.threads, [&] { return start_from_coarse(folder, m, points, monitor); });
  known.relative_spacing = cloud.relative_spacing;
  if (m.open_share < kDoubtful) {
    Options one_noise = options;
    one_noise.without = kStepNames[static_cast<std::size_t>(Step::kNoiseChoice)];
    Orientation solved = orient_from(points, known, one_noise, monitor);
    if (unsure_share_of_own(cloud, solved.confidence) < kDoubtful) return solved;
  }
  return orient_from(points, known, options, monitor);
}

void solve_tile(const std::string& folder, const Manifest& m, const Cells& cells, std::size_t t, const TileWorker& worker,
                const Monitor& monitor) {
  const TileCloud cloud = read_tile_cloud(folder, m, cells, m.tiles[t]);
  const Orientation solved =
      solve(folder, cloud, m, worker, named(monitor, "tile " + std::to_string(t + 1) + " of " + std::to_string(m.tiles.size())));
  std::map<std::uint32_t, double> signs = signs_of_parts(cloud, solved.normals, folder);
  std::vector<Result> results;
  for (std::size_t i = 0; i < cloud.records.size(); ++i) {
    if (cloud.own[i] == 0) continue;
    const auto sign = signs.find(cloud.part[i]);
    const double turn = sign != signs.end() ? sign->second : signs[kNoPart];
    Result result{cloud.records[i].index, {}, solved.confidence[i]};
    for (std::size_t a = 0; a < 3; ++a) result.normal[a] = static_cast<float>(turn * solved.normals[i][a]);
    results.push_back(result);
  }
  std::sort(results.begin(), results.end(), [](const Result& a, const Result& b) { return a.index < b.index; });
  io::OutputFile out(result_path(folder, t), monitor.cancel);
  out.write_records(results);
  out.commit();
}

}  // namespace
}  // namespace g3r::tiles

namespace g3r {

TileStatus run_tiles(const std::string& folder, const TileWorker& worker, const Monitor& monitor) {
  if (worker.workers == 0 || worker.number == 0 || worker.number > worker.workers) {
    throw InvalidInput("run_tiles: expected a worker of 1.." + std::to_string(worker.workers) + ", found " + std::to_string(worker.number));
  }
  const tiles::Manifest manifest = tiles::read_manifest(folder);
  const tiles::Cells cells = tiles::read_cells(folder, manifest);
  for (std::size_t t = worker.number - 1; t < manifest.tiles.size(); t += worker.workers) {
    if (!tiles::is_done(folder, manifest, t)) tiles::solve_tile(folder, manifest, cells, t, worker, monitor);
  }
  return tiles::status_of(folder, manifest);
}

}  // namespace g3r
