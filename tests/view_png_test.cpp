#include "sanitized.h"
#include "view_scenes.h"

#include <g3r/view.h>

#include "view/scene.h"

#include <array>
#include <cstdlib>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <png.h>

namespace g3r {
namespace {

struct Decoded {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
  [[nodiscard]] std::array<int, 3> at(int x, int y) const {
    const auto* p = &rgb[3 * static_cast<std::size_t>(y * width + x)];
    return {p[0], p[1], p[2]};
  }
};

Decoded decode(const std::vector<std::uint8_t>& bytes) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()), 0);
  header.format = PNG_FORMAT_RGB;
  Decoded image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  EXPECT_NE(png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr), 0);
  return image;
}

// Pixels of the square (left, top, size) whose red exceeds their blue clearly, and the other way round.
struct Tint {
  int red = 0;
  int blue = 0;
};
Tint tint(const Decoded& image, int left, int top, int size) {
  Tint count;
  for (int y = top; y < top + size; ++y) {
    for (int x = left; x < left + size; ++x) {
      const auto [r, g, b] = image.at(x, y);
      count.red += r > b + 40 ? 1 : 0;
      count.blue += b > r + 12 ? 1 : 0;
    }
  }
  return count;
}

PictureOptions small(std::vector<Layer> layers = {}) {
  PictureOptions options;
  options.tile = 120;
  options.layers = std::move(layers);
  options.up = Up::kZ;
  return options;
}

TEST(ViewPng, OneLayerIsTwoByTwoTilesSeveralAreRowsOfFour) {
  Scene scene = testing::torus_points(2000);
  const Decoded one = decode(view_png(scene, small()));
  EXPECT_EQ(one.width, 240);
  EXPECT_EQ(one.height, 240);
  const Decoded two = decode(view_png(scene, small({Layer::kPoints, Layer::kNormals, Layer::kConfidence})));
  EXPECT_EQ(two.width, 480);
  EXPECT_EQ(two.height, 360);
}

TEST(ViewPng, FewerViewsAreTheFirstOnesAndOneStandsSideBySide) {
  const Scene scene = testing::torus_points(2000);
  PictureOptions options = small({Layer::kPoints, Layer::kNormals, Layer::kConfidence});
  const Decoded four = decode(view_png(scene, options));
  options.views = 2;
  const Decoded two = decode(view_png(scene, options));
  EXPECT_EQ(two.width, 240);
  EXPECT_EQ(two.height, 360);
  options.views = 1;
  const Decoded one = decode(view_png(scene, options));
  EXPECT_EQ(one.width, 360);
  EXPECT_EQ(one.height, 120);
  for (int x = 0; x < 120; ++x) {
    EXPECT_EQ(two.at(x, 180)[2], four.at(x, 180)[2]);
    EXPECT_EQ(one.at(120 + x, 60)[2], four.at(x, 180)[2]);
  }
}

TEST(ViewPng, OutwardNormalsAreBlueInAllViewsInwardOnesRed) {
  if (kSanitized) GTEST_SKIP() << "the code of the others, for seconds";
  Scene scene = testing::torus_points(4000);
  const auto bytes = view_png(scene, small({Layer::kNormals}));
  const Decoded outward = decode(bytes);
  for (Vec3& n : scene.normals) n = {-n[0], -n[1], -n[2]};
  const Decoded inward = decode(view_png(scene, small({Layer::kNormals})));
  for (int tile = 0; tile < 4; ++tile) {
    const int left = 120 * (tile % 2), top = 120 * (tile / 2);
    EXPECT_GT(tint(outward, left, top, 120).blue, 1500);
    EXPECT_LT(tint(outward, left, top, 120).red, 20);
    EXPECT_GT(tint(inward, left, top, 120).red, 1500);
  }
}

TEST(ViewPng, ClosedMeshShowsNoInsideAndTurnedMeshNothingElse) {
  Scene scene;
  scene.mesh = testing::torus_mesh(96, 48);
  testing::add_cube(scene.mesh, {0, 0, 0}, 0.3);
  PictureOptions options = small({Layer::kMesh});
  const auto bytes = view_png(scene, options);
  EXPECT_LT(tint(decode(bytes), 0, 0, 240).red, 10);
  for (auto& t : scene.mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_GT(tint(decode(view_png(scene, options)), 0, 0, 240).red, 8000);
}

TEST(ViewPng, EveryLayerDrawsSomething) {
  Scene scene = testing::torus_points(3000);
  scene.true_normals = scene.normals;
  scene.mesh = testing::torus_mesh(32, 16);
  const std::vector<Layer> layers = {Layer::kPoints, Layer::kNormals, Layer::kConfidence, Layer::kColors, Layer::kError, Layer::kMesh};
  PictureOptions options = small(layers);
  options.dark = true;
  const auto bytes = view_png(scene, options);
  const Decoded image = decode(bytes);
  for (int row = 0; row < 6; ++row) {
    int bright = 0;
    for (int x = 0; x < 480; ++x) bright += image.at(x, row * 120 + 60)[1] > 60 ? 1 : 0;
    EXPECT_GT(bright, 60) << "layer " << row;
  }
}

TEST(ViewPng, DoesNotDependOnScaleOrPlace) {
  if (kSanitized) GTEST_SKIP() << "the code of the others, for seconds";
  const Scene scene = testing::torus_points(1000);
  const Decoded reference = decode(view_png(scene, small({Layer::kNormals})));
  for (const auto& [scale, shift] : {std::pair{0x1p-90, 0.0}, {0x1p100, 0.0}, {1.0, 0x1p20}}) {
    Scene moved = scene;
    for (Vec3& p : moved.points) p = {p[0] * scale + shift, p[1] * scale + shift, p[2] * scale + shift};
    const Decoded image = decode(view_png(moved, small({Layer::kNormals})));
    long difference = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) difference += std::abs(int{image.rgb[i]} - int{reference.rgb[i]}) > 40 ? 1 : 0;
    EXPECT_LT(difference, 200) << scale << " " << shift;
  }
}

TEST(ViewPng, SameBytesForAnyNumberOfThreads) {
  const Scene scene = testing::torus_points(1000);
  PictureOptions one = small(), three = small();
  one.threads = 1;
  three.threads = 3;
  EXPECT_EQ(view_png(scene, one), view_png(scene, three));
}

TEST(ViewPng, NonFinitePointsAndZeroNormalsAreHarmless) {
  Scene scene = testing::torus_points(500);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  scene.points[3] = {kNan, 0, 0};
  scene.points[4] = {0, std::numeric_limits<double>::infinity(), 0};
  scene.normals[5] = {0, 0, 0};
  scene.normals[6] = {kNan, kNan, kNan};
  scene.confidence[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NO_THROW((void)view_png(scene, small({Layer::kNormals, Layer::kConfidence})));
}

TEST(ViewPng, OnePointIsAPicture) {
  Scene scene;
  scene.points = {{1e6, 2, 3}};
  EXPECT_NO_THROW((void)view_png(scene, small()));
}

TEST(ViewPng, WhatALayerLacksIsSaid) {
  Scene scene = testing::torus_points(10);
  const auto message = [&](Layer layer) {
    try {
      (void)view_png(scene, small({layer}));
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(Layer::kMesh), "view: the layer mesh needs a mesh");
  scene.true_normals.clear();
  EXPECT_EQ(message(Layer::kError), "view: the layer error needs true normals to compare with (--truth)");
  scene.normals.clear();
  scene.confidence.clear();
  scene.colors.clear();
  EXPECT_EQ(message(Layer::kNormals), "view: the layer normals needs a cloud with normals: `g3r orient` adds them");
  EXPECT_EQ(message(Layer::kConfidence), "view: the layer confidence needs a cloud with confidence: `g3r orient` adds it");
  EXPECT_EQ(message(Layer::kColors), "view: the layer colors needs a cloud with colours");
  EXPECT_EQ(message(Layer::kError), "view: the layer error needs a cloud with normals: `g3r orient` adds them");
  EXPECT_EQ(message(Layer::kPoints), "");
}

TEST(ViewPng, BrokenScenesAreRefused) {
  EXPECT_THROW((void)view_png(Scene{}), InvalidInput);
  Scene scene = testing::torus_points(10);
  scene.normals.pop_back();
  EXPECT_THROW((void)view_png(scene), InvalidInput);
  scene = testing::torus_points(10);
  EXPECT_THROW((void)view_png(scene, small({Layer::kMesh})), InvalidInput);
  EXPECT_THROW((void)view_png(scene, small({Layer::kError})), InvalidInput);
  scene.mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW((void)view_png(scene), InvalidInput);
  PictureOptions huge;
  huge.tile = 5000;
  EXPECT_THROW((void)view_png(testing::torus_points(10), huge), InvalidInput);
  PictureOptions none;
  none.views = 0;
  EXPECT_THROW((void)view_png(testing::torus_points(10), none), InvalidInput);
}

TEST(ViewScene, SpacingIsTheRootOfTheAreaPerPoint) {
  const double area = 4 * std::acos(-1.0) * std::acos(-1.0) * 0.4;  // of the torus
  for (const std::size_t count : {300U, 3000U, 100000U}) {
    const Scene scene = testing::torus_points(count);
    const double spacing = view::estimate_spacing(scene.points, view::check_scene(scene));
    EXPECT_NEAR(spacing / std::sqrt(area / static_cast<double>(count)), 1, 0.25) << count;
  }
}

}  // namespace
}  // namespace g3r
