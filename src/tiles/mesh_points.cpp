// Pass 1.
#include "base/vector.h"
#include "io/output_file.h"
#include "tiles/mesh_passes.h"

#include <g3r/io.h>

#include <algorithm>
#include <cmath>

namespace g3r::tiles {
namespace {

MeshPoint mesh_point(const Vec3& raw, const mesh::Prepared& prepared, std::size_t i, double size, double cell) {
  const Vec3& at = prepared.points.positions[i];
  const Vec3 moved = vector::subtract(at, raw);
  MeshPoint out{at, {}, static_cast<float>(prepared.points.spacing[i]), static_cast<float>(size), 0};
  for (std::size_t a = 0; a < 3; ++a) out.normal[a] = static_cast<float>(prepared.points.normals[i][a]);
  constexpr double kInside = 1 - 1e-6;  // rounding to float must not make it wider
  out.room = static_cast<float>(std::max(0.0, kInside * (cell - std::sqrt(vector::dot(moved, moved)))));
  return out;
}

// Adds points of one cell, and later cells of one cell.
class Sum {
 public:
  void add(const Vec3& place, const Vec3& eta, double area) {
    for (std::size_t a = 0; a < 3; ++a) {
      place_[a] += area * place[a];
      eta_[a] += eta[a];
    }
    area_ += area;
  }
  [[nodiscard]] FarNode node(std::uint64_t key) const {
    FarNode out{key, vector::scale(place_, 1 / area_), {}, static_cast<float>(area_)};
    for (std::size_t a = 0; a < 3; ++a) out.eta[a] = static_cast<float>(eta_[a]);
    return out;
  }
  [[nodiscard]] bool is_empty() const { return area_ == 0; }

 private:
  Vec3 place_{0, 0, 0};
  Vec3 eta_{0, 0, 0};
  double area_ = 0;
};

// Sums of what `items` ascending in their keys at one level hold, at the level above.
std::vector<FarNode> parents_of(const std::vector<FarNode>& items) {
  std::vector<FarNode> out;
  for (std::size_t i = 0; i < items.size();) {
    const std::uint64_t key = items[i].key >> 3;
    Sum sum;
    for (; i < items.size() && items[i].key >> 3 == key; ++i) {
      sum.add(items[i].place, {items[i].eta[0], items[i].eta[1], items[i].eta[2]}, items[i].area);
    }
    out.push_back(sum.node(key));
  }
  return out;
}

// One level below that of the cells, and all above. In the order of the raw points.
std::vector<FarNode> far_nodes(const std::vector<Vec3>& raw, const std::vector<MeshPoint>& points, int level) {
  const auto key_of = [&](const Vec3& p) { return std::uint64_t{1} << (3 * level) | morton_code(p) >> (3 * (kGridBits - level)); };
  std::vector<FarNode> level_nodes;
  Sum sum;
  std::uint64_t now = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint64_t key = key_of(raw[i]);
    if (key != now && !sum.is_empty()) {
      level_nodes.push_back(sum.node(now));
      sum = {};
    }
    now = key;
    if (points[i].spacing == 0) continue;
    const double area = double{points[i].spacing} * points[i].spacing;
    const auto& n = points[i].normal;
    sum.add(points[i].position, {area * n[0], area * n[1], area * n[2]}, area);
  }
  if (!sum.is_empty()) level_nodes.push_back(sum.node(now));
  std::vector<FarNode> all;
  for (int l = level; l >= 0; --l) {
    all.insert(all.begin(), level_nodes.begin(), level_nodes.end());
    level_nodes = parents_of(level_nodes);
  }
  return all;
}

template <class T>
void write_file(const std::string& path, const std::vector<T>& records, const std::atomic<bool>* cancel) {
  io::OutputFile out(path, cancel);
  out.write(records.data(), records.size() * sizeof(T));
  out.commit();
}

}  // namespace

void write_points(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel) {
  const std::vector<std::uint8_t> rings = Region(folder, tile).rings();
  RawPoints raw = read_raw_points(folder.folder, folder.manifest, folder.cells, [&](std::size_t c) { return rings[c] == 0; });
  if (folder.plan.inside_out) {
    for (Vec3& n : raw.normals) n = vector::scale(n, -1);
  }
  mesh::Prepared prepared;
  mesh::prepare(raw.positions, raw.normals, folder.plan.spacing, prepared);
  mesh::smooth_noise(folder.plan.noise, cancel, prepared);
  const std::vector<double> sizes = mesh::sizes_to_resolve(prepared);
  // Its own, in the order of the records: one place that several have is among the raw points once.
  const Tile& own = folder.plan.tiles[tile];
  std::vector<Record> records;
  const std::uint64_t first = folder.first_point(tile);
  RecordFile<Record>(points_path(folder.folder, 1)).append(first, first + own.own, records);
  const std::uint64_t begin = morton_code(folder.manifest.frame.to_unit(records[0].point));
  const auto before = [&](const Vec3& p) { return morton_code(p) < begin; };
  auto at = static_cast<std::size_t>(std::partition_point(raw.positions.begin(), raw.positions.end(), before) - raw.positions.begin());
  const double cell = std::ldexp(2.0, -folder.cells.level);
  std::vector<MeshPoint> points;
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < records.size(); ++i) {
    places.push_back(folder.manifest.frame.to_unit(records[i].point));
    if (i > 0 && records[i].point == records[i - 1].point) {
      points.push_back({points.back().position, points.back().normal, 0, 0, 0});
      continue;
    }
    points.push_back(mesh_point(raw.positions[at], prepared, at, sizes[at], cell));
    ++at;
  }
  write_file(mesh_far_path(folder.folder, tile), far_nodes(places, points, std::min(kGridBits, folder.cells.level + 1)), cancel);
  write_file(mesh_points_path(folder.folder, tile), points, cancel);  // last: where it is, both are
}

}  // namespace g3r::tiles
