// Pass 1.
#include "base/vector.h"
#include "cloud/morton.h"
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
  out.write_records(records);
  out.commit();
}

// The points of a tile and around it, as they came, those that no surface goes through left out.
struct HeldPoints {
  RawPoints all;
  std::vector<std::uint8_t> held;
  std::size_t first_own = 0;  // among all
  RawPoints kept;             // those that are held
};

// Of `own` places from the first at or after the code `begin` on, a third at most are strays: more are no strays, as of a cloud.
HeldPoints held_points_around(const MeshFolder& folder, std::size_t tile, std::uint64_t begin, std::size_t own,
                              const std::atomic<bool>* cancel) {
  const std::vector<std::uint8_t> rings = Region(folder, tile).rings();
  HeldPoints out;
  out.all = read_raw_points(folder.folder, folder.manifest, folder.cells, [&](std::size_t c) { return rings[c] == 0; });
  for (Vec3& n : out.all.normals) n = vector::scale(vector::normalised(n), folder.plan.inside_out ? -1 : 1);
  const std::vector<Vec3>& places = out.all.positions;
  const auto before = [&](const Vec3& p) { return morton_code(p) < begin; };
  const auto first = std::partition_point(places.begin(), places.end(), before) - places.begin();
  out.first_own = static_cast<std::size_t>(first);
  out.held = mesh::held_points(places, out.all.normals, folder.plan.heights, cancel);
  const auto own_held = out.held.begin() + first;
  const auto own_end = own_held + static_cast<std::ptrdiff_t>(own);
  const auto strays = static_cast<double>(std::count(own_held, own_end, std::uint8_t{0}));
  if (strays > mesh::kMostStrays * static_cast<double>(own)) std::fill(own_held, own_end, std::uint8_t{1});
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (out.held[i] == 0) continue;
    out.kept.positions.push_back(places[i]);
    out.kept.normals.push_back(out.all.normals[i]);
  }
  return out;
}

}  // namespace

void write_points(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel) {
  const Tile& own = folder.plan.tiles[tile];
  std::vector<Record> records;
  const std::uint64_t first = folder.first_point(tile);
  RecordFile<Record>(points_path(folder.folder, 1)).append(first, first + own.own, records);
  std::vector<Vec3> places;
  for (const Record& record : records) places.push_back(folder.manifest.frame.to_unit(record.point));
  const auto repeats = [&](std::size_t i) { return i > 0 && records[i].point == records[i - 1].point; };
  std::size_t count = 0;
  for (std::size_t i = 0; i < records.size(); ++i) count += repeats(i) ? 0 : 1;

  const HeldPoints around = held_points_around(folder, tile, morton_code(places[0]), count, cancel);
  mesh::Prepared prepared;
  mesh::prepare(around.kept.positions, around.kept.normals, folder.plan.spacing, prepared);
  mesh::smooth_noise(folder.plan.noise, cancel, prepared);
  const std::vector<double> sizes = mesh::sizes_to_resolve(prepared);
  // Its own, in the order of the records: one place that several have is among the points around once.
  const double cell = std::ldexp(2.0, -folder.cells.level);
  std::size_t at = around.first_own;
  auto kept =
      static_cast<std::size_t>(std::count(around.held.begin(), around.held.begin() + static_cast<std::ptrdiff_t>(at), std::uint8_t{1}));
  std::vector<MeshPoint> points;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (repeats(i)) {
      points.push_back({points.back().position, points.back().normal, 0, 0, 0});
      continue;
    }
    if (around.held[at] != 0) {
      points.push_back(mesh_point(places[i], prepared, kept, sizes[kept], cell));
      ++kept;
    } else {
      points.push_back({places[i], {}, 0, 0, kStray});
    }
    ++at;
  }
  write_file(mesh_far_path(folder.folder, tile), far_nodes(places, points, std::min(kGridBits, folder.cells.level + 1)), cancel);
  write_file(mesh_points_path(folder.folder, tile), points, cancel);  // last: where it is, both are
}

}  // namespace g3r::tiles
