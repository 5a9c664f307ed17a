#include "tiles/manifest.h"

#include "base/platform.h"
#include "cloud/morton.h"
#include "io/output_file.h"
#include "io/source.h"
#include "tiles/records.h"
#include "tiles/tile_cloud.h"
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

constexpr const char* kSchema = "g3r.tiles";
constexpr int kVersion = 6;
constexpr std::uint64_t kFewestThinned = 1000;                  // points of the thinnest file: fewer would save nothing
constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 48U;  // sizes of files are numbers below; the manifest may be damaged

using nlohmann::json;

std::uint64_t size_of_file(const std::string& path) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(platform::path_of(path), error);
  return error ? 0 : size;
}

[[noreturn]] void fail(const std::string& folder, const std::string& what) {
  throw InvalidInput(escape_text(manifest_path(folder)) + ": " + what + "; remove the folder, and make the plan anew");
}

// Whether a file has a name that a plan, its workers or a part of a sort gives.
bool is_of_plan(const std::string& name) {
  constexpr std::string_view kEnd = ".bin";
  constexpr std::string_view kSingle[] = {"manifest.json", "mesh.json", "cells.bin", "coarse.bin"};
  constexpr std::string_view kNumbered[] = {"points-",   "tile-",         "run-",          "mesh-points-",
                                            "mesh-far-", "mesh-corners-", "mesh-patches-", "mesh-parts-"};
  if (std::find(std::begin(kSingle), std::end(kSingle), name) != std::end(kSingle)) return true;
  return std::any_of(std::begin(kNumbered), std::end(kNumbered), [&](std::string_view begin) {
    if (!name.starts_with(begin) || !name.ends_with(kEnd) || name.size() <= begin.size() + kEnd.size()) return false;
    return name.find_first_not_of("0123456789", begin.size()) == name.size() - kEnd.size();
  });
}

// Of the first file that cannot be removed; the others are gone.
std::error_code remove_files(const std::string& folder, std::string& name) {
  std::error_code first;
  const auto remove = [&](const std::filesystem::path& path) {
    std::error_code error;
    std::filesystem::remove(path, error);
    if (!error || first) return;
    first = error;
    name = platform::name_of(path);
  };
  remove(platform::path_of(manifest_path(folder)));
  if (first) return first;
  std::error_code ignored;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(platform::path_of(folder), ignored)) {
    if (is_of_plan(platform::name_of(entry.path().filename()))) files.push_back(entry.path());
  }
  for (const std::filesystem::path& file : files) remove(file);
  return first;
}

Manifest parsed(const json& from) {
  Manifest m;
  from.at("asked").get_to(m.asked);
  for (const json& input : from.at("inputs"))
    m.inputs.push_back(
        {input.at("path"), whole_number(input.at("bytes")), whole_number(input.at("points")), whole_number(input.at("hash"))});
  m.points = whole_number(from.at("points"));
  m.non_finite = whole_number(from.at("non_finite"));
  from.at("low").get_to(m.bounds.low);
  from.at("high").get_to(m.bounds.high);
  from.at("centre").get_to(m.frame.centre);
  from.at("scale").get_to(m.frame.scale);
  m.level = static_cast<int>(std::min<std::uint64_t>(whole_number(from.at("level")), kGridBits + 1));
  m.stride = whole_number(from.at("stride"));
  m.coarse_points = whole_number(from.at("coarse_points"));
  from.at("coarse_spacing").get_to(m.coarse_spacing);
  for (const json& tile : from.at("tiles"))
    m.tiles.push_back({whole_number(tile.at(0)), whole_number(tile.at(1)), whole_number(tile.at(2)), whole_number(tile.at(3))});
  m.limit = whole_number(from.at("limit_bytes"));
  m.worker_memory = whole_number(from.at("worker_memory_bytes"));
  m.disk = whole_number(from.at("disk_bytes"));
  from.at("converged").get_to(m.converged);
  from.at("consistent").get_to(m.consistent);
  from.at("doubtful").get_to(m.doubtful);
  from.at("open_share").get_to(m.open_share);
  from.at("undecided_share").get_to(m.undecided_share);
  from.at("warnings").get_to(m.warnings);
  return m;
}

// Whether the frame is that of the bounds: their middle, and a longest side as kLongestSide says.
bool is_of(const Box& bounds, const Frame& frame) {
  constexpr double kRounding = 1e-12;
  double side = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (frame.centre[a] != bounds.low[a] + (bounds.high[a] - bounds.low[a]) / 2) return false;
    side = std::max(side, (bounds.high[a] - bounds.low[a]) * frame.scale);
  }
  return side > (0.5 - kRounding) * kLongestSide && side < (1 + kRounding) * kLongestSide;
}

// Whether numbers can be of one plan: every place in a file that they lead to is checked by those who read it.
bool is_sound(const Manifest& m) {
  if (m.points > kMostPoints || m.non_finite > m.points || m.level < 0 || m.level > kGridBits || m.tiles.empty()) return false;
  if (m.stride == 0 || (m.stride & (m.stride - 1)) != 0 || m.stride > m.sorted() || !is_of(m.bounds, m.frame)) return false;
  if (m.coarse_points != (m.sorted() + m.stride - 1) / m.stride || m.coarse_points >= kNotCoarse) return false;
  if (!(m.coarse_spacing > 0 && m.frame.length_to_unit(m.coarse_spacing) < kLongestSide)) return false;
  std::uint64_t own = 0;
  std::uint64_t cell = 0;
  for (const Tile& tile : m.tiles) {
    if (tile.first_cell != cell || tile.last_cell <= cell || tile.last_cell > m.sorted() || tile.own > m.sorted() - own) return false;
    cell = tile.last_cell;
    own += tile.own;
  }
  std::uint64_t points = 0;
  for (const Input& input : m.inputs) {
    if (input.points > m.points - points) return false;
    points += input.points;
  }
  return own == m.sorted() && points == m.points;
}

void require_files(const std::string& folder, const Manifest& m) {
  const auto require = [&](const std::string& path, std::uint64_t bytes) {
    if (const std::uint64_t size = size_of_file(path); size != bytes) {
      fail(folder, escape_text(path) + " has " + std::to_string(size) + " bytes instead of " + std::to_string(bytes));
    }
  };
  for (const std::uint64_t stride : strides(m.stride, m.sorted())) {
    require(points_path(folder, stride), (m.sorted() + stride - 1) / stride * sizeof(Record));
  }
  require(coarse_path(folder), m.coarse_points * sizeof(CoarseNormal));
  require(cells_path(folder), m.tiles.back().last_cell * sizeof(Cell));
}

}  // namespace

std::vector<std::uint64_t> strides(std::uint64_t stride, std::uint64_t points) {
  std::vector<std::uint64_t> all;
  for (std::uint64_t s = 1; s < stride; s *= 4) all.push_back(s);
  all.push_back(stride);
  while (points / (4 * all.back()) >= kFewestThinned) all.push_back(4 * all.back());
  return all;
}

std::string manifest_path(const std::string& folder) { return folder + "/manifest.json"; }
std::string cells_path(const std::string& folder) { return folder + "/cells.bin"; }
std::string points_path(const std::string& folder, std::uint64_t stride) { return folder + "/points-" + std::to_string(stride) + ".bin"; }
std::string coarse_path(const std::string& folder) { return folder + "/coarse.bin"; }
std::string result_path(const std::string& folder, std::size_t tile) { return folder + "/tile-" + std::to_string(tile) + ".bin"; }

void require_worker(const TileWorker& worker) {
  if (worker.threads < 0) throw InvalidInput("threads must be 0 (all cores) or positive");
  if (worker.number >= 1 && worker.number <= worker.workers) return;
  throw InvalidInput("tiles: expected a worker of 1 to the number of workers, found " + std::to_string(worker.number) + " of " +
                     std::to_string(worker.workers));
}

void require_no_input(const Manifest& manifest, const std::string& output) {
  for (const Input& input : manifest.inputs) {
    if (!io::same_file(input.path, output)) continue;
    throw IoError(IoError::Kind::kCannotCreate, "cannot create " + escape_text(output) + ": it is an input of the plan; give another name");
  }
}

void clear_folder(const std::string& folder) {
  std::string name;
  if (const std::error_code error = remove_files(folder, name)) {
    throw IoError(IoError::Kind::kCannotCreate, "cannot remove " + escape_text(name) + ", of an earlier plan: " + error.message());
  }
}

void remove_plan(const std::string& folder) {
  std::string name;
  std::error_code ignored = remove_files(folder, name);         // a folder that cannot be removed does no harm
  std::filesystem::remove(platform::path_of(folder), ignored);  // nothing happens where files of others are in it
}

bool can_be_stored(const std::string& path) {
  try {
    (void)json(path).dump();
    return true;
  } catch (const json::exception&) {
    return false;
  }
}

bool has_manifest(const std::string& folder) {
  std::error_code ignored;
  return std::filesystem::exists(platform::path_of(manifest_path(folder)), ignored);
}

void write_manifest(const std::string& folder, const Manifest& m) {
  json out = {{"schema", kSchema},
              {"schema_version", kVersion},
              {"g3r_version", std::string(version())},
              {"asked", m.asked},
              {"points", m.points},
              {"non_finite", m.non_finite},
              {"low", m.bounds.low},
              {"high", m.bounds.high},
              {"centre", m.frame.centre},
              {"scale", m.frame.scale},
              {"level", m.level},
              {"stride", m.stride},
              {"coarse_points", m.coarse_points},
              {"coarse_spacing", m.coarse_spacing},
              {"limit_bytes", m.limit},
              {"worker_memory_bytes", m.worker_memory},
              {"disk_bytes", m.disk},
              {"converged", m.converged},
              {"consistent", m.consistent},
              {"doubtful", m.doubtful},
              {"open_share", m.open_share},
              {"undecided_share", m.undecided_share},
              {"warnings", m.warnings},
              {"inputs", json::array()},
              {"tiles", json::array()}};
  for (const Input& input : m.inputs)
    out["inputs"].push_back({{"path", input.path}, {"bytes", input.bytes}, {"points", input.points}, {"hash", input.hash}});
  for (const Tile& tile : m.tiles) out["tiles"].push_back(json::array({tile.first_cell, tile.last_cell, tile.own, tile.solved}));
  io::OutputFile file(manifest_path(folder));
  file.write(out.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
  file.commit();
}

Manifest read_manifest(const std::string& folder) {
  if (!has_manifest(folder)) {
    throw InvalidInput(escape_text(folder) + ": no plan of tiles is there (manifest.json); g3r tiles plan IN... FOLDER makes one");
  }
  Manifest manifest;
  const std::string text = io::read_bytes(manifest_path(folder));
  try {
    const json from = json::parse(std::string_view(text));
    if (from.at("schema") != kSchema) fail(folder, "not a plan of tiles");
    if (from.at("schema_version") != kVersion) fail(folder, "of another version of g3r, schema " + from.at("schema_version").dump());
    manifest = parsed(from);
  } catch (const json::exception&) {
    fail(folder, "damaged");
  }
  if (!is_sound(manifest)) fail(folder, "damaged: its numbers do not go together");
  require_files(folder, manifest);
  return manifest;
}

Cells read_cells(const std::string& folder, const Manifest& manifest) {
  Cells cells;
  cells.level = manifest.level;
  cells.points = manifest.sorted();
  const RecordFile<Cell> file(cells_path(folder));
  file.append(0, file.size(), cells.cells);
  for (std::size_t c = 0; c < cells.cells.size(); ++c) {
    const Cell& cell = cells.cells[c];
    const bool ascends = c == 0 ? cell.begin == 0 : cell.begin > cells.cells[c - 1].begin && cell.code > cells.cells[c - 1].code;
    if (!ascends || cell.begin >= cells.points || cell.code >> (3 * cells.level) != 0) {
      fail(folder, escape_text(cells_path(folder)) + ": damaged at record " + std::to_string(c));
    }
  }
  return cells;
}

std::vector<Tile> cut(const Cells& cells, std::size_t count) {
  std::vector<Tile> tiles;
  std::size_t first = 0;
  for (std::size_t t = 1; t <= count && first < cells.cells.size(); ++t) {
    const auto wanted = static_cast<std::uint64_t>(static_cast<double>(cells.points) * static_cast<double>(t) / static_cast<double>(count));
    std::size_t last = first + 1;
    while (last < cells.cells.size() && (t == count || cells.cells[last].begin < wanted)) ++last;
    tiles.push_back({first, last, cells.end(last - 1) - cells.cells[first].begin, 0});
    first = last;
  }
  tiles.back().last_cell = cells.cells.size();
  tiles.back().own = cells.points - cells.cells[static_cast<std::size_t>(tiles.back().first_cell)].begin;
  return tiles;
}

bool is_done(const std::string& folder, const Manifest& manifest, std::size_t tile) {
  return size_of_file(result_path(folder, tile)) == manifest.tiles[tile].own * sizeof(Result);
}

TileStatus status_of(const std::string& folder, const Manifest& manifest) {
  TileStatus status;
  status.points = manifest.points;
  status.non_finite = manifest.non_finite;
  status.tiles = manifest.tiles.size();
  status.coarse_points = manifest.coarse_points;
  std::uint64_t solved = manifest.coarse_points;
  for (std::size_t t = 0; t < status.tiles; ++t) {
    if (is_done(folder, manifest, t)) ++status.done;
    status.largest_tile = std::max(status.largest_tile, manifest.tiles[t].solved);
    solved += manifest.tiles[t].solved;
  }
  status.work = static_cast<double>(solved) / static_cast<double>(std::max<std::uint64_t>(1, manifest.sorted()));
  status.worker_memory_bytes = manifest.worker_memory;
  status.disk_bytes = manifest.disk;
  status.converged = manifest.converged;
  status.consistent = manifest.consistent;
  status.doubtful = manifest.doubtful;
  status.open_share = manifest.open_share;
  status.undecided_share = manifest.undecided_share;
  status.warnings = manifest.warnings;
  return status;
}

}  // namespace g3r::tiles
