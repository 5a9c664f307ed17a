#include "tiles/mesh_plan.h"

#include "base/median.h"
#include "base/platform.h"
#include "base/whole_bytes.h"
#include "cloud/constants.h"
#include "cpu/parallel.h"
#include "field/winding_sampler.h"
#include "io/output_file.h"
#include "io/source.h"
#include "tiles/cell_codes.h"
#include "tiles/fewest_tiles.h"
#include "tiles/mesh_records.h"
#include "tiles/thinned.h"
#include "tiles/whole_number.h"

#include <g3r/io.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <system_error>

namespace g3r::tiles {
namespace {

using nlohmann::json;

constexpr const char* kMeshSchema = "g3r.tiles.mesh";
constexpr int kMeshVersion = 2;
constexpr std::size_t kSamples = 32;         // places of the order of the points, that stand for the cloud
constexpr int kSampleAround = 1;             // cells around them: 8 spacings or more
constexpr std::uint64_t kFixed = 72u << 20;  // bytes beside what grows with the points (docs/algorithms/tiles.md)
constexpr std::uint64_t kPerPoint = 1400;    // bytes of the octree, the sides and the patches around each point (docs/algorithms/tiles.md)
// Times cell_under(): the frame is made for cells of kFinestCell, from a sample of the spacing that errs (scale_for() in plan.cpp).
constexpr double kLargestCell = 1.15;
constexpr int kMaxLevel = mesh::kMaxOctreeLevel - 4;  // of the cells: leaves are finer

[[noreturn]] void fail_mesh_plan(const std::string& folder, const std::string& what) {
  throw InvalidInput(escape_text(mesh_plan_path(folder)) + ": " + what + "; remove it and the other mesh-* files, and mesh again");
}

// The cell of a point of the order.
std::uint64_t code_of_point(const Cells& cells, std::uint64_t place) {
  const auto after =
      std::upper_bound(cells.cells.begin(), cells.cells.end(), place, [](std::uint64_t at, const Cell& cell) { return at < cell.begin; });
  return std::prev(after)->code;
}

// Spacing, noise and heights of the cloud: the medians over the surroundings of points evenly spaced in the order, so that strays, which
// have cells of their own, count as few as they are. Surroundings of too few points for any of the three are left out.
void sample_cloud(const std::string& folder, const Manifest& m, const Cells& cells, MeshPlan& plan, const std::atomic<bool>* cancel) {
  std::vector<double> spacing;
  std::vector<double> position;
  std::vector<double> normal;
  std::vector<double> usual;
  std::vector<double> strays;
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kSamples, cells.points));
  for (std::size_t s = 0; s < count; ++s) {
    if (cancel != nullptr && cancel->load()) throw Cancelled();
    const std::uint64_t code = code_of_point(cells, s * (cells.points / count));
    std::vector<std::uint64_t> near;
    for_neighbours(code, cells.level, kSampleAround, [&](std::uint64_t other) { near.push_back(other); });
    std::sort(near.begin(), near.end());
    const RawPoints raw =
        read_raw_points(folder, m, cells, [&](std::size_t c) { return std::binary_search(near.begin(), near.end(), cells.cells[c].code); });
    if (raw.positions.size() < kSmallPart * kPatchNeighbours) continue;
    mesh::Prepared prepared;
    mesh::prepare(raw.positions, raw.normals, 0, prepared);
    spacing.push_back(median(prepared.points.spacing));
    const mesh::Noise noise = mesh::noise_about_fits(prepared.points, *prepared.neighbours, prepared.typical);
    position.push_back(noise.position * prepared.typical);
    normal.push_back(noise.normal);
    const mesh::CloudHeights heights = mesh::cloud_heights(prepared.points.positions, prepared.points.normals);
    usual.push_back(heights.usual);
    strays.push_back(heights.stray_share);
  }
  if (spacing.empty()) throw InvalidInput(escape_text(folder) + ": its points are too scattered to be a surface; there is no mesh of them");
  plan.spacing = median(std::move(spacing));
  plan.noise = {median(std::move(position)) / plan.spacing, median(std::move(normal))};
  plan.heights = {median(std::move(usual)), median(std::move(strays))};
}

// As the thinned cloud says.
bool is_turned(const std::string& folder, const Manifest& m, const std::atomic<bool>* cancel) {
  const OrientedCloud oriented = with_areas(read_thinned(folder, m), m);
  return is_inside_out(oriented, WindingSampler(oriented, cancel));
}

std::uint64_t points_around(const MeshFolder& folder, std::size_t tile) {
  const std::vector<std::uint8_t> rings = Region(folder, tile).rings();
  std::uint64_t count = 0;
  for (std::size_t c = 0; c < rings.size(); ++c) count += rings[c] == 0 ? folder.cells.end(c) - folder.cells.cells[c].begin : 0;
  return count;
}

void find_first_codes(MeshFolder& folder) {
  folder.first_code.assign(1, 0);
  for (std::size_t t = 1; t < folder.tiles(); ++t)
    folder.first_code.push_back(folder.cells.cells[static_cast<std::size_t>(folder.plan.tiles[t].first_cell)].code);
}

// As many as there are of normals, or more where the memory asks for it.
void choose_tiles(MeshFolder& folder) {
  const auto cut_into = [&](std::size_t count) {
    std::vector<Tile>& tiles = folder.plan.tiles;
    tiles = cut(folder.cells, count);
    find_first_codes(folder);
    std::vector<std::uint64_t> solved(tiles.size());
    parallel::for_each(tiles.size(), [&](std::size_t t) { solved[t] = points_around(folder, t); });
    for (std::size_t t = 0; t < tiles.size(); ++t) tiles[t].solved = solved[t];
    folder.plan.worker_memory = kFixed + kPerPoint * *std::max_element(solved.begin(), solved.end());
    return folder.plan.worker_memory;
  };
  const std::uint64_t limit = folder.manifest.limit;
  if (cut_into_fewest(folder.manifest.tiles.size(), folder.cells.cells.size(), limit, cut_into)) return;
  throw Unavailable("tiles of this mesh need " + std::to_string(mebibytes_needed(folder.plan.worker_memory)) + " MiB, the limit is " +
                    std::to_string(mebibytes(limit)) + " MiB; raise the limit, for which tiles are planned anew, or thin the cloud");
}

void write_plan(const std::string& folder, const MeshPlan& plan) {
  json out = {{"schema", kMeshSchema},
              {"schema_version", kMeshVersion},
              {"spacing", plan.spacing},
              {"noise", {plan.noise.position, plan.noise.normal}},
              {"heights", {plan.heights.usual, plan.heights.stray_share}},
              {"inside_out", plan.inside_out},
              {"worker_memory_bytes", plan.worker_memory},
              {"tiles", json::array()}};
  for (const Tile& tile : plan.tiles) out["tiles"].push_back(json::array({tile.first_cell, tile.last_cell, tile.own, tile.solved}));
  io::OutputFile file(mesh_plan_path(folder));
  file.write(out.dump(1) + "\n");
  file.commit();
}

MeshPlan parsed_mesh_plan(const json& from) {
  MeshPlan plan;
  from.at("spacing").get_to(plan.spacing);
  plan.noise = {from.at("noise").at(0), from.at("noise").at(1)};
  plan.heights = {from.at("heights").at(0), from.at("heights").at(1)};
  from.at("inside_out").get_to(plan.inside_out);
  plan.worker_memory = whole_number(from.at("worker_memory_bytes"));
  for (const json& tile : from.at("tiles"))
    plan.tiles.push_back({whole_number(tile.at(0)), whole_number(tile.at(1)), whole_number(tile.at(2)), whole_number(tile.at(3))});
  return plan;
}

bool is_sound(const MeshPlan& plan, const Cells& cells) {
  std::uint64_t next = 0;
  for (const Tile& tile : plan.tiles) {
    if (tile.first_cell != next || tile.last_cell <= next || tile.last_cell > cells.cells.size()) return false;
    if (tile.own != cells.end(static_cast<std::size_t>(tile.last_cell) - 1) - cells.cells[static_cast<std::size_t>(next)].begin)
      return false;
    next = tile.last_cell;
  }
  return next == cells.cells.size() && plan.spacing > 0 && plan.spacing < 4;
}

}  // namespace

mesh::LevelRule MeshFolder::levels() const {
  const double level = std::ceil(std::log2(2 / (kLargestCell * mesh::cell_under(mesh::noise_seen(plan.noise)) * plan.spacing)));
  return {plan.spacing, std::clamp(static_cast<int>(level), mesh::kBaseLevel, mesh::kMaxOctreeLevel)};
}

MeshFolder read_mesh_folder(const std::string& folder, const Manifest& manifest) {
  std::error_code ignored;
  if (!std::filesystem::exists(platform::path_of(mesh_plan_path(folder)), ignored)) {
    throw InvalidInput(escape_text(folder) + ": its tiles are not meshed; g3r tiles mesh FOLDER does that");
  }
  MeshFolder out{folder, manifest, read_cells(folder, manifest), {}, {}};
  const std::string text = io::read_bytes(mesh_plan_path(folder));
  try {
    const json from = json::parse(std::string_view(text));
    if (from.at("schema") != kMeshSchema || from.at("schema_version") != kMeshVersion) fail_mesh_plan(folder, "of another version of g3r");
    out.plan = parsed_mesh_plan(from);
  } catch (const json::exception&) {
    fail_mesh_plan(folder, "damaged");
  }
  if (!is_sound(out.plan, out.cells)) fail_mesh_plan(folder, "damaged: its numbers do not go with the cells");
  find_first_codes(out);
  return out;
}

MeshFolder with_mesh_tiles(const std::string& folder, const Manifest& manifest) {
  MeshFolder made{folder, manifest, read_cells(folder, manifest), {}, {}};
  if (made.cells.level > kMaxLevel)
    throw Unavailable("the points are too unevenly spread for a mesh in tiles; mesh parts that are far apart one by one");
  choose_tiles(made);
  return made;
}

MeshFolder open_mesh_folder(const std::string& folder, const Manifest& manifest, const std::atomic<bool>* cancel) {
  std::error_code ignored;
  if (!std::filesystem::exists(platform::path_of(mesh_plan_path(folder)), ignored)) {
    MeshFolder made = with_mesh_tiles(folder, manifest);
    sample_cloud(folder, manifest, made.cells, made.plan, cancel);
    made.plan.inside_out = is_turned(folder, manifest, cancel);
    write_plan(folder, made.plan);
  }
  return read_mesh_folder(folder, manifest);
}

}  // namespace g3r::tiles
