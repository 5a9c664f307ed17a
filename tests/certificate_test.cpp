// The certificate: what it says of right normals, of wrong ones and of surfaces without an inside.
#include "orient/certificate.h"

#include "base/vector.h"
#include "cloud/morton.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

using shapes::Surface;

struct Tested {
  Certificate certificate;
  std::vector<Vec3> points;
};

double mean(const std::vector<double>& values) {
  double sum = 0;
  double count = 0;
  for (const double v : values) {
    if (v < 0) continue;
    sum += v;
    ++count;
  }
  return sum / count;
}

Tested test(const Surface& s) {
  const std::vector<std::uint32_t> order = morton_order(s.points);
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
  for (const std::uint32_t i : order) {
    points.push_back(s.points[i]);
    normals.push_back(s.normals[i]);
  }
  const Sites sites = place_sites(PointSet(points), 0);
  const SumPlan sums = sum_plan(1e-3, points.size());
  Tested tested{certify(sites, normals, std::vector<double>(points.size(), 10), sums, nullptr), points};
  EXPECT_EQ(tested.certificate.jump_defect, jump_defects(sites, {normals}, sums, nullptr).all.front());
  return tested;
}

// A grid of 40 x 40 in so many layers, 4.3 steps apart.
Surface layers(int count) {
  Surface s;
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 40; ++j) {
        s.points.push_back({(i - 19.5) / 40, (j - 19.5) / 40, k * 4.3 / 40});
        s.normals.push_back({0, 0, 1});
      }
    }
  }
  return s;
}

// What is four spacings beside one layer is beside the next, whose jump is none of the first's.
TEST(Certificate, OwnDefectsLeaveOutWhatIsBehindAnotherSurface) {
  for (const int count : {1, 2}) {
    const Surface s = layers(count);
    const Sites sites = place_sites(PointSet(s.points), 0);
    const JumpDefects defects = jump_defects(sites, {s.normals}, sum_plan(1e-3, s.points.size()), nullptr);
    const double ratio = mean(defects.own.front()) / mean(defects.all.front());
    EXPECT_GT(ratio, count == 1 ? 1 - 1e-9 : 0);
    EXPECT_LT(ratio, count == 1 ? 1 + 1e-9 : 0.9);
  }
}

// Sites lie evenly, so that their areas are too large, by as much for all: what is left after scaling is small, and turned sides are not.
TEST(Certificate, ScalesTheAreasOfEvenSites) {
  shapes::Random random(3);
  Surface s = shapes::sphere(20000, 0.8);
  const double spacing = 0.8 * std::sqrt(4 * 3.14159265 / 20000);
  for (Vec3& p : s.points) {
    for (double& c : p) c += 0.7 * spacing * random.gaussian();
  }
  const std::vector<std::uint32_t> order = morton_order(s.points);
  std::vector<Vec3> points;
  for (const std::uint32_t i : order) points.push_back(s.points[i]);
  const Sites sites = place_sites(PointSet(points), 1.5 * spacing);
  std::vector<Vec3> outward(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) outward[i] = vector::normalised(sites.points()[i]);
  const std::vector<double> reach(sites.size(), 10);
  const Certificate right = certify(sites, outward, reach, sum_plan(1e-3, sites.size()), nullptr);
  EXPECT_LT(mean(right.scaled_defect), 0.12);
  EXPECT_LT(mean(right.scaled_defect), 0.6 * mean(right.jump_defect));
  for (std::size_t i = 0; i < outward.size(); i += 2) outward[i] = vector::scale(outward[i], -1);
  EXPECT_GT(mean(certify(sites, outward, reach, sum_plan(1e-3, sites.size()), nullptr).scaled_defect), 0.5);
}

Surface half(const Surface& whole) {
  Surface part;
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    if (whole.points[i][2] < 0) continue;
    part.points.push_back(whole.points[i]);
    part.normals.push_back(whole.normals[i]);
    part.areas.push_back(whole.areas[i]);
  }
  return part;
}

// Gauss: the field of the boundary of a solid is 1 inside, 0 outside, and jumps by 1.
TEST(Certificate, IsCleanOnClosedSurfaces) {
  for (const Surface& s : {shapes::sphere(8000, 0.8), shapes::torus(12000, 0.6, 0.25, 2),
                           shapes::join(shapes::sphere(8000, 0.8), shapes::sphere(3000, 0.4), true)}) {
    const Certificate c = test(s).certificate;
    EXPECT_LT(mean(c.unrest), 0.03);
    EXPECT_LT(mean(c.jump_defect), 0.1);
    EXPECT_GT(*std::min_element(c.jump.begin(), c.jump.end()), 0.8);
  }
}

// The jump is local: it is 1 on an open surface too. The unrest is not.
TEST(Certificate, TellsOpenFromClosed) {
  const Certificate c = test(half(shapes::sphere(16000, 0.8))).certificate;
  EXPECT_GT(mean(c.unrest), 0.1);
  EXPECT_LT(mean(c.jump_defect), 0.25);
}

TEST(Certificate, InsideOutIsMinusTheField) {
  Surface s = shapes::sphere(6000, 0.8);
  for (Vec3& n : s.normals) n = vector::scale(n, -1);
  const Certificate c = test(s).certificate;
  EXPECT_GT(mean(c.unrest), 0.3);
}

// One cap of a sphere turned: its points do not see the jump missing, the seam and the field around them do.
TEST(Certificate, FindsTurnedRegions) {
  Surface s = shapes::sphere(8000, 0.8);
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (s.points[i][2] > 0.4) s.normals[i] = vector::scale(s.normals[i], -1);
  }
  const Tested t = test(s);
  EXPECT_GT(mean(t.certificate.unrest), 0.1);
  double at_seam = 0;
  double seam = 0;
  for (std::size_t i = 0; i < t.points.size(); ++i) {
    if (std::abs(t.points[i][2] - 0.4) > 0.01) continue;
    at_seam += t.certificate.jump_defect[i];
    ++seam;
  }
  EXPECT_GT(at_seam / seam, 0.4);
}

// Single points with the wrong side, whose neighbours carry the field.
TEST(Certificate, FindsTurnedPoints) {
  Surface s = shapes::sphere(8000, 0.8);
  for (std::size_t i = 0; i < s.points.size(); i += 100) s.normals[i] = vector::scale(s.normals[i], -1);
  const std::vector<std::uint32_t> order = morton_order(s.points);
  const Certificate c = test(s).certificate;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (order[k] % 100 != 0) continue;
    EXPECT_LT(c.jump[k], 0);
  }
}

// Twice the certainty is enough, and so is any where the others have none; sides that are no better, or certain of nothing, are never
// shown.
TEST(ShownBetter, ByHalfOfTheDefectOrWhereTheOthersJumpNowhere) {
  EXPECT_TRUE(is_shown_better(0.3, 0.6));
  EXPECT_FALSE(is_shown_better(0.31, 0.6));
  EXPECT_TRUE(is_shown_better(0.5, 0.99));    // Bayes: 0.01 0.5 / (0.01 0.5 + 0.99 0.5) = 0.01
  EXPECT_FALSE(is_shown_better(0.62, 0.94));  // 0.095: a thin wire, whose sides are right
  EXPECT_TRUE(is_shown_better(0.9, 1.2));
  EXPECT_FALSE(is_shown_better(1, 1.2));
  EXPECT_FALSE(is_shown_better(0, 0));
  for (double defect = 0; defect < 1; defect += 0.01) {
    EXPECT_FALSE(is_shown_better(defect, defect)) << defect;
    bool was_shown = false;  // the worse the others, the sooner
    for (double than = defect; than < 1.5; than += 0.01) {
      const bool is_shown = is_shown_better(defect, than);
      EXPECT_TRUE(is_shown || !was_shown) << defect << ' ' << than;
      was_shown = is_shown;
    }
    EXPECT_TRUE(was_shown) << defect;
  }
}

}  // namespace
}  // namespace g3r
