// g3r tiles plan, run, mesh, status, merge; and g3r orient and g3r IN OUT with --max-memory where the cloud does not fit.
#include "base/platform.h"
#include "cpu/parallel.h"
#include "io/source.h"
#include "orient/hints.h"
#include "tiles/manifest.h"

#include <g3r/g3r.h>
#include <g3r/io.h>
#include <g3r/tiles.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <system_error>

#include "commands.h"
#include "exit_code.h"
#include "summary.h"
#include "text.h"

namespace g3r::cli {
namespace {

constexpr const char* kFolderSuffix = ".tiles";  // of the work folder beside the output

std::string status_text(const TileStatus& status) {
  std::string text =
      with_commas(status.points) + " points, " + std::to_string(status.done) + " of " + counted(status.tiles, "tile") + " done\n";
  text += "thinned cloud of " + with_commas(status.coarse_points) + " points; largest tile " + with_commas(status.largest_tile) +
          " points with its surroundings\n";
  text += "memory of a worker " + bytes(status.worker_memory_bytes) + ", disk " + bytes(status.disk_bytes) + ", work " +
          short_number(status.work, 3) + " times that in core\n";
  return text;
}

std::string mesh_text(const MergedMesh& mesh) {
  std::string text = "a closed mesh of " + with_commas(mesh.triangles) + " triangles in " + counted(mesh.components, "component");
  if (mesh.dropped.components > 0) text += ", " + counted(mesh.dropped.components, "part") + " without support left out";
  if (mesh.dropped.points > 0) text += ", made without " + with_commas(mesh.dropped.points) + " points that no surface goes through";
  return text;
}

void say_status(Session& session, const TileStatus& status) {
  for (const std::string& warning : status.warnings) session.console().warn(warning);
  std::string text = status_text(status);
  text.pop_back();
  session.console().clear_bar();
  session.console().say(text);
}

TileOptions tile_options(const Settings& settings) {
  TileOptions options;
  options.max_memory = settings.options.max_memory;
  options.tiles = settings.tile_count;
  options.hints = settings.options.hints;
  options.threads = settings.options.threads;
  options.device = settings.options.device;
  return options;
}

TileWorker worker_of(const Settings& settings) {
  TileWorker worker = settings.worker;
  worker.threads = settings.options.threads;
  worker.device = settings.options.device;
  return worker;
}

bool is_default_method(const Options& o) {
  const auto automatic = [](const Length& length) { return length.unit == Length::Unit::kAuto; };
  return o.preset == Preset::kDefault && o.method == Method::kAuto && automatic(o.epsilon) && automatic(o.noise) && o.degree == -1 &&
         o.harmonics.empty() && o.wnnc_widths.empty() && o.solver == Solver::kAuto && o.schedule.empty() && o.tolerance == -1 &&
         o.accuracy == -1 && !o.condition_number;
}

// Whether these can be read more than once: a file, a folder, or a pattern of names.
bool has_files(const std::string& input) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(platform::path_of(input), ignored) ||
         std::filesystem::is_directory(platform::path_of(input), ignored) || input.find_first_of("*?") != std::string::npos;
}

// Whether tiles can do what is asked for, and end in a file with one of these extensions.
bool can_be_tiled(const Settings& s, std::initializer_list<const char*> extensions) {
  const std::string extension = "." + io::extension(s.output);
  const bool simple_output = s.also.empty() && !s.write_options.ascii && !s.write_options.cloud_compare_names &&
                             std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
  const ReadOptions& read = s.read_options;
  const bool whole_input =
      s.input != "-" && !read.box && read.levels == 0 && !read.all_splats && read.min_opacity == ReadOptions{}.min_opacity;
  return simple_output && whole_input && has_files(s.input) && !s.sensors_of_file && is_default_method(s.options);
}

bool can_be_meshed(const MeshOptions& o) {
  return o.mesher != Mesher::kPoisson && o.depth == 0 && o.trim == MeshOptions::Trim::kOff && o.faces == 0;
}

Stats stats_of(const TileStatus& status, const std::string& folder, const Settings& settings) {
  Stats stats;
  const auto [low, high] = tiles::read_manifest(folder).bounds;
  for (std::size_t a = 0; a < 3; ++a) {
    stats.box_centre[a] = low[a] + (high[a] - low[a]) / 2;
    stats.box_side = std::max(stats.box_side, high[a] - low[a]);
  }
  stats.hints.given = names_of(settings.options.hints);
  stats.points = status.points;
  stats.used = status.points - status.non_finite;
  stats.dropped_non_finite = status.non_finite;
  stats.preset = "default";
  stats.method = "energy";
  stats.converged = status.converged;
  stats.consistent = status.consistent;
  stats.doubtful = status.doubtful;
  stats.open_share = status.open_share;
  stats.undecided_share = status.undecided_share;
  stats.planned_memory_bytes = status.worker_memory_bytes;
  stats.threads = parallel::thread_count(settings.options.threads);
  stats.warnings = status.warnings;
  return stats;
}

// Plans in the folder, and refuses what cannot be before any tile is solved: then no plan stays, which another limit would not go on with.
void plan_or_refuse(const Settings& settings, const std::string& folder, bool mesh, const Monitor& monitor) {
  bool is_ours = false;
  const auto give_up = [&] {
    if (!tiles::has_manifest(folder) || (is_ours && tiles_status(folder).done == 0)) tiles::remove_plan(folder);
  };
  try {
    (void)plan_tiles({settings.input}, folder, tile_options(settings), monitor);
    is_ours = true;
    if (mesh) {
      (void)planned_mesh_memory(folder);
    } else {
      check_merge(folder, settings.output);
    }
  } catch (const Unavailable&) {
    give_up();
    throw;
  } catch (const InvalidInput&) {
    give_up();
    throw;
  }
}

// Plans and solves beside the output; `merge` writes it, and says what of it is worth a warning. Then the folder goes.
template <class Merge>
int work_in_tiles(const Settings& settings, Session& session, bool mesh, const Merge& merge) {
  const std::string folder = settings.output + kFolderSuffix;
  session.console().say("more than --max-memory in one piece: tiles, in " + escape_text(folder) +
                        "; where this ends early, the same command goes on");
  const Monitor monitor = session.monitor();
  plan_or_refuse(settings, folder, mesh, monitor);
  const TileStatus status = g3r::run_tiles(folder, worker_of(settings), monitor);
  Stats stats = stats_of(status, folder, settings);
  const std::string left_out = merge(folder, monitor, stats);
  tiles::remove_plan(folder);
  stats.warnings.push_back("beyond --max-memory in one piece: worked in " + counted(status.tiles, "tile") +
                           (left_out.empty() ? "" : "; " + left_out));
  return finish(settings, session, stats, nullptr);
}

// What g3r tiles mesh will take, or that it will not do, before any tile is solved.
void say_mesh_memory(Session& session, const std::string& folder) {
  try {
    session.console().say("a mesh of them takes " + bytes(static_cast<std::size_t>(planned_mesh_memory(folder))) + " a worker");
  } catch (const Unavailable& error) {
    session.console().warn(error.what());
  }
}

}  // namespace

int run_tiles(const Settings& settings, Session& session) {
  const Monitor monitor = session.monitor();
  switch (settings.tile_step) {
    case TileStep::kPlan:
      say_status(session, plan_tiles(settings.tile_paths, settings.tile_folder, tile_options(settings), monitor));
      say_mesh_memory(session, settings.tile_folder);
      break;
    case TileStep::kRun:
      say_status(session, g3r::run_tiles(settings.tile_folder, worker_of(settings), monitor));
      break;
    case TileStep::kMesh: {
      const MeshTiles done = mesh_tiles(settings.tile_folder, worker_of(settings), monitor);
      session.console().clear_bar();
      session.console().say("meshed " + std::to_string(done.done) + " of " + counted(done.tiles, "tile") + "; memory of a worker " +
                            bytes(done.worker_memory_bytes));
      break;
    }
    case TileStep::kStatus:
      std::fputs(status_text(tiles_status(settings.tile_folder)).c_str(), stdout);
      break;
    case TileStep::kMerge: {
      std::string mesh;
      if (settings.merge_mesh) {
        mesh = ": " + mesh_text(merge_mesh(settings.tile_folder, settings.output, settings.mesh_options, monitor));
      } else {
        for (const std::string& warning : merge_tiles(settings.tile_folder, settings.output, monitor).warnings)
          session.console().warn(warning);
      }
      session.console().clear_bar();
      session.console().say("wrote " + escape_text(settings.output) + mesh);
      break;
    }
  }
  return kOk;
}

std::string what_tiles_need(const Settings& settings, bool mesh) {
  if (settings.options.max_memory == 0 || !has_files(settings.input)) return "";
  if (!needs_tiles({settings.input}, settings.options.max_memory, mesh)) return "";
  return std::string("; tiles take any size, but need a ") + (mesh ? ".ply" : ".ply, .las or .laz") +
         " for OUT and none of the options that docs/tiles.md lists";
}

std::optional<int> orient_in_tiles(const Settings& settings, Session& session) {
  if (settings.options.max_memory == 0 || !can_be_tiled(settings, {".ply", ".las", ".laz"})) return std::nullopt;
  if (!needs_tiles({settings.input}, settings.options.max_memory)) return std::nullopt;
  return work_in_tiles(settings, session, false, [&](const std::string& folder, const Monitor& monitor, Stats& stats) {
    const MergedTiles merged = merge_tiles(folder, settings.output, monitor);
    stats.confidence_mean = merged.confidence_mean;
    stats.confidence_below_half = merged.confidence_below_half;
    stats.warnings.insert(stats.warnings.end(), merged.warnings.begin(), merged.warnings.end());
    return std::string();
  });
}

std::optional<int> reconstruct_in_tiles(const Settings& settings, Session& session) {
  if (settings.options.max_memory == 0 || !can_be_tiled(settings, {".ply"})) return std::nullopt;
  if (!settings.oriented.empty() || !can_be_meshed(settings.mesh_options)) return std::nullopt;
  if (!needs_tiles({settings.input}, settings.options.max_memory, true)) return std::nullopt;
  return work_in_tiles(settings, session, true, [&](const std::string& folder, const Monitor& monitor, Stats& stats) {
    const MeshTiles meshed = mesh_tiles(folder, worker_of(settings), monitor);
    stats.planned_memory_bytes = std::max<std::size_t>(stats.planned_memory_bytes, meshed.worker_memory_bytes);
    return mesh_text(merge_mesh(folder, settings.output, settings.mesh_options, monitor)) + ", without colours and confidence";
  });
}

}  // namespace g3r::cli
