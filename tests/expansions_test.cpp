// Expansion identities one by one, and the completeness of the interaction lists.
#include "expansions/expansions.h"
#include "cloud/morton.h"
#include "expansions/m2l_matrices.h"

#include "cloud/canonical_cloud.h"
#include "shapes.h"
#include "tree/interaction_lists.h"

#include <gtest/gtest.h>

namespace g3r {
namespace {

using Coefficients = std::vector<double>;

Coefficients multiply(const Coefficients& matrix, const Coefficients& v, bool transposed = false) {
  Coefficients out(v.size(), 0.0);
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t j = 0; j < v.size(); ++j) out[i] += (transposed ? matrix[j * v.size() + i] : matrix[i * v.size() + j]) * v[j];
  }
  return out;
}

double dot(const Coefficients& a, const Coefficients& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

Vec3 scaled(const Vec3& v, double s, const Vec3& shift) { return {v[0] * s + shift[0], v[1] * s + shift[1], v[2] * s + shift[2]}; }

TEST(Expansions, MovingAMultipoleEqualsExpandingAboutTheParent) {
  shapes::Random random(1);
  for (const Vec3& shift : {Vec3{0.5, 0.5, 0.5}, Vec3{-0.5, 0.5, -0.5}}) {
    const Vec3 b{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const Coefficients moved = multiply(multipole_translation(shift, 8), regular_harmonics(b, 8));
    const Coefficients direct = regular_harmonics(scaled(b, 0.5, shift), 8);
    for (std::size_t i = 0; i < moved.size(); ++i) EXPECT_NEAR(moved[i], direct[i], 1e-14);
  }
}

// 1/|x - y| through P2M, M2L and L2P, for equal and unequal cubes; and with L2L in between.
TEST(Expansions, ConvergeToTheKernelWithTheOrder) {
  const Vec3 a{0.3, -0.5, 0.6};   // target in half sides of its cube
  const Vec3 b{-0.4, 0.7, -0.2};  // source
  for (const Offset& offset : {Offset{0, {4, 2, -2}}, Offset{1, {5, 1, -3}}, Offset{-2, {-11, 7, 13}}}) {
    const double smaller = 1;
    const double target = std::ldexp(smaller, std::max(offset.level_difference, 0));
    const double source = std::ldexp(smaller, std::max(-offset.level_difference, 0));
    double r2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = offset.displacement[k] + a[k] * target - b[k] * source;
      r2 += d * d;
    }
    double last = 1;
    for (const int order : {2, 4, 8, 12}) {
      const Coefficients local = multiply(MultipoleToLocal(order).matrix(offset), regular_harmonics(b, order));
      const double value = dot(local, regular_harmonics(a, order)) / target;
      const double error = std::abs(value * std::sqrt(r2) - 1);
      EXPECT_LT(error, 0.7 * last) << order;
      last = error;
      const Vec3 child_shift{0.5, -0.5, 0.5};
      const Vec3 in_child{(a[0] - 0.5) * 2, (a[1] + 0.5) * 2, (a[2] - 0.5) * 2};
      const Coefficients child = multiply(multipole_translation(child_shift, order), local, true);
      EXPECT_NEAR(dot(child, regular_harmonics(in_child, order)) / target, value, 1e-13);
    }
    EXPECT_LT(last, 1e-5);
  }
}

TEST(Expansions, OppositeOffsetsAreTransposes) {
  const MultipoleToLocal make(6);
  const std::size_t n = coefficient_count(6);
  const Coefficients there = make.matrix({1, {5, -7, 9}});
  const Coefficients back = make.matrix({-1, {-5, 7, -9}});
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {  // stored locals carry the target's half side: 2 there, 1 back
      EXPECT_NEAR(there[i * n + j], 2 * back[j * n + i], 1e-12 * std::abs(there[i * n + j]) + 1e-30);
    }
  }
}

// K(s d) = D_s K(d) D_s
TEST(Expansions, MirrorImagesDifferBySigns) {
  const int order = 5;
  const std::size_t n = coefficient_count(order);
  const MultipoleToLocal make(order);
  for (const Offset& offset : {Offset{0, {3, 4, 2}}, Offset{-1, {5, 0, 9}}}) {
    const Coefficients plain = make.matrix(offset);
    const M2lMatrices<double> matrices({offset}, {order, 0.6, 0});
    for (int mirror = 1; mirror < 8; ++mirror) {
      Offset image = offset;
      for (std::size_t a = 0; a < 3; ++a) {
        if (mirror >> a & 1) image.displacement[a] *= -1;
      }
      const Coefficients mirrored = make.matrix(image);
      const double* signs = matrices.signs(image);
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) EXPECT_NEAR(mirrored[i * n + j], signs[i] * plain[i * n + j] * signs[j], 1e-13);
      }
    }
  }
}

std::vector<int> degree_of_coefficients(int order) {
  std::vector<int> out;
  for (int l = 0; l <= order; ++l) out.insert(out.end(), static_cast<std::size_t>(2 * l + 1), l);
  return out;
}

// What is stored, padded and cut is K where degrees are kept and 0 elsewhere.
TEST(M2lMatrices, AreThoseOfTheKeptDegrees) {
  const M2lTerms terms{7, 0.7, 8};
  const std::size_t n = coefficient_count(terms.order);
  const std::vector<int> degree = degree_of_coefficients(terms.order);
  std::vector<Offset> offsets{{0, {4, 2, -2}}, {0, {-4, 2, 2}}, {0, {4, 14, -2}}, {1, {5, 1, -3}}, {-2, {-11, 7, 13}}};
  std::sort(offsets.begin(), offsets.end());
  const M2lMatrices<double> matrices(offsets, terms);
  AlignedVector<double> made;
  std::size_t kept_terms = 0;
  for (std::size_t o = 0; o < offsets.size(); ++o) {
    if (o > 0) {
      EXPECT_EQ(matrices.index(o) == matrices.index(o - 1), offsets[o].magnitude() == offsets[o - 1].magnitude());
    }
    const Coefficients dense = MultipoleToLocal(terms.order).matrix(offsets[o]);
    const std::vector<int> kept = kept_degrees(offsets[o], terms);
    Coefficients stored(n * n, 0.0);
    const cpu::TranslationMatrix<double> matrix = matrices.matrix(matrices.index(o), made);
    const double* at = matrix.data;
    for (std::size_t g = 0; g < matrix.groups; ++g) {
      for (std::size_t j = matrix.columns[g].first; j < matrix.columns[g].last; ++j, at += cpu::kLanes) {
        for (std::size_t row = g * cpu::kLanes; row < std::min((g + 1) * cpu::kLanes, n); ++row)
          stored[row * n + j] = at[row % cpu::kLanes];
      }
    }
    const double* signs = matrices.signs(offsets[o]);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        const bool counts = degree[j] <= kept[static_cast<std::size_t>(degree[i])];
        kept_terms += counts ? 1 : 0;
        EXPECT_NEAR(signs[i] * stored[i * n + j] * signs[j], counts ? dense[i * n + j] : 0, 1e-12 * std::abs(dense[i * n + j]) + 1e-30);
      }
    }
  }
  EXPECT_LT(kept_terms, offsets.size() * n * n / 2);  // or the test proves little
}

TEST(M2lMatrices, OppositeOffsetsKeepTransposedTerms) {
  const M2lTerms terms{7, 0.7, 8};
  for (const Offset& offset : {Offset{0, {4, 2, -2}}, Offset{2, {9, -7, 11}}, Offset{-3, {25, 3, 5}}}) {
    Offset back{-offset.level_difference, offset.displacement};
    for (std::int32_t& d : back.displacement) d = -d;
    const std::vector<int> there = kept_degrees(offset, terms);
    const std::vector<int> here = kept_degrees(back, terms);
    for (int j = 0; j <= terms.order; ++j) {
      for (int n = 0; n <= terms.order; ++n) {
        EXPECT_EQ(n <= there[static_cast<std::size_t>(j)], j <= here[static_cast<std::size_t>(n)]) << j << " " << n;
      }
    }
  }
}

TEST(Expansions, RegularAndIrregularHarmonicsExpandTheKernel) {
  const Vec3 y{0.2, -0.1, 0.3};
  const Vec3 x{1.5, 0.8, -1.1};
  const Coefficients r = regular_harmonics(y, 16);
  const Coefficients s = irregular_harmonics(x, 16);
  double sum = 0;
  for (int l = 0; l <= 16; ++l) {
    for (std::size_t i = real_index(l, 0); i < real_index(l + 1, 0); ++i) sum += (i == real_index(l, 0) ? 1 : 2) * r[i] * s[i];
  }
  const double distance = std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
  EXPECT_NEAR(sum * distance, 1, 1e-10);
}

// Unit charges: every target meets every source exactly once, through the near list of its leaf or a far pair above it.
TEST(InteractionLists, EveryPairOccursExactlyOnce) {
  shapes::Random random(5);
  std::vector<Vec3> points = shapes::torus(3000, 0.6, 0.25, 3).points;
  for (int i = 0; i < 500; ++i) points.push_back({0.5 + 1e-4 * random.gaussian(), 1e-4 * random.gaussian(), 0.1});
  points.push_back({5, 5, 5});
  const CanonicalCloud cloud = canonical_cloud(points);
  for (const double opening : {0.0, 0.4, 0.7}) {
    for (const double width : {0.001, 0.05}) {
      const Octree tree = build_octree(cloud.points(), morton_codes(cloud.points()), {width}, 20);
      const InteractionLists lists = build_interaction_lists(tree, tree, opening, 5);
      std::vector<std::size_t> met(tree.nodes.size(), 0);  // sources a node's points meet through its own far pairs
      for (const FarPair& pair : lists.far) met[pair.target] += tree.nodes[pair.source].count();
      for (std::size_t i = 1; i < tree.nodes.size(); ++i) met[i] += met[tree.nodes[i].parent];
      for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
        std::size_t sources = met[tree.leaves[i]];
        for (std::size_t k = lists.near_begin[i]; k < lists.near_begin[i + 1]; ++k)
          sources += tree.nodes[tree.leaves[lists.near[k]]].count();
        ASSERT_EQ(sources, cloud.size()) << "leaf " << i << " opening " << opening;
      }
      std::vector<std::pair<std::uint32_t, std::uint32_t>> forward;
      std::vector<std::pair<std::uint32_t, std::uint32_t>> backward;
      for (const FarPair& pair : lists.far) {
        forward.emplace_back(pair.target, pair.source);
        backward.emplace_back(pair.source, pair.target);
      }
      std::sort(forward.begin(), forward.end());
      std::sort(backward.begin(), backward.end());
      EXPECT_EQ(forward, backward);
    }
  }
}

}  // namespace
}  // namespace g3r
