#include "tiles/mesh_records.h"

#include <g3r/io.h>

#include <algorithm>

namespace g3r::tiles {
namespace {

// A point that waits for its normal.
struct Waiting {
  std::uint64_t index;
  std::size_t point;
};

// Results ascend by index; those that wait are sorted to walk along with them.
void take_normals(const std::string& path, std::vector<Waiting>& waiting, std::vector<Vec3>& normals) {
  std::sort(waiting.begin(), waiting.end(), [](const Waiting& a, const Waiting& b) { return a.index < b.index; });
  const RecordFile<Result> file(path);
  std::vector<Result> results;
  std::size_t next = 0;
  for (std::uint64_t at = 0; at < file.size() && next < waiting.size(); at += kRecordsAtOnce) {
    results.clear();
    file.append(at, std::min(file.size(), at + kRecordsAtOnce), results);
    for (const Result& r : results) {
      if (next == waiting.size() || r.index != waiting[next].index) continue;
      normals[waiting[next++].point] = {r.normal[0], r.normal[1], r.normal[2]};
    }
  }
  if (next != waiting.size()) throw InvalidInput(escape_text(path) + ": not the result of this plan; remove it, and run its tile again");
}

}  // namespace

std::string mesh_plan_path(const std::string& folder) { return folder + "/mesh.json"; }
std::string mesh_points_path(const std::string& folder, std::size_t tile) {
  return folder + "/mesh-points-" + std::to_string(tile) + ".bin";
}
std::string mesh_far_path(const std::string& folder, std::size_t tile) { return folder + "/mesh-far-" + std::to_string(tile) + ".bin"; }
std::string mesh_corners_path(const std::string& folder, std::size_t tile) {
  return folder + "/mesh-corners-" + std::to_string(tile) + ".bin";
}
std::string mesh_patches_path(const std::string& folder, std::size_t tile) {
  return folder + "/mesh-patches-" + std::to_string(tile) + ".bin";
}
std::string mesh_parts_path(const std::string& folder, std::size_t tile) { return folder + "/mesh-parts-" + std::to_string(tile) + ".bin"; }

void for_runs(std::size_t cells, const std::function<bool(std::size_t)>& wanted, const std::function<std::size_t(std::size_t)>& bound,
              const std::function<void(std::size_t, std::size_t)>& take) {
  for (std::size_t c = 0; c < cells;) {
    if (!wanted(c)) {
      ++c;
      continue;
    }
    std::size_t last = c + 1;
    while (last < cells && wanted(last) && bound(last) == bound(c)) ++last;
    take(c, last);
    c = last;
  }
}

RawPoints read_raw_points(const std::string& folder, const Manifest& manifest, const Cells& cells,
                          const std::function<bool(std::size_t)>& wanted) {
  const auto tile_of = [&](std::size_t cell) {
    const auto next = std::upper_bound(manifest.tiles.begin(), manifest.tiles.end(), cell,
                                       [](std::size_t c, const Tile& tile) { return c < tile.first_cell; });
    return static_cast<std::size_t>(next - manifest.tiles.begin()) - 1;
  };
  const RecordFile<Record> file(points_path(folder, 1));
  std::vector<std::vector<Waiting>> waiting(manifest.tiles.size());
  RawPoints out;
  std::vector<Record> records;
  for_runs(cells.cells.size(), wanted, tile_of, [&](std::size_t first, std::size_t last) {
    records.clear();
    file.append(cells.cells[first].begin, cells.end(last - 1), records);
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (i > 0 && records[i].point == records[i - 1].point) continue;
      waiting[tile_of(first)].push_back({records[i].index, out.positions.size()});
      out.positions.push_back(manifest.frame.to_unit(records[i].point));
    }
  });
  out.normals.resize(out.positions.size());
  for (std::size_t t = 0; t < waiting.size(); ++t) {
    if (!waiting[t].empty()) take_normals(result_path(folder, t), waiting[t], out.normals);
  }
  return out;
}

}  // namespace g3r::tiles
