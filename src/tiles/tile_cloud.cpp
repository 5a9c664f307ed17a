#include "tiles/tile_cloud.h"

#include "cloud/morton.h"
#include "io/output_file.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace g3r::tiles {
namespace {

constexpr std::uint64_t kScanAtOnce = std::uint64_t{1} << 16;  // records

// How many records of a file thinned by `stride` come before `place` of the order.
std::uint64_t thinned(std::uint64_t place, std::uint64_t stride) { return (place + stride - 1) / stride; }

void reserve(TileCloud& cloud, std::size_t points) {
  cloud.points.reserve(points);
  cloud.index.reserve(points);
  cloud.own.reserve(points);
  cloud.part.reserve(points);
  cloud.relative_spacing.reserve(points);
  cloud.coarse.reserve(points);
}

}  // namespace

Cells find_cells(const std::string& folder, const Manifest& manifest, Stages& stages) {
  Cells cells;
  cells.level = manifest.level;
  cells.points = manifest.sorted();
  const RecordFile<Record> file(points_path(folder, 1));
  std::vector<Record> records;
  for (std::uint64_t begin = 0; begin < cells.points; begin += kScanAtOnce) {
    stages.still_going();
    records.clear();
    file.append(begin, std::min(cells.points, begin + kScanAtOnce), records);
    for (std::size_t i = 0; i < records.size(); ++i) {
      const std::uint64_t code = morton_code(manifest.frame.to_unit(records[i].point)) >> (3 * (kGridBits - cells.level));
      if (cells.cells.empty() || cells.cells.back().code != code) cells.cells.push_back({code, begin + i});
    }
  }
  io::OutputFile out(cells_path(folder), stages.cancel());
  out.write_records(cells.cells);
  out.commit();
  return cells;
}

std::uint64_t count_tile_cloud(const Cells& cells, std::uint64_t stride, const Tile& tile) {
  const std::vector<std::uint64_t> all = strides(stride, cells.points);
  const std::vector<std::uint8_t> rings = rings_around(cells, tile.first_cell, tile.last_cell, static_cast<int>(all.size()) - 1);
  std::uint64_t count = 0;
  for (std::size_t c = 0; c < rings.size(); ++c)
    count += thinned(cells.end(c), all[rings[c]]) - thinned(cells.cells[c].begin, all[rings[c]]);
  return count;
}

TileCloud read_tile_cloud(const std::string& folder, const Manifest& manifest, const Cells& cells, const Tile& tile) {
  const std::vector<std::uint64_t> all = strides(manifest.stride, cells.points);
  std::vector<std::unique_ptr<RecordFile<Record>>> files;
  for (const std::uint64_t stride : all) files.push_back(std::make_unique<RecordFile<Record>>(points_path(folder, stride)));
  const std::vector<std::uint8_t> rings = rings_around(cells, tile.first_cell, tile.last_cell, static_cast<int>(all.size()) - 1);
  const std::vector<std::uint32_t> parts = parts_of_ring(cells, rings);
  TileCloud cloud;
  std::vector<Record> records;
  reserve(cloud, static_cast<std::size_t>(count_tile_cloud(cells, manifest.stride, tile)));
  for (std::size_t c = 0; c < rings.size();) {
    std::size_t last = c;  // cells of one ring that follow one another are read at once
    while (last < rings.size() && rings[last] == rings[c]) ++last;
    const std::uint64_t stride = all[rings[c]];
    const std::uint64_t begin = thinned(cells.cells[c].begin, stride);
    records.clear();
    files[rings[c]]->append(begin, thinned(cells.end(last - 1), stride), records);
    for (const Record& record : records) {
      cloud.points.push_back(record.point);
      cloud.index.push_back(record.index);
    }
    for (; c < last; ++c) {
      const std::uint64_t to = thinned(cells.end(c), stride);
      for (std::uint64_t place = thinned(cells.cells[c].begin, stride); place < to; ++place) {
        const std::uint64_t in_order = place * stride;
        cloud.own.push_back(c >= tile.first_cell && c < tile.last_cell ? 1 : 0);
        cloud.part.push_back(parts[c]);
        cloud.relative_spacing.push_back(std::sqrt(static_cast<double>(stride)));
        cloud.coarse.push_back(in_order % manifest.stride == 0 ? static_cast<std::uint32_t>(in_order / manifest.stride) : kNotCoarse);
      }
    }
  }
  return cloud;
}

Monitor named(const Monitor& monitor, const std::string& name) {
  Monitor out;
  out.cancel = monitor.cancel;
  if (monitor.progress) {
    out.progress = [&monitor, name](std::string_view stage, double fraction) {
      return monitor.progress(name + ": " + std::string(stage), fraction);
    };
  }
  return out;
}

}  // namespace g3r::tiles
