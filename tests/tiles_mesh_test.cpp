// A mesh in tiles: closed and 2-manifold across their borders, near the surface, the same whoever makes it.
#include "sanitized.h"
#include "shapes.h"
#include "temporary_folder.h"
#include "tiles/cell_codes.h"
#include "tiles/manifest.h"
#include "tiles/mesh_passes.h"
#include "tiles/mesh_plan.h"
#include "tiles/mesh_records.h"
#include "tiles/patches_file.h"
#include "tiles/spacing_sample.h"

#include <g3r/io.h>
#include <g3r/mesh.h>
#include <g3r/tiles.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <set>

namespace g3r {
namespace {

constexpr std::size_t kPoints = 9000;
constexpr std::size_t kTiles = 4;
constexpr int kBodyLevel = 6;  // of the cells of a hollow ball
constexpr std::size_t kBodyTiles = 60;
constexpr double kRing = 0.6;  // radii of the torus
constexpr double kTube = 0.25;
constexpr std::size_t kBallPoints = 122;  // as dense as the torus
constexpr double kBall = 0.08;            // radius of a ball in the middle, where tiles meet
constexpr std::size_t kStrays = 150;
constexpr double kSpacingError = 0.1;  // of random samples: the median over 8 neighbours is a few hundredths above the mean
constexpr double kFar = 0.05;          // of the radius of the tube: farther from it no vertex is
constexpr std::size_t kEveryCut = kSanitized ? 61 : 1;  // bytes between the places where a plan is cut

// Points far from the torus and the ball, with normals of all directions, as a scanner leaves them.
void add_strays(shapes::Surface& surface) {
  shapes::Random random(5);
  for (std::size_t count = 0; count < kStrays;) {
    const Vec3 p{random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8)};
    if (std::abs(std::hypot(std::hypot(p[0], p[1]) - kRing, p[2]) - kTube) < 0.1 || std::hypot(p[0], p[1], p[2]) < 0.2) continue;
    surface.points.push_back(p);
    surface.normals.push_back(random.direction());
    ++count;
  }
}

// The results of all tiles: normals that are known. The solves have a test of their own, and take their time.
void write_normals(const std::string& work, const std::vector<Vec3>& normals) {
  const tiles::Manifest manifest = tiles::read_manifest(work);
  const tiles::Cells cells = tiles::read_cells(work, manifest);
  const tiles::RecordFile<tiles::Record> points(tiles::points_path(work, 1));
  for (std::size_t t = 0; t < manifest.tiles.size(); ++t) {
    const std::uint64_t begin = cells.cells[manifest.tiles[t].first_cell].begin;
    std::vector<tiles::Record> records;
    points.append(begin, begin + manifest.tiles[t].own, records);
    std::sort(records.begin(), records.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
    std::string bytes;
    for (const tiles::Record& record : records) {
      tiles::Result result{record.index, {}, 1};
      for (std::size_t a = 0; a < 3; ++a) result.normal[a] = static_cast<float>(normals[record.index][a]);
      bytes.append(reinterpret_cast<const char*>(&result), sizeof result);
    }
    write_bytes(tiles::result_path(work, t), bytes);
  }
}

class TilesMesh : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    surface_ = new shapes::Surface(shapes::torus(kPoints, kRing, kTube, 2));
    const shapes::Surface ball = shapes::sphere(kBallPoints, kBall);
    surface_->points.insert(surface_->points.end(), ball.points.begin(), ball.points.end());
    surface_->normals.insert(surface_->normals.end(), ball.normals.begin(), ball.normals.end());
    add_strays(*surface_);
    surface_->points.push_back(surface_->points[7]);  // one place twice
    surface_->normals.push_back(surface_->normals[7]);
    Cloud cloud;
    cloud.positions = surface_->points;
    write_cloud(folder_->file("in.ply"), cloud, nullptr, nullptr);
    TileOptions options;
    options.tiles = kTiles;
    (void)plan_tiles({folder_->file("in.ply")}, folder_->file("plan"), options);
    const std::string work = work_folder("work");
    (void)mesh_tiles(work);
    merged_ = merge_mesh(work, folder_->file("out.ply"));
  }
  static void TearDownTestSuite() {
    delete folder_;
    delete surface_;
  }
  // A copy of the plan, its tiles with normals.
  static std::string work_folder(const std::string& name) {
    std::filesystem::copy(folder_->file("plan"), folder_->file(name));
    write_normals(folder_->file(name), surface_->normals);
    return folder_->file(name);
  }

  static TemporaryFolder* folder_;
  static shapes::Surface* surface_;
  static MergedMesh merged_;
};
TemporaryFolder* TilesMesh::folder_ = nullptr;
shapes::Surface* TilesMesh::surface_ = nullptr;
MergedMesh TilesMesh::merged_;

TEST_F(TilesMesh, IsAClosedManifoldOnTheSurface) {
  const Mesh mesh = read_mesh(folder_->file("out.ply"));
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.vertices, merged_.vertices);
  EXPECT_EQ(check.triangles, merged_.triangles);
  EXPECT_TRUE(check.closed);
  EXPECT_TRUE(check.manifold);
  EXPECT_EQ(check.components, 2U);
  EXPECT_EQ(merged_.components, 2U);
  EXPECT_EQ(check.genus, 1);
  EXPECT_GT(check.volume, 0);
  double farthest = 0;
  for (const Vec3& v : mesh.vertices) {
    const double from_axis = std::hypot(v[0], v[1]) - kRing;
    const double from_ball = std::abs(std::hypot(v[0], v[1], v[2]) - kBall);
    farthest = std::max(farthest, std::min(from_ball, std::abs(std::hypot(from_axis, v[2]) - kTube)));
  }
  EXPECT_LT(farthest, kFar * kTube);
}

// The ball is in parts of several tiles, which are one component.
TEST_F(TilesMesh, LeavesOutComponentsByTheLawOfMeshesInCore) {
  const double area = 4 * std::numbers::pi * kBall * kBall;
  MeshOptions options;
  options.min_component = 2 * kBallPoints;
  const std::string out = folder_->file("torus.ply");
  const MergedMesh torus = merge_mesh(folder_->file("work"), out, options);
  EXPECT_EQ(torus.components, 1U);
  EXPECT_EQ(torus.dropped.components, merged_.dropped.components + 1);
  EXPECT_NEAR(torus.dropped.area - merged_.dropped.area, area, 0.1 * area);
  const MeshCheck check = check_mesh(read_mesh(out));
  EXPECT_TRUE(check.closed && check.manifold);
  EXPECT_EQ(check.components, 1U);
  EXPECT_EQ(check.vertices, torus.vertices);
  EXPECT_EQ(check.triangles, torus.triangles);
  options.min_component = 0.5 * kBallPoints;
  EXPECT_EQ(merge_mesh(folder_->file("work"), out, options).components, 2U);
  EXPECT_EQ(bytes_of(out), bytes_of(folder_->file("out.ply")));
  options.keep_largest = 1;
  const MergedMesh largest = merge_mesh(folder_->file("work"), out, options);
  EXPECT_EQ(largest.triangles, torus.triangles);
  EXPECT_EQ(largest.dropped.components, merged_.dropped.components);  // it was not asked for, but has support
  options.faces = 100;
  EXPECT_THROW((void)merge_mesh(folder_->file("work"), out, options), Unavailable);
}

TEST_F(TilesMesh, HasTheSameBytesWhoeverMakesItAndAfterARestart) {
  const std::string work = folder_->file("again");
  if (kSanitized) {  // where making it twice takes a minute: what is finished, but for what is removed below
    std::filesystem::copy(folder_->file("work"), work);
  } else {
    (void)work_folder("again");
    EXPECT_EQ(mesh_tiles(work, {2, 2, 1, "cpu"}).done, kTiles / 2);
    EXPECT_THROW((void)merge_mesh(work, folder_->file("early.ply")), InvalidInput);
  }
  std::filesystem::remove(tiles::mesh_points_path(work, 1));  // what a killed worker never finished
  std::filesystem::remove(tiles::mesh_corners_path(work, 3));
  EXPECT_EQ(mesh_tiles(work, {1, 2}).done, kTiles);
  (void)merge_mesh(work, folder_->file("again.ply"));
  EXPECT_EQ(bytes_of(folder_->file("again.ply")), bytes_of(folder_->file("out.ply")));
}

TEST_F(TilesMesh, StraysAreLeftOut) {
  EXPECT_GE(merged_.dropped.points, kStrays * 9 / 10);
  EXPECT_LE(merged_.dropped.points, kStrays * 11 / 10);
  EXPECT_EQ(merged_.components, 2U);
}

// Each in cells of its own, they are more cells than those of the surface, of which spacing and noise are taken all the same.
TEST(TilesMeshOfStrays, TheSpacingIsThatOfTheSurface) {
  const TemporaryFolder folder;
  shapes::Surface s = shapes::torus(9000, kRing, kTube, 2);
  shapes::Random random(7);
  for (int k = 0; k < 400; ++k) {
    s.points.push_back({random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(2, 8)});
    s.normals.push_back(random.direction());
  }
  Cloud cloud;
  cloud.positions = s.points;
  write_cloud(folder.file("in.ply"), cloud, nullptr, nullptr);
  TileOptions options;
  options.tiles = 2;
  const std::string work = folder.file("work");
  (void)plan_tiles({folder.file("in.ply")}, work, options);
  write_normals(work, s.normals);
  (void)mesh_tiles(work);
  const tiles::MeshFolder opened = tiles::read_mesh_folder(work, tiles::read_manifest(work));
  const double spacing = std::sqrt(4 * std::numbers::pi * std::numbers::pi * kRing * kTube / 9000);
  EXPECT_NEAR(opened.plan.spacing / opened.manifest.frame.scale, spacing, kSpacingError * spacing);
  EXPECT_EQ(merge_mesh(work, folder.file("out.ply")).components, 1U);
}

TEST_F(TilesMesh, FilesOfOthersStayWhereAPlanIsRemoved) {
  const std::string work = folder_->file("shared");
  std::filesystem::copy(folder_->file("work"), work);
  write_bytes(work + "/notes.bin", "mine");
  tiles::remove_plan(work);
  EXPECT_EQ(bytes_of(work + "/notes.bin"), "mine");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(work), {}), 1);
  std::filesystem::copy(folder_->file("plan"), folder_->file("alone"));
  tiles::remove_plan(folder_->file("alone"));
  EXPECT_FALSE(std::filesystem::exists(folder_->file("alone")));
}

// A vertex that the patches have beyond its neighbours is pulled back within its tile.
TEST_F(TilesMesh, UnfoldsTrianglesThatCross) {
  const std::string work = folder_->file("folded");
  std::filesystem::copy(folder_->file("work"), work);
  const tiles::MeshFolder folder = tiles::read_mesh_folder(work, tiles::read_manifest(work));
  const Mesh clean = tiles::read_surface(folder, 0).mesh;
  EXPECT_EQ(count_self_intersections(clean), 0U);
  const auto& t = clean.triangles[clean.triangles.size() / 2];
  std::string bytes = bytes_of(tiles::mesh_patches_path(work, 0));
  tiles::MeshVertex vertex;
  char* const at = bytes.data() + sizeof(tiles::PatchesHeader) + t[0] * sizeof vertex;
  std::memcpy(&vertex, at, sizeof vertex);
  ASSERT_EQ(vertex.position, clean.vertices[t[0]]);
  for (std::size_t a = 0; a < 3; ++a) vertex.position[a] += 2.5 * (clean.vertices[t[1]][a] - vertex.position[a]);
  std::memcpy(at, &vertex, sizeof vertex);
  write_bytes(tiles::mesh_patches_path(work, 0), bytes);
  EXPECT_GT(count_self_intersections(tiles::read_surface(folder, 0).mesh), 0U);
  std::filesystem::remove(tiles::mesh_parts_path(work, 0));
  (void)mesh_tiles(work);
  const MergedMesh merged = merge_mesh(work, folder_->file("unfolded.ply"));
  EXPECT_EQ(merged.triangles, merged_.triangles);
  EXPECT_EQ(count_self_intersections(read_mesh(folder_->file("unfolded.ply"))), 0U);
}

TEST_F(TilesMesh, IsRefusedWhereItCannotBe) {
  std::filesystem::copy(folder_->file("plan"), folder_->file("no-normals"));
  EXPECT_GT(planned_mesh_memory(folder_->file("no-normals")), std::uint64_t{1} << 20);  // known before
  EXPECT_THROW((void)mesh_tiles(folder_->file("no-normals")), InvalidInput);
  EXPECT_THROW((void)merge_mesh(folder_->file("no-normals"), folder_->file("none.ply")), InvalidInput);
  EXPECT_THROW((void)merge_mesh(folder_->file("work"), folder_->file("none.obj")), InvalidInput);
  EXPECT_THROW((void)mesh_tiles(folder_->file("work"), {3, 2}), InvalidInput);
  EXPECT_THROW((void)mesh_tiles(folder_->file("work"), {1, 1, 0, "gpu:99"}), Error);
  EXPECT_THROW((void)merge_mesh(folder_->file("work"), folder_->file("in.ply")), IoError);
  EXPECT_THROW((void)merge_tiles(folder_->file("work"), folder_->file("in.ply")), IoError);
}

TEST_F(TilesMesh, DamagedFilesAreRefused) {
  const std::string work = folder_->file("damaged");
  std::filesystem::copy(folder_->file("work"), work);
  const std::string path = tiles::mesh_patches_path(work, 2);
  const std::string patches = bytes_of(path);
  const auto refused = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    EXPECT_THROW((void)merge_mesh(work, folder_->file("none.ply")), InvalidInput);
  };
  refused("");
  refused(patches.substr(0, patches.size() - 4));
  std::string wrong = patches;
  wrong.replace(wrong.size() - 4, 4, "\xff\xff\xff\xff");  // a vertex that is not there
  refused(wrong);
  wrong = patches;
  wrong[6] = 1;  // a count of 2^48
  refused(wrong);
  write_bytes(path, patches);
  const std::string parts_path = tiles::mesh_parts_path(work, 2);
  const std::string parts = bytes_of(parts_path);
  for (const std::string& bytes : {std::string(), parts.substr(0, parts.size() - 4), parts.substr(0, parts.size() - 4) + "\xff\xff\xff\xff",
                                   parts.substr(0, 6) + '\1' + parts.substr(7)}) {
    write_bytes(parts_path, bytes);
    EXPECT_THROW((void)merge_mesh(work, folder_->file("none.ply")), InvalidInput);
  }
  write_bytes(parts_path, parts);
  const std::string plan = bytes_of(tiles::mesh_plan_path(work));
  int cuts = 0;
  for (std::size_t length = 0; length + 3 < plan.size(); length += kEveryCut) {
    write_bytes(tiles::mesh_plan_path(work), plan.substr(0, length));
    EXPECT_THROW((void)merge_mesh(work, folder_->file("none.ply")), InvalidInput) << length;
    ++cuts;
  }
  RecordProperty("cuts", cuts);
}

// A sample of the cloud tells the plan its spacing, which makes the frame such that cells have the size that they have in core.
TEST_F(TilesMesh, CellsAreAsLargeAsInCore) {
  const std::string work = folder_->file("work");
  const tiles::MeshFolder folder = tiles::read_mesh_folder(work, tiles::read_manifest(work));
  const double cell = std::ldexp(2.0, -folder.levels().finest) / folder.plan.spacing;
  EXPECT_NEAR(cell, mesh::kFinestCell, kSpacingError * mesh::kFinestCell);
}

TEST(SpacingSample, TellsTheSpacingOfCloudsOfAnySize) {
  tiles::SpacingSample nothing;
  EXPECT_EQ(nothing.spacing(), 0);
  for (const std::size_t count : {1000U, 300000U}) {
    const shapes::Surface torus = shapes::torus(count, kRing, kTube, 3);
    tiles::SpacingSample sample;
    for (const Vec3& p : torus.points) sample.add(p);
    const double area = 4 * std::numbers::pi * std::numbers::pi * kRing * kTube;
    const double spacing = std::sqrt(area / static_cast<double>(count));
    EXPECT_NEAR(sample.spacing(), spacing, kSpacingError * spacing) << count;
  }
}

TEST(SpacingSample, DependsOnThePlacesAlone) {
  std::vector<Vec3> points = shapes::torus(200000, kRing, kTube, 4).points;  // more than it keeps
  const auto spacing_of = [&] {
    tiles::SpacingSample sample;
    for (const Vec3& p : points) sample.add(p);
    return sample.spacing();
  };
  const double spacing = spacing_of();
  std::reverse(points.begin(), points.end());
  points.insert(points.end(), points.begin(), points.begin() + 50000);
  EXPECT_EQ(spacing_of(), spacing);
}

// Float coordinates so far from the origin that their steps are as large as triangles.
TEST(TilesMeshFarAway, IsNotRounded) {
  const TemporaryFolder folder;
  const shapes::Surface s = shapes::torus(kPoints, kRing, kTube, 2);
  Cloud cloud;
  cloud.scalar = Scalar::kFloat32;
  for (const Vec3& p : s.points) {
    cloud.positions.push_back(
        {static_cast<float>(20 * p[0] + 500000), static_cast<float>(20 * p[1] + 500000), static_cast<float>(20 * p[2])});
  }
  write_cloud(folder.file("in.ply"), cloud, nullptr, nullptr);
  TileOptions options;
  options.tiles = 2;
  (void)plan_tiles({folder.file("in.ply")}, folder.file("work"), options);
  write_normals(folder.file("work"), s.normals);
  (void)mesh_tiles(folder.file("work"));
  (void)merge_mesh(folder.file("work"), folder.file("out.ply"));
  const Mesh mesh = read_mesh(folder.file("out.ply"));
  const auto is_float = [](const Vec3& v) { return static_cast<float>(v[0]) == v[0] && static_cast<float>(v[1]) == v[1]; };
  EXPECT_LT(std::count_if(mesh.vertices.begin(), mesh.vertices.end(), is_float), 0.01 * static_cast<double>(mesh.vertices.size()));
}

TEST_F(TilesMesh, RingsAreCellsAroundThePlacesOfATile) {
  const std::string work = folder_->file("work");
  const tiles::Manifest manifest = tiles::read_manifest(work);
  const tiles::MeshFolder folder = tiles::read_mesh_folder(work, manifest);
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const tiles::Region region(folder, t);
    const std::vector<std::uint8_t> rings = region.rings();
    for (std::size_t c = 0; c < rings.size(); ++c) {
      const std::uint64_t code = folder.cells.cells[c].code;
      EXPECT_EQ(region.owns(code), folder.owner(code) == t);
      const bool near =
          tiles::any_neighbour(code, folder.cells.level, tiles::kAround, [&](auto other) { return folder.owner(other) == t; });
      EXPECT_EQ(rings[c] == 0, near) << t << " " << c;
    }
  }
}

// The cells of a hollow ball in tiles, without points.
tiles::MeshFolder hollow_ball() {
  tiles::MeshFolder out;
  out.cells.level = kBodyLevel;
  const std::int64_t side = std::int64_t{1} << kBodyLevel;
  for (std::uint64_t code = 0; code < std::uint64_t{1} << (3 * kBodyLevel); ++code) {
    double squared = 0;
    for (int a = 0; a < 3; ++a) {
      const double x = static_cast<double>(tiles::gather_bits(code >> a)) + 0.5 - 0.5 * static_cast<double>(side);
      squared += x * x;
    }
    if (std::abs(std::sqrt(squared) - 0.4 * static_cast<double>(side)) < 1) out.cells.cells.push_back({code, out.cells.points++});
  }
  out.plan.tiles = tiles::cut(out.cells, kBodyTiles);
  for (const tiles::Tile& tile : out.plan.tiles) out.first_code.push_back(out.cells.cells[tile.first_cell].code);
  out.first_code[0] = 0;
  return out;
}

// Far from all points leaves are large, and their corners in tiles whose points are elsewhere. Where a tile did not read these it would
// take them for outside, and have pieces of surface within bodies, on which tiles do not agree.
TEST(TilesOfCorners, AreThoseOfAllLeavesThatTouchTheTile) {
  const tiles::MeshFolder folder = hollow_ball();
  const tiles::Cells& cells = folder.cells;
  std::set<std::uint64_t> occupied;  // 1 before the bits of a code
  for (const tiles::Cell& cell : cells.cells) {
    for (int up = 0; up <= cells.level; ++up) occupied.insert((std::uint64_t{1} << (3 * cells.level) | cell.code) >> (3 * up));
  }
  const mesh::Octree octree({-1, -1, -1}, 2, {}, [&](const mesh::OctreeNode& node) {
    const int level = node.level;
    const auto holds = [&](std::uint64_t code) { return occupied.count(std::uint64_t{1} << (3 * level) | code) != 0; };
    const bool is_split =
        level < mesh::kBaseLevel || (level < cells.level && tiles::any_neighbour(tiles::cell_at(node.low, level), level, 1, holds));
    return is_split ? mesh::Split::kYes : mesh::Split::kNo;
  });
  std::set<std::array<std::uint32_t, 3>> corners;
  for (std::size_t c = 0; c < octree.corner_count(); ++c) corners.insert(octree.corner_grid(c));
  std::vector<std::set<std::size_t>> wanted(folder.tiles());
  for (std::size_t leaf = 0; leaf < octree.leaf_count(); ++leaf) {
    const mesh::OctreeNode node = octree.leaf(leaf);
    const std::uint32_t half = octree.extent(node) / 2;
    std::set<std::size_t> owners;
    for (std::uint32_t k = 0; k < 27; ++k) {
      const std::array<std::uint32_t, 3> at{node.low[0] + k % 3 * half, node.low[1] + k / 3 % 3 * half, node.low[2] + k / 9 * half};
      if (corners.count(at) != 0) owners.insert(folder.owner(tiles::cell_at(at, cells.level)));
    }
    const std::uint64_t size = std::uint64_t{1} << (cells.level - node.level);  // cells along it, and one more on each side touches it
    std::array<std::uint64_t, 3> first{};
    for (std::size_t a = 0; a < 3; ++a) first[a] = node.low[a] >> (mesh::kMaxOctreeLevel - cells.level);
    const std::uint64_t side = std::uint64_t{1} << cells.level;
    for (std::uint64_t x = first[0] - (first[0] > 0 ? 1 : 0); x < std::min(side, first[0] + size + 1); ++x) {
      for (std::uint64_t y = first[1] - (first[1] > 0 ? 1 : 0); y < std::min(side, first[1] + size + 1); ++y) {
        for (std::uint64_t z = first[2] - (first[2] > 0 ? 1 : 0); z < std::min(side, first[2] + size + 1); ++z)
          wanted[folder.owner(tiles::cell_code(x, y, z))].insert(owners.begin(), owners.end());
      }
    }
  }
  std::size_t elsewhere = 0;
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const std::vector<std::size_t> found = tiles::tiles_of_corners(folder, t);
    EXPECT_TRUE(std::includes(found.begin(), found.end(), wanted[t].begin(), wanted[t].end())) << t;
    EXPECT_LT(found.size(), folder.tiles());
    const std::vector<std::size_t> around = tiles::tiles_around(folder, t);
    elsewhere += std::includes(around.begin(), around.end(), wanted[t].begin(), wanted[t].end()) ? 0 : 1;
  }
  EXPECT_GT(elsewhere, 0U);
}

}  // namespace
}  // namespace g3r
