// Clouds in tiles: streams, the external sort, rings of cells, and that tiles give what one solve gives, whoever does them.
#include "cloud/morton.h"
#include "io/point_stream.h"
#include "sanitized.h"
#include "shapes.h"
#include "temporary_folder.h"
#include "tiles/external_sort.h"
#include "tiles/manifest.h"
#include "tiles/point_hash.h"
#include "tiles/thinned.h"
#include "tiles/tile_cloud.h"

#include <g3r/io.h>
#include <g3r/tiles.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <locale>
#include <set>

namespace g3r {
namespace {

constexpr std::size_t kPoints = 8200;  // of the torus that is solved in tiles
constexpr std::size_t kTiles = 3;
constexpr double kWorse = 1.02;                         // of the error of the normals in core
constexpr double kRounding = 1e-7;                      // of normals in float
constexpr std::size_t kEveryCut = kSanitized ? 97 : 1;  // bytes between the places where a plan is cut

void write_points(const std::string& path, const std::vector<Vec3>& points) {
  Cloud cloud;
  cloud.positions = points;
  write_cloud(path, cloud, nullptr, nullptr);
}

// Mean of (1 - n.n') / 2.
double angle_error(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (1 - normals[i][0] * truth[i][0] - normals[i][1] * truth[i][1] - normals[i][2] * truth[i][2]) / 2;
  }
  return sum / static_cast<double>(truth.size());
}

TEST(PointStream, HandsOutThePositionsOfTheFile) {
  const TemporaryFolder folder;
  const std::vector<Vec3> points = shapes::torus(1000).points;
  for (const char* name : {"a.ply", "a.las", "a.xyz", "a.npy"}) {
    write_points(folder.file(name), points);
    const Cloud whole = read_cloud(folder.file(name));
    const auto stream = io::open_points(folder.file(name));
    EXPECT_EQ(stream->left(), points.size()) << name;
    EXPECT_EQ(stream->scalar(), whole.scalar) << name;
    std::vector<Vec3> all;
    std::vector<Vec3> some;
    for (stream->next(77, some); !some.empty(); stream->next(77, some)) {
      EXPECT_LE(some.size(), 77U);
      all.insert(all.end(), some.begin(), some.end());
    }
    EXPECT_EQ(all, whole.positions) << name;
    EXPECT_EQ(stream->left(), 0U) << name;
  }
}

TEST(PointStream, RefusesWhatReadCloudRefuses) {
  const TemporaryFolder folder;
  write_points(folder.file("a.ply"), shapes::torus(1000).points);
  write_points(folder.file("a.las"), shapes::torus(1000).points);
  for (const char* name : {"a.ply", "a.las"}) {
    const std::string bytes = bytes_of(folder.file(name));
    for (const std::size_t left : {std::size_t{3}, std::size_t{60}, bytes.size() - 5}) {
      write_bytes(folder.file(name), bytes.substr(0, left));
      EXPECT_THROW((void)io::open_points(folder.file(name)), InvalidInput) << name << " " << left;
    }
  }
  EXPECT_THROW((void)io::open_points(folder.file("none.ply")), IoError);
}

TEST(PointHash, IsThatOfThePlace) {
  const Vec3 point{1, -2, 0.5};
  EXPECT_EQ(tiles::point_hash({0.0, 1, 2}), tiles::point_hash({-0.0, 1, 2}));
  EXPECT_EQ(tiles::point_hash({NAN, 1, 2}), tiles::point_hash({-NAN, 1, 2}));
  EXPECT_NE(tiles::point_hash({1, 2, 3}), tiles::point_hash({2, 1, 3}));
  EXPECT_NE(tiles::point_hash(tiles::point_hash(0, point), {}), tiles::point_hash(tiles::point_hash(0, {}), point));
}

TEST(ExternalSort, RunsGiveTheOrderOfOneSort) {
  shapes::Random random(5);
  std::vector<tiles::Record> records;
  for (std::uint64_t i = 0; i < 150000; ++i) records.push_back({{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, i});
  for (std::size_t i = 0; i < 1000; ++i) records[i].point = records[100000 + i].point;  // duplicates, in different runs
  const auto sorted = [&](std::size_t memory) {
    const TemporaryFolder folder;
    tiles::ExternalSort sort(folder.file(""), {}, memory, nullptr);
    for (const tiles::Record& record : records) sort.add(record);
    std::vector<std::uint64_t> order;
    std::uint64_t last = 0;
    sort.finish([&](std::uint64_t code, const tiles::Record& record) {
      EXPECT_LE(last, code);
      last = code;
      order.push_back(record.index);
    });
    return order;
  };
  const std::vector<std::uint64_t> order = sorted(std::size_t{1} << 30);
  EXPECT_EQ(order.size(), records.size());
  EXPECT_EQ(sorted(1), order);
}

// Occupied cells of a sphere at a level, as if each held one point.
tiles::Cells cells_of_sphere(int level) {
  std::vector<std::uint64_t> codes;
  for (const Vec3& p : shapes::sphere(20000).points) codes.push_back(morton_code(p) >> (3 * (kGridBits - level)));
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  tiles::Cells cells;
  cells.level = level;
  cells.points = codes.size();
  for (const std::uint64_t code : codes) cells.cells.push_back({code, cells.cells.size()});
  return cells;
}

std::array<int, 3> place(std::uint64_t code) {
  std::array<int, 3> at{0, 0, 0};
  for (unsigned bit = 0; bit < 63; ++bit) at[2 - bit % 3] |= static_cast<int>(code >> bit & 1U) << (bit / 3);
  return at;
}

int distance(const std::array<int, 3>& a, const std::array<int, 3>& b, int up) {
  int most = 0;
  for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs((a[k] >> up) - (b[k] >> up)));
  return most;
}

TEST(Cells, RingsAreCellsThatTouchTheTileLevelByLevel) {
  const tiles::Cells cells = cells_of_sphere(5);
  const std::size_t first = 100;
  const std::size_t last = 160;
  const std::vector<std::uint8_t> rings = tiles::rings_around(cells, first, last, 3);
  for (std::size_t c = 0; c < cells.cells.size(); ++c) {
    int expected = 0;
    for (; expected < 3; ++expected) {
      const auto near = [&](const tiles::Cell& own) { return distance(place(cells.cells[c].code), place(own.code), expected) <= 1; };
      if (std::any_of(cells.cells.begin() + first, cells.cells.begin() + last, near)) break;
    }
    ASSERT_EQ(rings[c], expected) << c;
  }
  EXPECT_EQ(std::set<std::uint8_t>(rings.begin(), rings.end()).size(), 4U);
}

TEST(Cells, PartsThatDoNotTouchAreApart) {
  tiles::Cells cells;
  cells.level = 3;
  cells.cells = {{0, 0}, {7, 1}, {448, 2}, {511, 3}};  // two that touch at a corner; two far off, and from each other
  cells.points = 4;
  const std::vector<std::uint32_t> parts = tiles::parts_of_ring(cells, {0, 0, 0, 1});
  EXPECT_EQ(parts[0], parts[1]);
  EXPECT_NE(parts[0], parts[2]);
  EXPECT_EQ(parts[3], tiles::kNoPart);
}

class Tiles : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    surface_ = new shapes::Surface(shapes::torus(kPoints, 0.6, 0.25, 2));
    write_points(folder_->file("in.ply"), surface_->points);
    TileOptions options;
    options.tiles = kTiles;
    (void)plan_tiles({folder_->file("in.ply")}, folder_->file("work"), options);
    for (const std::size_t number : {2U, 1U}) (void)run_tiles(folder_->file("work"), {number, 2, 1, "cpu"});
    (void)merge_tiles(folder_->file("work"), folder_->file("out.ply"));
  }
  static void TearDownTestSuite() {
    delete folder_;
    delete surface_;
  }
  // The work folder once more, to be spoilt.
  static std::string copy_of_work(const std::string& name) {
    std::filesystem::copy(folder_->file("work"), folder_->file(name));
    return folder_->file(name);
  }

  static TemporaryFolder* folder_;
  static shapes::Surface* surface_;
};
TemporaryFolder* Tiles::folder_ = nullptr;
shapes::Surface* Tiles::surface_ = nullptr;

TEST_F(Tiles, GiveTheNormalsOfOneSolve) {
  const Cloud out = read_cloud(folder_->file("out.ply"));
  ASSERT_EQ(out.positions, surface_->points);
  const Orientation core = orient(surface_->points);
  EXPECT_LE(angle_error(out.normals, surface_->normals), kWorse * angle_error(core.normals, surface_->normals) + kRounding);
  for (std::size_t i = 0; i < kPoints; ++i) {
    double cosine = 0;
    double square = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      cosine += out.normals[i][a] * core.normals[i][a];
      square += out.normals[i][a] * out.normals[i][a];
    }
    ASSERT_GT(cosine, 0) << i;
    ASSERT_NEAR(square, 1, kRounding * 10) << i;
  }
  EXPECT_EQ(out.confidence.size(), kPoints);
}

TEST_F(Tiles, HaveTheSameBytesWhoeverDoesThemAndAfterARestart) {
  const std::string work = copy_of_work("again");
  const std::string half = bytes_of(tiles::result_path(work, 2)).substr(0, 1000);  // of a file system that loses what it has renamed
  write_bytes(tiles::result_path(work, 2), half);
  EXPECT_EQ(tiles_status(work).done, kTiles - 1);
  EXPECT_THROW((void)merge_tiles(work, folder_->file("early.ply")), InvalidInput);
  EXPECT_THROW(check_merge(work, folder_->file("early.xyz")), InvalidInput);
  EXPECT_NO_THROW(check_merge(work, folder_->file("early.las")));
  EXPECT_EQ(run_tiles(work).done, kTiles);
  (void)merge_tiles(work, folder_->file("again.ply"));
  EXPECT_EQ(bytes_of(folder_->file("again.ply")), bytes_of(folder_->file("out.ply")));
}

TEST_F(Tiles, APlanIsMadeOnceAndOnlyForItsInputs) {
  const std::string work = folder_->file("work");
  const std::string before = bytes_of(tiles::manifest_path(work));
  TileOptions options;
  options.tiles = kTiles;
  EXPECT_EQ(plan_tiles({folder_->file("in.ply")}, work, options).done, kTiles);
  EXPECT_EQ(bytes_of(tiles::manifest_path(work)), before);
  options.hints.flip = true;
  EXPECT_THROW((void)plan_tiles({folder_->file("in.ply")}, work, options), InvalidInput);
  write_points(folder_->file("other.ply"), shapes::sphere(kPoints).points);
  EXPECT_THROW((void)plan_tiles({folder_->file("other.ply")}, work, {}), InvalidInput);
}

// Numbers as Germans write them: 4.294.967.296.
struct GermanNumbers : std::numpunct<char> {
  [[nodiscard]] char do_decimal_point() const override { return ','; }
  [[nodiscard]] char do_thousands_sep() const override { return '.'; }
  [[nodiscard]] std::string do_grouping() const override { return "\3"; }
};

TEST_F(Tiles, APlanIsTheSameInAllLocales) {
  const TemporaryFolder folder;
  TileOptions options;
  options.tiles = kTiles;
  options.max_memory = std::size_t{1} << 32;
  options.hints.inside = {{0.6, 0, 1e-3}};
  const std::vector<std::string> in{folder_->file("in.ply")};
  (void)plan_tiles(in, folder.file("work"), options);
  EXPECT_EQ(tiles::read_manifest(folder.file("work")).asked, "tiles 3 max_memory 4294967296 inside 0.59999999999999998,0,0.001");
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new GermanNumbers));
  EXPECT_NO_THROW((void)plan_tiles(in, folder.file("work"), options));
  std::locale::global(before);
}

// As many points in as many bytes, in another order: their normals would go to the wrong points.
TEST_F(Tiles, OtherPointsInTheFileOfThePlanAreRefused) {
  const TemporaryFolder folder;
  const std::string in = folder.file("in.ply");
  const std::string work = folder.file("work");
  std::vector<Vec3> points = shapes::sphere(kPoints).points;
  write_points(in, points);
  TileOptions options;
  options.tiles = kTiles;
  (void)plan_tiles({in}, work, options);
  (void)run_tiles(work);
  std::reverse(points.begin(), points.end());
  write_points(in, points);
  EXPECT_THROW((void)plan_tiles({in}, work, options), InvalidInput);
  EXPECT_THROW((void)merge_tiles(work, folder.file("out.ply")), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.ply")));
  // What an earlier plan leaves is no result of the next one.
  std::filesystem::remove(tiles::manifest_path(work));
  EXPECT_EQ(plan_tiles({in}, work, options).done, 0U);
}

TEST_F(Tiles, DamagedFoldersAreRefused) {
  const std::string work = copy_of_work("damaged");
  const std::string manifest = bytes_of(tiles::manifest_path(work));
  const auto refused = [&](const std::string& text) {
    write_bytes(tiles::manifest_path(work), text);
    EXPECT_THROW((void)run_tiles(work), InvalidInput) << text.substr(0, 200);
  };
  int cuts = 0;
  for (std::size_t length = 0; length < manifest.size() - 3; length += kEveryCut) {
    refused(manifest.substr(0, length));
    ++cuts;
  }
  RecordProperty("cuts", cuts);
  for (const char* field : {"\"points\": 8200", "\"stride\": ", "\"level\": ", "\"coarse_points\": ", "\"schema_version\": "}) {
    std::string text = manifest;
    text.insert(text.rfind(field) + std::string(field).size(), 1, '7');
    refused(text);
  }
  // Of the first, 32 times as many bytes are 0 in 64 bits.
  for (const char* number : {"576460752303423488", "1e300", "-8200", "8200.5", "null"}) {
    std::string text = manifest;
    text.replace(text.rfind("\"points\": 8200") + 10, 4, number);
    refused(text);
  }
  write_bytes(tiles::manifest_path(work), manifest);
  const tiles::Manifest sound = tiles::read_manifest(work);
  const auto spoilt = [&](const auto& spoil) {  // the frame, which a mesh is made in
    tiles::Manifest m = sound;
    spoil(m);
    tiles::write_manifest(work, m);
    EXPECT_THROW((void)run_tiles(work), InvalidInput);
  };
  for (const double factor : {-1.0, 0.0, 0.4, 2.5, 1e300}) spoilt([&](tiles::Manifest& m) { m.frame.scale *= factor; });
  spoilt([](tiles::Manifest& m) { m.frame.centre[1] += 0.1; });
  spoilt([](tiles::Manifest& m) { m.bounds.high[2] += 1; });
  spoilt([](tiles::Manifest& m) { std::swap(m.bounds.low, m.bounds.high); });
  for (const double spacing : {0.0, -0.01, 1e300, double{NAN}}) spoilt([&](tiles::Manifest& m) { m.coarse_spacing = spacing; });
  write_bytes(tiles::manifest_path(work), manifest);
  std::string cells = bytes_of(tiles::cells_path(work));
  std::swap(cells[0], cells[16]);
  std::swap(cells[1], cells[17]);
  write_bytes(tiles::cells_path(work), cells);
  EXPECT_THROW((void)run_tiles(work), InvalidInput);
  std::filesystem::remove(tiles::points_path(work, 1));
  EXPECT_THROW((void)tiles_status(work), InvalidInput);
}

// A closed point amid open ones: these may be closed too, as far as its neighbours go.
TEST(ThinnedCloud, IsOpenWhereAllAroundIs) {
  std::vector<Vec3> points;
  for (int i = 0; i < 400; ++i) points.push_back({0.05 * (i % 20), 0.0501 * (i / 20), 0});
  std::vector<std::uint8_t> open(points.size(), 1);
  EXPECT_EQ(tiles::open_all_around(points, open), open);
  open[210] = 0;
  const std::vector<std::uint8_t> around = tiles::open_all_around(points, open);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = std::hypot(points[i][0] - points[210][0], points[i][1] - points[210][1]);
    if (distance < 0.09 || distance > 0.2) {
      EXPECT_EQ(around[i], distance > 0.2 ? 1 : 0) << i;
    }
  }
  open.assign(open.size(), 0);
  EXPECT_EQ(tiles::open_all_around(points, open), open);
}

template <class Work>
std::string complaint(const Work& work) {
  try {
    work();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST_F(Tiles, PlansOfAnotherVersionAreNamed) {
  const std::string work = copy_of_work("version");
  std::string manifest = bytes_of(tiles::manifest_path(work));
  manifest.replace(manifest.rfind("\"schema_version\": ") + 18, 1, "5");
  write_bytes(tiles::manifest_path(work), manifest);
  const std::string said = complaint([&] { (void)run_tiles(work); });
  EXPECT_NE(said.find("of another version of g3r, schema 5; remove the folder, and make the plan anew"), std::string::npos) << said;
}

TEST_F(Tiles, ADamagedThinnedCloudIsNamed) {
  const std::string work = copy_of_work("coarse");
  std::filesystem::remove(tiles::result_path(work, 1));
  const std::string path = tiles::coarse_path(work);
  const std::string good = bytes_of(path);
  for (const std::size_t left : {std::size_t{0}, sizeof(tiles::CoarseNormal), good.size() - 1}) {
    write_bytes(path, good.substr(0, left));
    EXPECT_NE(complaint([&] { (void)run_tiles(work); }).find("coarse.bin has " + std::to_string(left) + " bytes"), std::string::npos);
  }
  const auto spoilt = [&](const auto& spoil) {
    tiles::CoarseNormal record{};
    std::string bad = good;
    std::memcpy(&record, good.data() + 7 * sizeof record, sizeof record);
    spoil(record);
    std::memcpy(bad.data() + 7 * sizeof record, &record, sizeof record);
    write_bytes(path, bad);
    EXPECT_NE(complaint([&] { (void)run_tiles(work); }).find("coarse.bin: damaged at record 7; remove the folder"), std::string::npos);
  };
  for (const float x : {NAN, INFINITY, -2.0F}) {
    spoilt([&](tiles::CoarseNormal& c) { c.normal[1] = x; });
    spoilt([&](tiles::CoarseNormal& c) { c.confidence = x; });
    spoilt([&](tiles::CoarseNormal& c) { c.area = x; });
  }
  spoilt([](tiles::CoarseNormal& c) { c.open = 2; });
  const std::string done = copy_of_work("done");
  std::filesystem::copy_file(path, tiles::coarse_path(done), std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(complaint([&] { (void)mesh_tiles(done); }).find("coarse.bin: damaged at record 7; remove the folder"), std::string::npos);
  write_bytes(path, std::string(good.size(), '\0'));
  EXPECT_NE(complaint([&] { (void)run_tiles(work); }).find("no surface found"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(tiles::result_path(work, 1)));
  write_bytes(path, good);
  EXPECT_EQ(run_tiles(work).done, kTiles);
  EXPECT_TRUE(bytes_of(tiles::result_path(work, 1)) == bytes_of(tiles::result_path(folder_->file("work"), 1)));
}

TEST_F(Tiles, ADamagedResultIsNamedAndDoneAgain) {
  const std::string work = copy_of_work("results");
  const std::string path = tiles::result_path(work, 1);
  const std::string good = bytes_of(path);
  std::string bad = good;
  bad.replace(5 * sizeof(tiles::Result), 8, 8, '\x7f');  // the index of a point
  write_bytes(path, bad);
  EXPECT_NE(complaint([&] { (void)merge_tiles(work, folder_->file("bad.ply")); }).find("tile-1.bin: damaged at record 5;"),
            std::string::npos);
  bad = good;
  bad.replace(sizeof(tiles::Result) + 8, 4, 4, '\xff');  // NaN
  write_bytes(path, bad);
  EXPECT_NE(complaint([&] { (void)merge_tiles(work, folder_->file("bad.ply")); }).find("tile-1.bin: damaged at record 1;"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_->file("bad.ply")));
  write_bytes(path, good);
  EXPECT_EQ(tiles_status(work).done, kTiles);
  (void)merge_tiles(work, folder_->file("good.ply"));
  EXPECT_TRUE(bytes_of(folder_->file("good.ply")) == bytes_of(folder_->file("out.ply")));
}

// Evenly spread over the unit square: the sequence of the plastic number (Roberts).
std::array<double, 2> on_square(std::size_t i) {
  const double n = static_cast<double>(i + 1);
  return {std::fmod(0.7548776662466927 * n, 1), std::fmod(0.5698402909980532 * n, 1)};
}

// A level layer, and above it a twisted one that stands: its ends lean to different sides, so that what is up for one tile is down for
// another. Open surfaces have no side but the one that all of the scene agrees on.
TEST(TilesOfOpenSurfaces, FaceAsOne) {
  constexpr std::size_t kLevel = 5400, kStanding = 2700;
  constexpr double kTwist = 0.5;
  std::vector<Vec3> points, truth;
  for (std::size_t i = 0; i < kLevel + kStanding; ++i) {
    const auto [u, v] = on_square(i < kLevel ? i : i - kLevel);
    const double x = 2 * u - 1, z = v / 2 - 0.05;
    points.push_back(i < kLevel ? Vec3{x, v - 0.5, -0.3} : Vec3{x, kTwist * x * z, z});
    truth.push_back(i < kLevel ? Vec3{0, 0, 1} : Vec3{-kTwist * z, 1, -kTwist * x});
  }
  const TemporaryFolder folder;
  write_points(folder.file("in.ply"), points);
  TileOptions options;
  options.tiles = 4;
  const TileStatus plan = plan_tiles({folder.file("in.ply")}, folder.file("work"), options);
  EXPECT_GT(plan.open_share, 0.9);
  (void)run_tiles(folder.file("work"));
  (void)merge_tiles(folder.file("work"), folder.file("out.ply"));
  const Cloud out = read_cloud(folder.file("out.ply"));
  std::array<std::size_t, 2> along{0, 0};  // of the level layer, of the standing one
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double cosine = out.normals[i][0] * truth[i][0] + out.normals[i][1] * truth[i][1] + out.normals[i][2] * truth[i][2];
    along[i < kLevel ? 0 : 1] += cosine > 0 ? 1 : 0;
    ASSERT_LE(out.confidence[i], 0.5F) << i;  // a choice
  }
  EXPECT_EQ(along[0], kLevel);                                      // up
  EXPECT_TRUE(along[1] == 0 || along[1] == kStanding) << along[1];  // either side, but one
}

TEST(TilesPlan, NamesTheFileThatIsGarbage) {
  const TemporaryFolder folder;
  write_points(folder.file("a.ply"), shapes::sphere(kPoints).points);
  write_points(folder.file("b.ply"), std::vector<Vec3>(99, Vec3{NAN, 0, 0}));
  const auto plan = [&] { (void)plan_tiles({folder.file("a.ply"), folder.file("b.ply")}, folder.file("work")); };
  EXPECT_NE(complaint(plan).find("b.ply: from the first to the last of its 99 points"), std::string::npos);
  const std::string bytes = bytes_of(folder.file("a.ply"));
  write_bytes(folder.file("b.ply"), bytes.substr(0, bytes.size() - 9));
  EXPECT_NE(complaint(plan).find("b.ply: byte "), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.file("work")));
}

TEST(TilesPlan, ProgressGoesOnWithinAFile) {
  const TemporaryFolder folder;
  write_points(folder.file("in.npy"), shapes::sphere(140000).points);  // more than are read at once
  double most = 0;
  Monitor monitor;
  monitor.progress = [&](std::string_view stage, double fraction) {
    EXPECT_TRUE(fraction >= 0 && fraction <= 1) << stage;
    if (stage == "read") most = std::max(most, fraction);
    return stage == "read";
  };
  EXPECT_THROW((void)plan_tiles({folder.file("in.npy")}, folder.file("work"), {}, monitor), Cancelled);
  EXPECT_GT(most, 0.9);
}

// Reading and sorting may take hours.
TEST(TilesPlan, UnusableOptionsAreRefusedBeforeThePointsAreRead) {
  const TemporaryFolder folder;
  write_points(folder.file("in.ply"), shapes::sphere(kPoints).points);
  bool has_begun = false;
  Monitor monitor;
  monitor.progress = [&](std::string_view, double) { return has_begun = true; };
  const auto plan = [&](const Hints& hints, int threads, const std::string& device) {
    (void)plan_tiles({folder.file("in.ply")}, folder.file("work"), {0, 0, hints, threads, device}, monitor);
  };
  for (const Hints& hints : {Hints{.up = Vec3{0, 0, 0}}, Hints{.sensors = {{NAN, 0, 0}}}, Hints{.inside = {{0, 0, INFINITY}}}})
    EXPECT_THROW(plan(hints, 0, "cpu"), InvalidInput);
  EXPECT_THROW(plan({}, -1, "cpu"), InvalidInput);
  EXPECT_THROW(plan({}, 0, "gpus"), InvalidInput);
  EXPECT_THROW(plan({}, 0, "gpu:1000"), Unavailable);
  EXPECT_FALSE(has_begun);
  EXPECT_FALSE(std::filesystem::exists(folder.file("work")));
  plan({}, 0, "cpu");
  EXPECT_TRUE(has_begun);
  EXPECT_THROW((void)run_tiles(folder.file("work"), {1, 1, -1}), InvalidInput);
  EXPECT_THROW((void)mesh_tiles(folder.file("work"), {1, 1, -1}), InvalidInput);
}

TEST(TilesPlan, TellsWhatItCannotDo) {
  const TemporaryFolder folder;
  write_points(folder.file("few.ply"), shapes::sphere(500).points);
  EXPECT_THROW((void)plan_tiles({folder.file("few.ply")}, folder.file("work")), InvalidInput);
  write_points(folder.file("in.ply"), shapes::sphere(kPoints).points);
  TileOptions options;
  options.max_memory = 1000;
  EXPECT_THROW((void)plan_tiles({folder.file("in.ply")}, folder.file("work"), options), Unavailable);
  EXPECT_THROW((void)run_tiles(folder.file("work")), InvalidInput);
  EXPECT_THROW((void)run_tiles(folder.file("work"), {3, 2}), InvalidInput);
  EXPECT_FALSE(needs_tiles({folder.file("few.ply")}, 1000));
  EXPECT_FALSE(needs_tiles({folder.file("in.ply")}, std::size_t{10} << 20U));  // of which tiles would take more than one piece
  write_points(folder.file("more.ply"), shapes::sphere(120'000).points);
  EXPECT_TRUE(needs_tiles({folder.file("more.ply")}, std::size_t{10} << 20U));
  EXPECT_TRUE(needs_tiles({folder.file("more.ply")}, std::size_t{130} << 20U, true));
  EXPECT_FALSE(needs_tiles({folder.file("more.ply")}, std::size_t{130} << 20U));
  EXPECT_FALSE(needs_tiles({folder.file("more.ply")}, 0));
}

}  // namespace
}  // namespace g3r
