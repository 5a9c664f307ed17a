// Gaussian splats: floaters and splats inside are distinguished from those of a surface, one by one and in a scene, from the file to the
// mesh.
#include "io/splat_light.h"

#include "io_samples.h"
#include "sanitized.h"
#include "shapes.h"

#include <g3r/g3r.h>
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

namespace g3r {
namespace {

using io::axes_of;
using io::places_of;
using io::Splat;
using io::SplatPlace;

using samples::raw;

enum Kind : std::uint8_t { kSurface, kInside, kFloating };

struct Scene {
  std::vector<Splat> splats;
  std::vector<std::array<double, 4>> rotations;
  std::vector<Vec3> normals;  // of those on the surface, else 0
  std::vector<Kind> kinds;
  double spacing = 0;

  [[nodiscard]] std::size_t count(Kind kind) const { return static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), kind)); }

  void add(const Vec3& centre, const Vec3& scale, const Vec3& third_axis, double opacity, Kind kind, const Vec3& normal) {
    // Turns z to the axis.
    std::array<double, 4> rotation{1 + third_axis[2], -third_axis[1], third_axis[0], 0};
    if (rotation[0] < 1e-9) rotation = {0, 1, 0, 0};
    rotations.push_back(rotation);
    splats.push_back({centre, scale, axes_of(rotation), opacity});
    kinds.push_back(kind);
    normals.push_back(normal);
  }
};

// An ellipsoid of discs, as training leaves them: of 0.8 spacings, a tenth as thick, tilted, half of them of an opacity above 0.82. A fifth
// of the splats is not on it: three quarters of these are inside, half of which just below the surface, the others are large and faint, and
// float.
Scene ellipsoid_of_splats(std::size_t count) {
  const Vec3 half{1, 0.8, 0.6};
  shapes::Random random(5);
  const std::size_t inside = count * 15 / 100, floating = count * 5 / 100;
  const shapes::Surface surface = shapes::ellipsoid(count - inside - floating, half[0], half[1], half[2]);
  Scene scene;
  const double h = std::sqrt(*std::max_element(surface.areas.begin(), surface.areas.end()));
  scene.spacing = h;
  const auto disc = [&] {
    return Vec3{0.8 * h * std::exp(0.3 * random.gaussian()), 0.8 * h * std::exp(0.3 * random.gaussian()), 0.08 * h};
  };
  const auto opacity = [&] { return 1 / (1 + std::exp(-1.5 - 1.5 * random.gaussian())); };
  const auto along = [](const Vec3& p, const Vec3& n, double t) { return Vec3{p[0] + t * n[0], p[1] + t * n[1], p[2] + t * n[2]}; };
  const std::vector<Vec3> tilted = shapes::disturbed(surface.normals, 0.12);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    scene.add(along(surface.points[i], surface.normals[i], 0.1 * h * random.gaussian()), disc(), tilted[i], opacity(), kSurface,
              surface.normals[i]);
  }
  const auto level = [&](const Vec3& p) { return std::hypot(p[0] / half[0], p[1] / half[1], p[2] / half[2]); };
  while (scene.count(kInside) < inside) {
    const auto i = static_cast<std::size_t>(random.uniform(0, static_cast<double>(surface.points.size())));
    const Vec3 below = along(surface.points[i], surface.normals[i], 3 * h * std::log(random.uniform(1e-9, 1)));
    const Vec3 anywhere{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const Vec3 place = random.uniform() < 0.5 ? below : anywhere;
    if (level(place) < 1 - h) scene.add(place, disc(), random.direction(), opacity(), kInside, {0, 0, 0});
  }
  while (scene.count(kFloating) < floating) {
    const Vec3 place{random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)};
    const Vec3 size{h * random.uniform(1.5, 4), h * random.uniform(1.5, 4), h * random.uniform(1.5, 4)};
    if (level(place) > 1 + h) scene.add(place, size, random.direction(), random.uniform(0.02, 0.4), kFloating, {0, 0, 0});
  }
  return scene;
}

// As 3DGS writes them, and the kind, which g3r hands through.
std::string ply_of(const Scene& scene) {
  std::string file = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(scene.splats.size()) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3", "confidence"}) {
    file += std::string("property float ") + name + "\n";
  }
  file += "end_header\n";
  const auto put = [&file](double value) { file += raw(static_cast<float>(value)); };
  for (std::size_t i = 0; i < scene.splats.size(); ++i) {
    const Splat& splat = scene.splats[i];
    for (const double x : splat.centre) put(x);
    for (int k = 0; k < 6; ++k) put(0);
    put(std::log(splat.opacity / (1 - splat.opacity)));
    for (const double s : splat.scale) put(std::log(s));
    for (const double q : scene.rotations[i]) put(q);
    put(static_cast<double>(i));
  }
  return file;
}

Cloud read_scene(const Scene& scene, const ReadOptions& options = {}) {
  const std::string file = ply_of(scene);
  return read_cloud_bytes(file.data(), file.size(), "splats", options);
}

std::size_t number_of(const std::vector<SplatPlace>& places, const Scene& scene, Kind kind, SplatPlace place) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < places.size(); ++i) count += scene.kinds[i] == kind && places[i] == place ? 1 : 0;
  return count;
}

// splats: a quaternion turns the axes as 3DGS does, whatever its length.
TEST(Splats, AQuaternionTurnsTheAxes) {
  const auto quarter = axes_of({3, 0, 0, 3});  // about z
  const std::array<Vec3, 3> expected{Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(quarter[k][a], expected[k][a], 1e-15);
  }
  EXPECT_EQ(axes_of({0, 0, 0, 0}), Splat{}.axes);
  EXPECT_EQ(axes_of({NAN, 0, 0, 1}), Splat{}.axes);
}

// splats: alone, one is solid from an opacity of one half; two faint ones at one place are, at two places they are not.
TEST(Splats, WhatStopsHalfOfTheLightIsSolid) {
  Splat faint;
  faint.opacity = 0.3;
  EXPECT_EQ(places_of({faint}).front(), SplatPlace::kTranslucent);
  EXPECT_EQ(places_of({faint, faint}), std::vector<SplatPlace>(2, SplatPlace::kSurface));  // 1 - 0.7^2 = 0.51
  Splat aside = faint;
  aside.centre = {1, 0, 0};
  EXPECT_EQ(places_of({faint, aside}), std::vector<SplatPlace>(2, SplatPlace::kTranslucent));
  faint.opacity = 0.5;
  EXPECT_EQ(places_of({faint}).front(), SplatPlace::kSurface);
  faint.opacity = 0.003;  // never drawn
  EXPECT_EQ(places_of(std::vector<Splat>(300, faint)), std::vector<SplatPlace>(300, SplatPlace::kTranslucent));
}

// splats: numbers that are not finite, or that squares of would not be, decide nothing.
TEST(Splats, WildNumbersAreHarmless) {
  std::vector<Splat> splats(8);
  splats[0].centre[1] = NAN;
  splats[1].scale[2] = INFINITY;
  splats[2].scale = {1e-300, 1e300, 1};
  splats[3].centre = {1e200, 0, 0};
  splats[4].scale = {1e-90, 1e90, 1e-90};
  splats[5].scale = {1e-90, 1e-90, 1e-90};
  splats[6].centre = {-1e90, 1e90, 0};
  EXPECT_EQ(places_of(splats), std::vector<SplatPlace>(8, SplatPlace::kSurface));
  EXPECT_TRUE(places_of({}).empty());
}

// splats: of the scene nine tenths of the surface stay (neighbours hide the others), and a twentieth of the rest.
TEST(Splats, TheSceneIsTakenApart) {
  const Scene scene = ellipsoid_of_splats(kSanitized ? 1500 : 5000);
  const std::vector<SplatPlace> places = places_of(scene.splats);
  EXPECT_GE(number_of(places, scene, kSurface, SplatPlace::kSurface), scene.count(kSurface) * 9 / 10);
  EXPECT_LE(number_of(places, scene, kInside, SplatPlace::kSurface), scene.count(kInside) / 20);
  EXPECT_LE(number_of(places, scene, kFloating, SplatPlace::kSurface), scene.count(kFloating) / 20);
}

// splats: the search can be stopped, also while a file is read, and of a file that is read whole nothing else is asked.
TEST(Splats, TheSearchCanBeCancelled) {
  const Scene scene = ellipsoid_of_splats(500);
  std::atomic<bool> cancel = true;
  EXPECT_THROW((void)places_of(scene.splats, 0, &cancel), Cancelled);
  EXPECT_THROW((void)read_scene(scene, {.cancel = &cancel}), Cancelled);
  EXPECT_EQ(read_scene(scene, {.all_splats = true, .cancel = &cancel}).positions.size(), scene.splats.size());
  cancel = false;
  EXPECT_EQ(places_of(scene.splats, 1, &cancel), places_of(scene.splats));
}

#ifdef GTEST_HAS_DEATH_TEST
std::size_t threads_of_process() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

// splats: asked for one thread, the search starts no other. In a process of its own, as threads of earlier tests would wait for work.
TEST(SplatsDeathTest, OneThreadStartsNoOther) {
  if (!std::filesystem::exists("/proc/self/task")) GTEST_SKIP() << "threads are counted in /proc";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto started = [](int threads) {
    const Scene scene = ellipsoid_of_splats(2000);
    const std::size_t before = threads_of_process();
    (void)read_scene(scene, {.threads = threads});
    return static_cast<int>(threads_of_process() - before);
  };
  EXPECT_EXIT(std::exit(started(1)), ::testing::ExitedWithCode(0), "");
}
#endif

// splats: in a room, whose walls hide what stands in it, nothing is hidden.
TEST(Splats, ARoomKeepsItsFurniture) {
  Scene room = ellipsoid_of_splats(kSanitized ? 2000 : 4000);
  const std::size_t furniture = room.splats.size();
  for (std::size_t i = 0; i < furniture; ++i) {
    if (room.kinds[i] != kSurface) continue;
    Splat wall = room.splats[i];
    for (double& x : wall.centre) x *= 2;
    for (double& s : wall.scale) s *= 2;
    room.splats.push_back(wall);
  }
  const std::vector<SplatPlace> places = places_of(room.splats);
  EXPECT_EQ(std::count(places.begin(), places.end(), SplatPlace::kHidden), 0);
}

// splats: what is left out of a file is said, with the way to keep it; what stays keeps its order.
TEST(Splats, TheReaderSaysWhatIsLeftOut) {
  const Scene scene = ellipsoid_of_splats(2000);
  const Cloud all = read_scene(scene, {.all_splats = true});
  EXPECT_EQ(all.positions.size(), scene.splats.size());
  const Cloud cloud = read_scene(scene);
  EXPECT_LT(cloud.positions.size(), scene.splats.size() * 83 / 100);
  EXPECT_TRUE(std::is_sorted(cloud.confidence.begin(), cloud.confidence.end()));
  ASSERT_FALSE(cloud.warnings.empty());
  const std::string& warning = cloud.warnings.front();
  EXPECT_NE(warning.find("of 2000 splats are left out"), std::string::npos) << warning;
  EXPECT_NE(warning.find("(floaters)"), std::string::npos) << warning;
  EXPECT_NE(warning.find("(inside)"), std::string::npos) << warning;
  EXPECT_NE(warning.find("--all-splats"), std::string::npos) << warning;
}

// splats: the mesh of the scene is one closed component near the ellipsoid, and sides are right; with all splats it is twice as far off.
TEST(Splats, TheSceneIsMeshed) {
  const Scene scene = ellipsoid_of_splats(kSanitized ? 1500 : 3000);
  const auto farthest = [&](const ReadOptions& options) {
    const Cloud cloud = read_scene(scene, options);
    const Reconstruction r = reconstruct(cloud.positions);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      const Vec3& n = scene.normals[static_cast<std::size_t>(cloud.confidence[i])];
      const Vec3& found = r.orientation.normals[i];
      wrong += n[0] * found[0] + n[1] * found[1] + n[2] * found[2] < 0 ? 1 : 0;
    }
    double most = 0;
    for (const Vec3& v : r.mesh.vertices) most = std::max(most, std::abs(std::hypot(v[0], v[1] / 0.8, v[2] / 0.6) - 1));
    return std::pair{most + (r.check.components == 1 && r.check.closed ? 0 : 10), wrong};
  };
  const auto [most, wrong] = farthest({});
  EXPECT_LT(most, 2 * scene.spacing);
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(farthest({.all_splats = true}).first, most);
}

}  // namespace
}  // namespace g3r
