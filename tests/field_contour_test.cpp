// Manifold dual contouring: closed and 2-manifold for every octree and every sign pattern.
#include "mesh/field_contour.h"

#include <g3r/error.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <random>

#include "mesh_topology.h"
#include "sanitized.h"

namespace {

using g3r::kSanitized;
using g3r::Mesh;
using g3r::Vec3;
using g3r::mesh::Octree;
using g3r::mesh::RefineDisc;
using g3r::testing::Topology;
using g3r::testing::topology;

using Function = std::function<double(const Vec3&)>;

// The mesh of {f > 0} with vertices at the mean of the linearly interpolated crossings.
Mesh extract(const Octree& octree, const Function& f) {
  std::vector<double> value(octree.corner_count());
  std::vector<std::uint8_t> inside(octree.corner_count());
  for (std::size_t c = 0; c < value.size(); ++c) {
    value[c] = f(octree.corner_position(c));
    inside[c] = value[c] > 0 && !octree.on_boundary(c) ? 1 : 0;
  }
  const auto test = [&](const std::vector<Vec3>& centres) {
    std::vector<std::uint8_t> in;
    for (const Vec3& c : centres) in.push_back(f(c) > 0 ? 1 : 0);
    return in;
  };
  const auto surface = g3r::mesh::contour(octree, inside, test);
  std::vector<Vec3> positions;
  for (std::size_t s = 0; s < surface.patch_count(); ++s) {
    Vec3 mean{0, 0, 0};
    const auto count = static_cast<double>(surface.patch_begin[s + 1] - surface.patch_begin[s]);
    for (std::size_t k = surface.patch_begin[s]; k < surface.patch_begin[s + 1]; ++k) {
      const auto crossing = surface.crossings[surface.patch_crossings[k]];
      const Vec3 a = octree.corner_position(crossing.inside), b = octree.corner_position(crossing.outside);
      const double va = value[crossing.inside], vb = std::min(value[crossing.outside], 0.0);
      const double t = va / (va - vb);
      for (std::size_t i = 0; i < 3; ++i) mean[i] += (a[i] + t * (b[i] - a[i])) / count;
    }
    positions.push_back(mean);
  }
  for (const auto& middle : surface.midpoints) {
    Vec3 mean{};
    for (std::size_t i = 0; i < 3; ++i) mean[i] = 0.5 * (positions[middle.patches[0]][i] + positions[middle.patches[1]][i]);
    positions.push_back(mean);
  }
  return g3r::mesh::triangulate(surface, positions, {});
}

Octree uniform(int level) { return Octree({-1, -1, -1}, 2, {}, level); }

// Leaves of very different sizes side by side, nothing balanced.
Octree random_octree(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> position(-1, 1);
  std::uniform_int_distribution<int> level(2, 6), count(1, 6);
  std::vector<RefineDisc> requests;
  for (int i = count(rng); i > 0; --i)
    requests.push_back({{position(rng), position(rng), position(rng)}, {}, 0.05 + 0.1 * (position(rng) + 1), 0, level(rng)});
  return Octree({-1, -1, -1}, 2, requests, 2);
}

Function random_waves(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<std::array<double, 5>> waves(6);
  for (auto& w : waves) w = {uniform(rng), 14 * uniform(rng), 14 * uniform(rng), 14 * uniform(rng), 3 * uniform(rng)};
  const double offset = 0.5 * uniform(rng);
  return [waves, offset](const Vec3& p) {
    double sum = offset;
    for (const auto& w : waves) sum += w[0] * std::sin(w[1] * p[0] + w[2] * p[1] + w[3] * p[2] + w[4]);
    return sum;
  };
}

void expect_closed_manifold(const Mesh& mesh, const std::string& what) {
  const Topology t = topology(mesh);
  EXPECT_EQ(t.bad_edges, 0U) << what;
  EXPECT_EQ(t.bad_vertices, 0U) << what;
}

TEST(Octree, StopsWithinALevel) {
  constexpr int kDeep = 5;
  std::atomic<bool> cancel{false};
  const auto split = [&](const g3r::mesh::OctreeNode& node) {
    cancel = node.level == kDeep;
    return node.level < kDeep ? g3r::mesh::Split::kYes : g3r::mesh::Split::kNo;
  };
  EXPECT_THROW(Octree({-1, -1, -1}, 2, {}, split, &cancel), g3r::Cancelled);
}

constexpr int kFields = kSanitized ? 300 : 2000;
constexpr int kPatterns = kSanitized ? 150 : 1000;
constexpr std::size_t kLeastTriangles = 50;  // of a field, on average: the fields are not empty

TEST(FieldContour, RandomFieldsOnUnbalancedOctreesGiveClosedManifolds) {
  std::mt19937_64 rng(1);
  std::size_t triangles = 0;
  for (int i = 0; i < kFields; ++i) {
    const Mesh mesh = extract(random_octree(rng), random_waves(rng));
    expect_closed_manifold(mesh, "field " + std::to_string(i));
    triangles += mesh.triangles.size();
  }
  EXPECT_GT(triangles, kLeastTriangles * kFields);
}

TEST(FieldContour, RandomSignsGiveClosedManifolds) {
  std::mt19937_64 rng(2);
  for (int i = 0; i < kPatterns; ++i) {
    const Octree octree = random_octree(rng);
    const std::uint64_t salt = rng();
    const Function noise = [salt](const Vec3& p) {
      std::uint64_t h = salt;
      for (const double c : p) h = (h ^ static_cast<std::uint64_t>(std::llround((c + 2) * 1e6))) * 0x9e3779b97f4a7c15U, h ^= h >> 31U;
      return (h & 3U) == 0 ? 1.0 : -1.0;
    };
    expect_closed_manifold(extract(octree, noise), "pattern " + std::to_string(i));
  }
}

TEST(FieldContour, SphereIsOneOutwardComponentOfGenusZero) {
  const Mesh mesh = extract(uniform(5), [](const Vec3& p) { return 0.7 - std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); });
  const Topology t = topology(mesh);
  EXPECT_EQ(t.components, 1U);
  EXPECT_EQ(t.genus, 0);
  EXPECT_NEAR(t.volume, 4.0 / 3.0 * M_PI * 0.343, 0.02);
}

TEST(FieldContour, TorusHasGenusOne) {
  const Mesh mesh = extract(uniform(5), [](const Vec3& p) { return 0.2 - std::hypot(std::hypot(p[0], p[1]) - 0.6, p[2]); });
  EXPECT_EQ(topology(mesh).genus, 1);
  EXPECT_EQ(topology(mesh).components, 1U);
}

TEST(FieldContour, NestedShellsAlternate) {
  const Mesh mesh =
      extract(uniform(5), [](const Vec3& p) { return 0.2 - std::abs(std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 0.6); });
  const Topology t = topology(mesh);
  EXPECT_EQ(t.components, 2U);
  EXPECT_NEAR(t.volume, 4.0 / 3.0 * M_PI * (0.512 - 0.064), 0.05);
}

TEST(FieldContour, GyroidBlockIsClosed) {
  const Mesh mesh = extract(uniform(5), [](const Vec3& p) {
    const double k = 9;
    const double g =
        std::sin(k * p[0]) * std::cos(k * p[1]) + std::sin(k * p[1]) * std::cos(k * p[2]) + std::sin(k * p[2]) * std::cos(k * p[0]);
    return std::min({0.4 - std::abs(g), 0.8 - std::abs(p[0]), 0.8 - std::abs(p[1]), 0.8 - std::abs(p[2])});
  });
  expect_closed_manifold(mesh, "gyroid");
  EXPECT_GT(topology(mesh).genus, 5);
}

TEST(FieldContour, NothingInsideGivesNoTriangles) {
  EXPECT_TRUE(extract(uniform(3), [](const Vec3&) { return -1.0; }).triangles.empty());
}

TEST(FieldContour, EverythingInsideIsCutOffAtTheBoundary) {
  const Mesh mesh = extract(uniform(3), [](const Vec3&) { return 1.0; });
  expect_closed_manifold(mesh, "full");
  EXPECT_EQ(topology(mesh).components, 1U);
  EXPECT_GT(topology(mesh).volume, 0);
}

}  // namespace
