// g3r tiles plan, run, mesh, status, merge; and g3r orient and g3r IN OUT where the cloud exceeds --max-memory or what is free.
#include "base/control_groups.h"
#include "base/platform.h"
#include "base/whole_bytes.h"
#include "cpu/parallel.h"
#include "io/source.h"
#include "orient/hints.h"
#include "tiles/manifest.h"
#include "tiles/plan.h"

#include <g3r/g3r.h>
#include <g3r/io.h>
#include <g3r/tiles.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
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

bool can_be_meshed(const MeshOptions& o) {
  return o.mesher != Mesher::kPoisson && o.depth == 0 && o.trim == MeshOptions::Trim::kOff && o.faces == 0;
}

// Whether tiles can do what is asked for, points with normals or a mesh.
bool can_be_tiled(const Settings& s, bool mesh) {
  const std::string extension = io::extension(s.output);
  const bool is_written = extension == "ply" || (!mesh && (extension == "las" || extension == "laz"));
  const bool simple_output = is_written && s.also.empty() && !s.write_options.ascii && !s.write_options.cloud_compare_names;
  if (mesh && (!s.oriented.empty() || !can_be_meshed(s.mesh_options))) return false;
  const ReadOptions& read = s.read_options;
  const bool whole_input =
      s.input != "-" && !read.box && read.levels == 0 && !read.all_splats && read.min_opacity == ReadOptions{}.min_opacity;
  return simple_output && whole_input && has_files(s.input) && !s.sensors_of_file && is_default_method(s.options);
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

bool is_limit_given(const Settings& settings) { return settings.options.max_memory > 0; }

std::size_t limit_of(const Settings& settings) { return is_limit_given(settings) ? settings.options.max_memory : tiles::default_limit(); }

// What a plan in this folder was held to, and, where that was what is free, how to have the same plan where something else is.
struct LimitText {
  std::string name;
  std::string again;
};
LimitText limit_text(const Settings& settings, const std::string& folder) {
  if (is_limit_given(settings)) return {"--max-memory", ""};
  const std::uint64_t limit = tiles::read_manifest(folder).limit;
  return {"three quarters of the free memory, " + bytes(static_cast<std::size_t>(limit)) + ",",
          "; --max-memory " + std::to_string(limit) + " makes the same tiles anywhere"};
}

// A plan that was made when more was free is not gone on with where it does not fit: what is done of it stays.
void require_room(const std::string& folder, bool mesh) {
  const TileStatus status = tiles_status(folder);
  std::uint64_t needed = status.done < status.tiles ? status.worker_memory_bytes : 0;
  if (mesh) needed = std::max(needed, planned_mesh_memory(folder));
  const std::size_t free = platform::share_of_free_memory(1);
  if (free == 0 || needed <= free) return;
  throw Unavailable(escape_text(folder) + ": its plan, of which " + std::to_string(status.done) + " of " + counted(status.tiles, "tile") +
                    " are done, was made when more memory was free: it needs " + std::to_string(mebibytes_needed(needed)) + " MiB, and " +
                    std::to_string(mebibytes(free)) +
                    " MiB are free; go on when more is, or remove the folder to begin anew with smaller tiles");
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

// Whether there is a plan to work on: the cloud exceeds the limit, or did so when the folder was made. Without --max-memory what tiles
// refuse is left to one piece, as far as that fits what is free.
bool plan_if_needed(const Settings& settings, Session& session, const std::string& folder, bool mesh) {
  const Monitor monitor = session.monitor();
  const bool given = is_limit_given(settings);
  const bool goes_on = !given && tiles::holds_plan_of(folder, {settings.input}, tile_options(settings));
  if (goes_on) {
    require_room(folder, mesh);
    session.console().say("goes on with the tiles in " + escape_text(folder));
  } else if (tiles::exceed({settings.input}, limit_of(settings), mesh, monitor)) {
    session.console().say(std::string("more than ") + (given ? "--max-memory" : "three quarters of the free memory") +
                          " in one piece: tiles, in " + escape_text(folder) + "; where this ends early, the same command goes on");
  } else {
    if (!given && !tiles::has_manifest(folder)) tiles::remove_plan(folder);  // what was begun when less was free
    return false;
  }
  const auto leaves_it_to_one_piece = [&](const Error& refusal) {
    if (given || goes_on || tiles::exceed({settings.input}, platform::share_of_free_memory(1), mesh, monitor)) return false;
    session.console().clear_bar();
    session.console().say(std::string("no tiles (") + refusal.what() + "); in one piece it fits what is free");
    return true;
  };
  try {
    plan_or_refuse(settings, folder, mesh, monitor);
  } catch (const Unavailable& error) {
    if (leaves_it_to_one_piece(error)) return false;
    throw;
  } catch (const InvalidInput& error) {
    if (leaves_it_to_one_piece(error)) return false;
    throw;
  }
  return true;
}

// Plans and solves beside the output, where that is needed; `merge` writes it, and says what of it is worth a warning. Then the folder
// goes.
template <class Merge>
std::optional<int> work_in_tiles(const Settings& settings, Session& session, bool mesh, const Merge& merge) {
  const std::string folder = settings.output + kFolderSuffix;
  if (!plan_if_needed(settings, session, folder, mesh)) return std::nullopt;
  const Monitor monitor = session.monitor();
  const LimitText limit = limit_text(settings, folder);
  const TileStatus status = g3r::run_tiles(folder, worker_of(settings), monitor);
  Stats stats = stats_of(status, folder, settings);
  const std::string left_out = merge(folder, monitor, stats);
  tiles::remove_plan(folder);
  stats.warnings.push_back("beyond " + limit.name + " in one piece: worked in " + counted(status.tiles, "tile") + limit.again +
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
      if (!is_limit_given(settings)) {
        const LimitText limit = limit_text(settings, settings.tile_folder);
        session.console().say("the limit is " + limit.name + " when it was planned" + limit.again);
      }
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

std::string what_tiles_need(const Settings& settings, bool mesh, std::size_t points) {
  if (can_be_tiled(settings, mesh) || !has_files(settings.input) || !tiles::is_beyond(limit_of(settings), points, mesh)) return "";
  return std::string("; tiles take any size, but need a ") + (mesh ? ".ply" : ".ply, .las or .laz") +
         " for OUT and none of the options that docs/tiles.md lists";
}

std::optional<int> orient_in_tiles(const Settings& settings, Session& session) {
  if (!can_be_tiled(settings, false)) return std::nullopt;
  return work_in_tiles(settings, session, false, [&](const std::string& folder, const Monitor& monitor, Stats& stats) {
    const MergedTiles merged = merge_tiles(folder, settings.output, monitor);
    stats.confidence_mean = merged.confidence_mean;
    stats.confidence_below_half = merged.confidence_below_half;
    stats.warnings.insert(stats.warnings.end(), merged.warnings.begin(), merged.warnings.end());
    return std::string();
  });
}

std::optional<int> reconstruct_in_tiles(const Settings& settings, Session& session) {
  if (!can_be_tiled(settings, true)) return std::nullopt;
  return work_in_tiles(settings, session, true, [&](const std::string& folder, const Monitor& monitor, Stats& stats) {
    const MeshTiles meshed = mesh_tiles(folder, worker_of(settings), monitor);
    stats.planned_memory_bytes = std::max<std::size_t>(stats.planned_memory_bytes, meshed.worker_memory_bytes);
    return mesh_text(merge_mesh(folder, settings.output, settings.mesh_options, monitor)) + ", without colours and confidence";
  });
}

}  // namespace g3r::cli
