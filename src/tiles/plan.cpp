// Two readings of the inputs (extent, then sort), one scan of the sorted points, one solve of the thinned cloud.
#include "tiles/plan.h"

#include "base/control_groups.h"
#include "base/platform.h"
#include "base/stages.h"
#include "base/vector.h"
#include "base/whole_bytes.h"
#include "cpu/parallel.h"
#include "io/output_file.h"
#include "io/point_stream.h"
#include "mesh/field_mesher.h"
#include "orient/hints.h"
#include "orient/memory_plan.h"
#include "orient/settings.h"
#include "orient/start.h"
#include "sum/device_scope.h"
#include "tiles/external_sort.h"
#include "tiles/fewest_tiles.h"
#include "tiles/inputs.h"
#include "tiles/manifest.h"
#include "tiles/point_hash.h"
#include "tiles/records.h"
#include "tiles/survey.h"
#include "tiles/thinned.h"
#include "tiles/tile_cloud.h"
#include "tiles/tile_memory.h"

#include <g3r/io.h>
#include <g3r/tiles.h>

#include <algorithm>
#include <filesystem>
#include <locale>
#include <memory>
#include <sstream>
#include <system_error>
#include <utility>

namespace g3r::tiles {
namespace {

constexpr std::uint64_t kFewestCoarse = 20000;  // with half as many, fields of thin parts of the dragon no longer close, and sides go wrong
constexpr std::uint64_t kMostCoarse = 2000000;  // every tile has them all around it
constexpr std::uint64_t kCoarseShare = 8;       // one of so many points is in the thinned cloud, if that is enough and not too much
constexpr double kFreeShare = 0.75;             // of the free memory, if no limit is given
constexpr std::size_t kMostTiles = 1000000;

std::string asked_of(const TileOptions& options) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  const auto add = [&](const char* name, const Vec3& v) { text << ' ' << name << ' ' << v[0] << ',' << v[1] << ',' << v[2]; };
  text << "tiles " << options.tiles << " max_memory " << options.max_memory;
  if (options.hints.up) add("up", *options.hints.up);
  for (const Vec3& place : options.hints.sensors) add("sensor", place);
  for (const Vec3& place : options.hints.inside) add("inside", place);
  if (options.hints.seen_from_inside) text << " seen_from_inside";
  if (options.hints.flip) text << " flip";
  return text.str();
}

[[noreturn]] void refuse_memory(const TileOptions& options, std::size_t limit, std::uint64_t needed, const std::string& remedy) {
  throw Unavailable("tiles of this cloud need " + std::to_string(mebibytes_needed(memory_for(needed))) + " MiB, the limit is " +
                    std::to_string(mebibytes(limit)) + " MiB" + (options.max_memory > 0 ? "" : ", three quarters of what is free") + "; " +
                    remedy + ", or thin the cloud");
}

std::uint64_t fewest_coarse(std::uint64_t points) { return std::min(kFewestCoarse, points / 4); }

// The memory without which no tiles of so many points can be: twice the thinned cloud.
std::size_t least_memory(std::uint64_t points) { return memory_for(2 * fewest_coarse(points)); }

// The thinned cloud has as many points as are useful and the memory allows.
std::uint64_t choose_stride(std::uint64_t points, const TileOptions& options, std::size_t limit) {
  const std::uint64_t most = std::min(kMostCoarse, points_for(limit) / 2);
  const std::uint64_t fewest = fewest_coarse(points);
  if (most < fewest) refuse_memory(options, limit, 2 * fewest, "raise the limit");
  const std::uint64_t wanted = std::min(most, std::max(fewest, points / kCoarseShare));
  std::uint64_t stride = 2;
  while (points / (2 * stride) >= wanted || points / stride > most) stride *= 2;
  return stride;
}

// Second reading: the sorted points, the thinned files, the cells. The level of the cells is known when all points are sorted.
Cells sort_points(const std::vector<std::string>& files, const std::string& folder, std::size_t limit, int threads, Manifest& m,
                  Stages& stages) {
  stages.begin("sort");
  ExternalSort sort(folder, m.frame, limit / 4, stages.cancel());
  std::uint64_t index = 0;
  std::vector<std::uint64_t> hashes(files.size());
  for_all_points(
      files, {.threads = threads, .cancel = stages.cancel()}, [](std::size_t, const io::PointStream&) {},
      [&](double share) { stages.progress(share / 2); },
      [&](std::size_t file, const Vec3& p) {
        hashes[file] = point_hash(hashes[file], p);
        if (vector::is_finite(p)) sort.add({p, index});
        ++index;
      });
  for (std::size_t f = 0; f < files.size(); ++f) {
    if (hashes[f] != m.inputs[f].hash) throw InvalidInput(escape_text(files[f]) + ": has changed while it was read; make the plan again");
  }
  std::vector<std::unique_ptr<io::OutputFile>> outputs;
  const std::vector<std::uint64_t> all_strides = strides(m.stride, m.sorted());
  outputs.reserve(all_strides.size());
  for (const std::uint64_t stride : all_strides)
    outputs.push_back(std::make_unique<io::OutputFile>(points_path(folder, stride), stages.cancel()));
  LevelChoice choice;
  std::uint64_t place = 0;
  sort.finish([&](std::uint64_t code, const Record& record) {
    choice.add(code);
    for (std::size_t s = 0; s < outputs.size(); ++s) {
      if (place % all_strides[s] == 0) outputs[s]->write(&record, sizeof record);
    }
    if (place++ % kPointsAtOnce == 0) stages.progress(0.5 + 0.4 * static_cast<double>(place) / static_cast<double>(m.points));
  });
  for (const std::unique_ptr<io::OutputFile>& output : outputs) output->commit();
  m.level = choice.level();
  return find_cells(folder, m, stages);
}

std::uint64_t count_solved(const Cells& cells, std::uint64_t stride, std::vector<Tile>& tiles) {
  std::uint64_t largest = 0;
  parallel::for_each(tiles.size(), [&](std::size_t t) { tiles[t].solved = count_tile_cloud(cells, stride, tiles[t]); });
  for (const Tile& tile : tiles) largest = std::max(largest, tile.solved);
  return largest;
}

// As few tiles as fit the memory, unless their number is given.
void choose_tiles(const Cells& cells, const TileOptions& options, std::size_t limit, Manifest& m) {
  const std::uint64_t most = points_for(limit);
  const std::uint64_t free = most > m.coarse_points ? most - m.coarse_points : 1;
  std::uint64_t largest = 0;
  const auto cut_into = [&](std::size_t count) {
    m.tiles = cut(cells, count);
    largest = count_solved(cells, m.stride, m.tiles);
    m.worker_memory = memory_for(std::max(largest, m.coarse_points));
    return m.worker_memory;
  };
  const std::size_t all = cells.cells.size();
  const auto first = static_cast<std::size_t>(std::min<std::uint64_t>(kMostTiles, m.sorted() / free + 1));
  const bool fits = options.tiles > 0 ? cut_into(std::min(options.tiles, all)) <= limit : cut_into_fewest(first, all, limit, cut_into);
  if (!fits) refuse_memory(options, limit, largest, options.tiles > 0 ? "ask for more tiles, raise the limit" : "raise the limit");
}

// The sides: every stride-th point, in core.
void solve_coarse(const std::string& folder, const TileOptions& options, Manifest& m, const Monitor& monitor) {
  std::vector<Record> records;
  const RecordFile<Record> file(points_path(folder, m.stride));
  file.append(0, file.size(), records);
  std::vector<Vec3> points(records.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = records[i].point;
  Options solve;
  solve.hints = options.hints;
  solve.threads = options.threads;
  solve.device = options.device;
  std::vector<std::uint8_t> open;
  const Orientation coarse = orient_from(points, {}, solve, named(monitor, "coarse"), &open);
  io::OutputFile out(coarse_path(folder), monitor.cancel);
  open = open_all_around(points, open);
  m.coarse_spacing = coarse.stats.spacing;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& n = coarse.normals[i];
    const CoarseNormal normal{{static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])},
                              coarse.confidence[i],
                              static_cast<float>(coarse.areas[i] / m.coarse_spacing / m.coarse_spacing),
                              open[i]};
    out.write(&normal, sizeof normal);
  }
  out.commit();
  m.converged = coarse.stats.converged;
  m.consistent = coarse.stats.consistent;
  m.doubtful = coarse.stats.doubtful;
  m.open_share = coarse.stats.open_share;
  m.undecided_share = coarse.stats.undecided_share;
  for (const std::string& warning : coarse.stats.warnings) m.warnings.push_back("thinned cloud: " + warning);
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(platform::path_of(folder), error);
  if (error) throw IoError(IoError::Kind::kCannotCreate, "cannot create " + escape_text(folder) + ": " + error.message());
}

// What no cloud makes usable is refused before any is read.
void require_usable(const TileOptions& options) {
  if (!options.hints.sensor_of_point.empty()) throw InvalidInput("plan_tiles: sensors of single points are not supported with tiles");
  require_sound(options.hints, 0);
  if (options.threads < 0) throw InvalidInput("threads must be 0 (all cores) or positive");
  const gpu::Lease device(options.device, 0);  // kept for the solve
}

TileStatus make_plan(const std::vector<std::string>& files, const std::string& folder, const TileOptions& options, const Monitor& monitor) {
  Stages stages(monitor);
  const std::size_t limit = options.max_memory > 0 ? options.max_memory : default_limit();
  Manifest m = survey(files, options.threads, stages);
  m.asked = asked_of(options);
  m.limit = limit;
  m.stride = choose_stride(m.sorted(), options, limit);
  m.coarse_points = (m.sorted() + m.stride - 1) / m.stride;
  make_folder(folder);
  clear_folder(folder);
  {
    const Cells cells = sort_points(files, folder, limit, options.threads, m, stages);
    choose_tiles(cells, options, limit, m);
  }
  std::uint64_t stored = 0;
  for (const std::uint64_t stride : strides(m.stride, m.sorted())) stored += m.sorted() / stride * sizeof(Record);
  m.disk = stored + m.sorted() * std::max(sizeof(Record), sizeof(Result));  // runs before the results
  solve_coarse(folder, options, m, monitor);
  write_manifest(folder, m);
  return status_of(folder, m);
}

bool is_plan_of(const Manifest& there, const std::vector<std::string>& files, const TileOptions& options) {
  bool same = there.asked == asked_of(options) && there.inputs.size() == files.size();
  for (std::size_t f = 0; same && f < files.size(); ++f) {
    std::error_code ignored;
    same = there.inputs[f].path == files[f] && there.inputs[f].bytes == std::filesystem::file_size(platform::path_of(files[f]), ignored);
  }
  return same;
}

// The plan in the folder is of these options and files, and these of the points that they had.
void require_same(const std::string& folder, const Manifest& there, const std::vector<std::string>& files, const TileOptions& options,
                  const Monitor& monitor) {
  if (!is_plan_of(there, files, options))
    throw InvalidInput(escape_text(folder) + ": holds the plan of other files or options; take another folder, or remove it");
  Stages stages(monitor);
  stages.begin("read");
  const std::vector<std::uint64_t> hashes = hashes_of(files, options.threads, stages);
  for (std::size_t f = 0; f < files.size(); ++f) {
    if (hashes[f] == there.inputs[f].hash) continue;
    throw InvalidInput(escape_text(files[f]) + ": its points are others than those of the plan in " + escape_text(folder) +
                       "; take another folder, or remove it");
  }
}

}  // namespace

std::size_t default_limit() { return platform::share_of_free_memory(kFreeShare); }

bool is_beyond(std::size_t limit, std::uint64_t points, bool mesh) {
  const std::size_t whole = mesh ? field_mesh_memory(static_cast<std::size_t>(points), 0, 0, 0, 0) : in_core(points);
  return limit > 0 && points >= kFewestPoints && whole > limit && whole > least_memory(points);
}

bool holds_plan_of(const std::string& folder, const std::vector<std::string>& inputs, const TileOptions& options) {
  if (!has_manifest(folder)) return false;
  try {
    return is_plan_of(read_manifest(folder), files_of(inputs), options);
  } catch (const InvalidInput&) {  // a damaged plan, or names that none can have
    return false;
  }
}

bool exceed(const std::vector<std::string>& inputs, std::size_t limit, bool mesh, const Monitor& monitor) {
  const std::vector<std::string> files = found_files(inputs);
  if (!is_beyond(limit, most_points(files), mesh)) return false;
  Stages stages(monitor);
  stages.begin("read");
  std::uint64_t points = 0;
  for (const std::string& file : files) {
    stages.still_going();
    points += io::open_points(file, false, {.cancel = stages.cancel()})->left();
  }
  return is_beyond(limit, points, mesh);
}

}  // namespace g3r::tiles

namespace g3r {

TileStatus plan_tiles(const std::vector<std::string>& inputs, const std::string& folder, const TileOptions& options,
                      const Monitor& monitor) {
  tiles::require_usable(options);
  const std::vector<std::string> files = tiles::files_of(inputs);
  if (tiles::has_manifest(folder)) {
    const tiles::Manifest there = tiles::read_manifest(folder);
    tiles::require_same(folder, there, files, options, monitor);
    return tiles::status_of(folder, there);
  }
  return parallel::with_threads(options.threads, [&] { return tiles::make_plan(files, folder, options, monitor); });
}

bool needs_tiles(const std::vector<std::string>& inputs, std::size_t max_memory, bool mesh) {
  return tiles::exceed(inputs, max_memory, mesh, {});
}

TileStatus tiles_status(const std::string& folder) { return tiles::status_of(folder, tiles::read_manifest(folder)); }

}  // namespace g3r
