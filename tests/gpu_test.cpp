// Sums on a device against those of the processor: every form over shapes, sizes and tolerances; adjoints to rounding; the same bytes from
// run to run. Skipped (77) where there is no device; a software OpenCL such as PoCL will do.
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "gpu/device.h"
#include "gpu/execution.h"
#include "sanitized.h"
#include "shapes.h"
#include "solve/energy_system.h"
#include "solve/green_system.h"
#include "solve/iterative_solver.h"
#include "sum/device_scope.h"
#include "sum/fast_sum.h"
#include "sum_cases.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <thread>

namespace g3r {
namespace {

using namespace sum_cases;  // NOLINT(google-build-using-namespace)
using shapes::Random;

constexpr std::size_t kPoints = 3000;      // hierarchical, some levels
constexpr double kRoundingFloat = 1e-6;    // of adjoints in float plans, see FastSum
constexpr double kRoundingDouble = 1e-12;  // in double plans

// One device for all tests: kernels are compiled once.
const std::shared_ptr<gpu::Execution>& execution() {
  static const auto opened = std::make_shared<gpu::Execution>(gpu::open_device(gpu::list_devices().at(0)), true);
  return opened;
}

SumPlan on_device(SumPlan plan) {
  plan.execution = execution();
  return plan;
}

// Harmonics up to this degree: kernels of one or four compile in less time than those of nine.
Inputs of_harmonics(int degree, const std::vector<Vec3>& points, Widths widths) {
  Inputs in(points, std::move(widths));
  in.u = evaluate_harmonics(harmonics_of_degrees(0, degree), points);
  in.q = random_values(points.size() * in.u.count, 2);
  return in;
}

// Every sum of one plan on the device and on the processor: the same terms, so they differ by the kernels of near pairs at most.
void expect_equal(const Inputs& in, const SumPlan& plan, double accuracy, const std::string& what) {
  const Sums processor = fast_sums(in, plan);
  const Sums device = fast_sums(in, on_device(plan));
  EXPECT_LE(worst_error(device, processor), 0.5 * accuracy) << what;
  EXPECT_EQ(execution()->failure(), "");
}

TEST(Gpu, SumsEqualThoseOfTheProcessor) {
  for (const Case& c : clouds(kPoints)) {
    if (kSanitized && c.name != "needle") continue;
    const Inputs in(c.points, Widths(0.4 * spacing_of(c.points)));
    for (const double accuracy : {2e-2, 1e-2, 1e-3, 1e-4}) expect_equal(in, sum_plan(accuracy, kPoints), accuracy, c.name);
  }
}

TEST(Gpu, DirectSumsEqualThoseOfTheProcessor) {
  for (const std::size_t n : {1UL, 2UL, 9UL, 100UL, 700UL}) {
    for (const Case& c : clouds(n)) {
      if (c.name != "sphere") continue;
      const Inputs in(c.points, Widths(0.4 * spacing_of(c.points)));
      expect_equal(in, sum_plan(1e-4, n), 1e-4, "n=" + std::to_string(n));
    }
  }
}

TEST(Gpu, SumsInDoubleEqualThoseOfTheProcessor) {
  if (!execution()->device().info().doubles) GTEST_SKIP() << "the device has no doubles";
  if (kSanitized) GTEST_SKIP() << "takes minutes";
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const Inputs in = of_harmonics(0, points, Widths(0.4 * spacing_of(points)));
  expect_equal(in, sum_plan(0, kPoints), 1e-11, "direct");
  const SumPlan plan = sum_plan(1e-6, kPoints);
  FastSum processor(points, in.widths, plan);
  FastSum device(points, in.widths, on_device(plan));
  std::vector<std::vector<Vec3>> s(2);
  std::vector<std::vector<double>> w(2);
  processor.stokes_winding(in.eta, s[0], w[0]);
  device.stokes_winding(in.eta, s[1], w[1]);
  EXPECT_LE(relative_error(s[1], s[0]), kRoundingDouble);
  EXPECT_LE(relative_error(w[1], w[0]), kRoundingDouble);
  EXPECT_LE(relative_error(device.winding_adjoint(in.q1), processor.winding_adjoint(in.q1)), kRoundingDouble);
}

TEST(Gpu, PointsMayHaveTheirOwnWidths) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  Random random(5);
  std::vector<double> widths(points.size());
  for (double& w : widths) w = random.uniform(0.005, 0.03);
  expect_equal(of_harmonics(1, points, Widths(widths)), sum_plan(1e-3, kPoints), 1e-3, "local widths");
}

TEST(Gpu, WideMollifiersToo) {
  const std::vector<Vec3> points = unit_points(shapes::sphere(kPoints).points);
  expect_equal(Inputs(points, Widths(3 * spacing_of(points))), sum_plan(1e-3, kPoints), 1e-3, "wide");
}

TEST(Gpu, NarrowerWidthsShareATree) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const auto winding = [&](const SumPlan& plan) {
    const FastSum wide(points, Widths(0.03), plan);
    return FastSum(wide, Widths(0.01)).winding(eta);
  };
  EXPECT_LE(relative_error(winding(on_device(sum_plan(1e-3, kPoints))), winding(sum_plan(1e-3, kPoints))), 5e-4);
}

TEST(Gpu, QueriesSeeTheSameField) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  Random random(2);
  std::vector<Vec3> queries;
  for (int i = 0; i < 500; ++i) queries.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.5, 0.5)});
  queries.insert(queries.end(), points.begin(), points.begin() + 500);
  std::vector<double> local(points.size());
  for (double& w : local) w = random.uniform(0.005, 0.03);
  for (const Widths& widths : {Widths(0.01), Widths(local)}) {
    const FastSum processor(points, widths, sum_plan(1e-3, kPoints));
    const FastSum device(points, widths, on_device(sum_plan(1e-3, kPoints)));
    EXPECT_LE(relative_error(device.winding_at(eta, queries), processor.winding_at(eta, queries)), 5e-4);
    EXPECT_LE(relative_error(device.winding_gradient_at(eta, queries), processor.winding_gradient_at(eta, queries)), 5e-4);
  }
}

TEST(Gpu, QueriesInPartsSeeTheFieldOfTheirOwnDensity) {
  if (kSanitized) GTEST_SKIP() << "takes minutes";
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const std::vector<std::vector<Vec3>> etas{random_vectors(points.size(), 1), random_vectors(points.size(), 2)};
  Random random(2);
  std::vector<Vec3> queries(140'000);  // FastSum takes 131,072 at a time
  for (Vec3& q : queries) q = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.5, 0.5)};
  const FastSum processor(points, Widths(0.01), sum_plan(1e-2, kPoints));
  const FastSum device(points, Widths(0.01), on_device(sum_plan(1e-2, kPoints)));
  const std::vector<std::vector<double>> expected = processor.windings_at(etas, queries);
  const std::vector<std::vector<double>> there = device.windings_at(etas, queries);
  for (std::size_t h = 0; h < etas.size(); ++h) {
    EXPECT_LE(relative_error(there[h], expected[h]), 5e-3);
    EXPECT_LE(relative_error(device.winding_at(etas[h], queries), expected[h]), 5e-3);
  }
}

double inner(const std::vector<double>& a, const std::vector<double>& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }

// <A x, y> = <x, A^T y> to rounding, relative to |A x| |y|.
void expect_adjoints(const Inputs& in, const SumPlan& plan, double rounding) {
  FastSum sum(in.points, in.widths, on_device(plan));
  const std::vector<double> eta = flat(in.eta);
  if (!plan.double_precision) {
    const std::vector<double> forward = sum.green(in.u, in.eta);
    EXPECT_NEAR(inner(forward, in.q), inner(eta, flat(sum.green_adjoint(in.u, in.q))), rounding * norm(forward) * norm(in.q));
  }
  const std::vector<Vec3> other = random_vectors(in.points.size(), 4);
  std::vector<Vec3> s;
  std::vector<Vec3> s_other;
  std::vector<double> w;
  sum.stokes_winding(other, s_other, w);
  sum.stokes_winding(in.eta, s, w);
  EXPECT_NEAR(inner(flat(s), flat(other)), inner(eta, flat(s_other)), rounding * norm(flat(s)) * norm(flat(other)));
  EXPECT_NEAR(inner(w, in.q1), inner(eta, flat(sum.winding_adjoint(in.q1))), rounding * norm(w) * norm(in.q1));
}

TEST(Gpu, AdjointsAreExactToRounding) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const Inputs in(points, Widths(0.4 * spacing_of(points)));
  expect_adjoints(in, sum_plan(1e-2, kPoints), kRoundingFloat);
  if (execution()->device().info().doubles && !kSanitized) expect_adjoints(in, sum_plan(1e-6, kPoints), kRoundingDouble);
}

TEST(Gpu, SameBytesFromRunToRun) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const Inputs in(points, Widths(0.4 * spacing_of(points)));
  const Sums first = parallel::with_threads(1, [&] { return fast_sums(in, on_device(sum_plan(1e-2, kPoints))); });
  const Sums second = fast_sums(in, on_device(sum_plan(1e-2, kPoints)));
  EXPECT_EQ(first.green, second.green);
  EXPECT_EQ(first.green_adjoint, second.green_adjoint);
  EXPECT_EQ(first.stokes, second.stokes);
  EXPECT_EQ(first.winding, second.winding);
  EXPECT_EQ(first.winding_adjoint, second.winding_adjoint);
  EXPECT_EQ(first.gradient, second.gradient);
}

constexpr double kDamping = 2;
constexpr double kWeight = 1e-3;  // of W: it and S count alike in spacings of these clouds

// sqrt(m) of points that stand for up to nine.
std::vector<double> random_roots(std::size_t n) {
  Random random(6);
  std::vector<double> roots(n);
  for (double& r : roots) r = random.uniform(1, 3);
  return roots;
}

std::vector<Vec3> product_there(SolveVectors& vectors, const std::vector<Vec3>& x) {
  vectors.set(SolveVector::kDirection, x);
  vectors.multiply(SolveVector::kDirection, SolveVector::kProduct);
  return vectors.take(SolveVector::kProduct);
}

// M x of one plan with vectors on the device, with its sums but vectors in memory, and on the processor.
void expect_same_product(const std::vector<Vec3>& points, const SumPlan& plan, const std::vector<double>& roots, double accuracy,
                         double rounding, const std::string& what) {
  FastSum processor(points, Widths(0.4 * spacing_of(points)), plan);
  FastSum device(points, Widths(0.4 * spacing_of(points)), on_device(plan));
  EnergySystem reference(processor, kDamping, kWeight, roots);
  EnergySystem system(device, kDamping, kWeight, roots);
  EXPECT_EQ(reference.vectors_elsewhere(), nullptr);
  const std::unique_ptr<SolveVectors> vectors = system.vectors_elsewhere();
  ASSERT_NE(vectors, nullptr) << what;
  const std::vector<Vec3> x = random_vectors(points.size(), 1);
  const std::vector<Vec3> there = product_there(*vectors, x);
  EXPECT_LE(relative_error(there, product_of(system, x)), rounding) << what;
  EXPECT_LE(relative_error(there, product_of(reference, x)), 0.5 * accuracy) << what;
}

TEST(Gpu, ProductsOfVectorsThatStayThereEqualThoseOfTheProcessor) {
  if (!execution()->device().info().doubles) GTEST_SKIP() << "the device has no doubles";
  for (const Case& c : clouds(kPoints)) {
    if (kSanitized && c.name != "needle") continue;
    for (const double accuracy : {2e-2, 1e-2, 1e-3, 1e-4}) {
      const bool rooted = accuracy == 1e-2 || accuracy == 1e-4;
      expect_same_product(c.points, sum_plan(accuracy, kPoints), rooted ? random_roots(kPoints) : std::vector<double>{}, accuracy,
                          kRoundingFloat, c.name);
    }
  }
  for (const std::size_t n : {1UL, 2UL, 9UL, 700UL}) {
    expect_same_product(unit_points(shapes::sphere(n).points), sum_plan(1e-4, n), {}, 1e-4, kRoundingFloat, "n=" + std::to_string(n));
  }
  if (kSanitized) return;
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  expect_same_product(points, sum_plan(1e-6, kPoints), random_roots(kPoints), kRoundingDouble, kRoundingDouble, "double");
}

TEST(Gpu, ProductsOfGreensIdentityThatStayThereEqualThoseOfTheProcessor) {
  if (!execution()->device().info().doubles) GTEST_SKIP() << "the device has no doubles";
  const auto expect_same = [](const std::vector<Vec3>& points, const std::vector<Harmonic>& harmonics, double accuracy, double rounding) {
    FastSum processor(points, Widths(0.4 * spacing_of(points)), sum_plan(accuracy, points.size()));
    FastSum device(points, Widths(0.4 * spacing_of(points)), on_device(sum_plan(accuracy, points.size())));
    GreenSystem reference(processor, points, harmonics);
    GreenSystem system(device, points, harmonics);
    EXPECT_EQ(reference.vectors_elsewhere(), nullptr);
    const std::unique_ptr<SolveVectors> vectors = system.vectors_elsewhere();
    ASSERT_NE(vectors, nullptr);
    const std::vector<Vec3> x = random_vectors(points.size(), 1);
    const std::vector<Vec3> there = product_there(*vectors, x);
    EXPECT_LE(relative_error(there, product_of(system, x)), rounding) << harmonics.size();
    EXPECT_LE(relative_error(there, product_of(reference, x)), 0.5 * accuracy) << harmonics.size();
    EXPECT_EQ(product_there(*vectors, x), there) << "not the same bytes";
  };
  for (const Case& c : clouds(kPoints)) {
    if (kSanitized && c.name != "needle") continue;
    for (const double accuracy : {1e-2, 1e-4}) expect_same(c.points, harmonics_of_degrees(0, 2), accuracy, kRoundingFloat);
  }
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const std::vector<Harmonic> many = harmonics_of_degrees(0, 3);
  for (const std::size_t count : {5UL, 16UL}) {  // a batch of 9 that is not full, and two
    expect_same(points, {many.begin(), many.begin() + static_cast<std::ptrdiff_t>(count)}, 1e-2, kRoundingFloat);
  }
}

TEST(Gpu, VectorsThatStayThereDotAndCombineToRounding) {
  if (!execution()->device().info().doubles) GTEST_SKIP() << "the device has no doubles";
  using enum SolveVector;
  for (const std::size_t n : {1UL, 2UL, 9UL, 1365UL, 1366UL, 5000UL}) {  // a block of the dot product is 1365 points and a third
    const std::vector<Vec3> points = unit_points(shapes::torus(n, 0.6, 0.25, 3).points);
    FastSum sum(points, Widths(0.01), on_device(sum_plan(1e-2, n)));
    const std::unique_ptr<SolveVectors> vectors = sum.energy_vectors(kDamping, kWeight, {});
    ASSERT_NE(vectors, nullptr);
    const std::vector<Vec3> x = random_vectors(n, 1);
    const std::vector<Vec3> y = random_vectors(n, 2);
    const std::vector<double> a = flat(x);
    const std::vector<double> b = flat(y);
    vectors->set(kSolution, x);
    vectors->set(kResidual, y);
    EXPECT_NEAR(vectors->dot(kSolution, kResidual), std::inner_product(a.begin(), a.end(), b.begin(), 0.0),
                kRoundingDouble * static_cast<double>(n));
    vectors->set(kProduct, std::vector<Vec3>(n, Vec3{std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL}));
    vectors->copy(kResidual, kProduct);
    EXPECT_EQ(vectors->take(kProduct), y) << "what a vector was before a copy counts";
    vectors->combine(kResidual, 0.5, -3, kSolution);
    std::vector<double> expected(3 * n);
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = 0.5 * b[i] - 3 * a[i];
    EXPECT_LE(relative_error(flat(vectors->take(kResidual)), expected), 1e-15) << n;
  }
}

TEST(Gpu, SolvesWithVectorsThatStayThereAreThoseInMemory) {
  if (!execution()->device().info().doubles) GTEST_SKIP() << "the device has no doubles";
  constexpr double kAfterSteps = 1e-5;  // conjugate gradients carry the rounding of a product on
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const std::vector<double> roots = random_roots(kPoints);
  FastSum sum(points, Widths(0.4 * spacing_of(points)), on_device(sum_plan(1e-3, kPoints)));
  EnergySystem system(sum, kDamping, kWeight, roots);
  InMemory in_memory(system);
  for (const std::vector<Vec3>& start : {std::vector<Vec3>{}, random_vectors(kPoints, 1)}) {
    for (const double tolerance : {0.0, 0.2}) {
      const std::vector<Steps> schedule = parse_schedule("2 sd 6 cg");
      int told = 0;
      const IterativeResult expected = solve_iteratively(in_memory, schedule, tolerance, start);
      const IterativeResult there = solve_iteratively(system, schedule, tolerance, start, [&](int, int, double) { ++told; });
      EXPECT_EQ(there.kinds, expected.kinds);
      EXPECT_EQ(there.converged, expected.converged);
      EXPECT_EQ(static_cast<std::size_t>(told), there.residuals.size());
      EXPECT_LE(relative_error(there.residuals, expected.residuals), kAfterSteps);
      EXPECT_LE(relative_error(there.eta, expected.eta), kAfterSteps);
      EXPECT_EQ(solve_iteratively(system, schedule, tolerance, start).eta, there.eta) << "not the same bytes";
    }
  }
}

// A software device as if it were a GPU: groups, tiles and layouts of GPUs, which nothing else runs where there is none.
TEST(Gpu, KernelsInTheShapeForGpusComputeTheSameOnAProcessor) {
  if (kSanitized) GTEST_SKIP() << "takes minutes";
  gpu::DeviceInfo info = gpu::list_devices().at(0);
  if (!info.software) GTEST_SKIP() << "all other tests are of that shape";
  info.software = false;
  info.lanes_float = info.lanes_double = 1;
  const auto as_gpu = std::make_shared<gpu::Execution>(gpu::open_device(info), true);
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  Random random(5);
  std::vector<double> local(kPoints);
  for (double& w : local) w = random.uniform(0.3, 0.4) * spacing_of(points);
  const Inputs of_one_width = of_harmonics(1, points, Widths(0.4 * spacing_of(points)));
  SumPlan rough = sum_plan(1e-2, kPoints);
  const Sums expected_sums = fast_sums(of_one_width, rough);
  rough.execution = as_gpu;
  EXPECT_LE(worst_error(fast_sums(of_one_width, rough), expected_sums), 0.5e-2);
  SumPlan plan = sum_plan(1e-6, kPoints);
  const Inputs in(points, Widths(local));
  FastSum processor(points, in.widths, plan);
  plan.execution = as_gpu;
  FastSum there(points, in.widths, plan);
  std::vector<std::vector<Vec3>> s(2);
  std::vector<std::vector<double>> w(2);
  processor.stokes_winding(in.eta, s[0], w[0]);
  there.stokes_winding(in.eta, s[1], w[1]);
  EXPECT_LE(relative_error(s[1], s[0]), kRoundingDouble);
  EXPECT_LE(relative_error(w[1], w[0]), kRoundingDouble);
  EXPECT_LE(relative_error(there.winding_adjoint(in.q1), processor.winding_adjoint(in.q1)), kRoundingDouble);
  const Neighbours tree(points);
  const std::vector<std::uint32_t> expected = tree.of_all(17);
  const gpu::Placed placed(as_gpu);
  EXPECT_EQ(tree.of_all(17), expected);
  EXPECT_EQ(as_gpu->failure(), "");
}

// The first device as if it had less memory.
std::shared_ptr<gpu::Execution> with_memory(std::size_t bytes) {
  gpu::DeviceInfo info = gpu::list_devices().at(0);
  info.memory = bytes;
  return std::make_shared<gpu::Execution>(gpu::open_device(info), true);
}

// `work` with 100 % of the memory that it takes on the device, and less.
template <class Work>
void expect_same_with_less_memory(const std::vector<double>& shares, const Work& work) {
  gpu::Device& device = execution()->device();
  (void)device.take_most_memory();
  const auto expected = work(execution());
  const auto most = static_cast<double>(device.take_most_memory());
  for (const double share : shares) {
    const std::shared_ptr<gpu::Execution> smaller = with_memory(static_cast<std::size_t>(share * most));
    EXPECT_EQ(work(smaller), expected) << share;
    EXPECT_EQ(smaller->failure(), "");
  }
}

TEST(Gpu, TargetsThatDoNotFitAreSummedInPartsWithTheSameBytes) {
  constexpr std::size_t kMany = 20'000;
  for (const bool local_widths : {false, true}) {
    if (kSanitized && local_widths) continue;
    const std::vector<Vec3> points = unit_points(shapes::torus(kMany, 0.6, 0.25, 3).points);
    Random random(5);
    std::vector<double> widths(local_widths ? kMany : 1);
    for (double& w : widths) w = random.uniform(0.3, 0.4) * spacing_of(points);
    const std::vector<Vec3> eta = random_vectors(kMany, 1);
    expect_same_with_less_memory({1, 0.85, 0.75}, [&](const std::shared_ptr<gpu::Execution>& where) {
      SumPlan plan = sum_plan(1e-2, kMany);
      plan.execution = where;
      FastSum sum(points, local_widths ? Widths(widths) : Widths(widths[0]), plan);
      std::vector<Vec3> s;
      std::vector<double> w;
      sum.stokes_winding(eta, s, w);
      std::vector<double> all = flat(s);
      for (const std::vector<double>& more : {w, flat(sum.winding_adjoint(w))}) all.insert(all.end(), more.begin(), more.end());
      return all;
    });
  }
}

TEST(Gpu, QueriesThatDoNotFitAreSummedInPartsWithTheSameBytes) {
  constexpr std::size_t kMany = 20'000;
  const std::vector<Vec3> points = unit_points(shapes::torus(kMany, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(kMany, 1);
  std::vector<Vec3> queries = unit_points(shapes::torus(kMany, 0.6, 0.25, 4).points);
  expect_same_with_less_memory({1, 0.95}, [&](const std::shared_ptr<gpu::Execution>& where) {
    SumPlan plan = sum_plan(1e-2, kMany);
    plan.execution = where;
    return FastSum(points, Widths(0.01), plan).winding_at(eta, queries);
  });
}

TEST(Gpu, SolvesWithLessMemoryAreInPartsWithTheSameBytes) {
  if (!execution()->device().info().doubles) GTEST_SKIP() << "the device has no doubles";
  constexpr std::size_t kMany = 20'000;
  const std::vector<Vec3> points = unit_points(shapes::torus(kMany, 0.6, 0.25, 3).points);
  expect_same_with_less_memory({1, 0.85}, [&](const std::shared_ptr<gpu::Execution>& where) {
    SumPlan plan = sum_plan(1e-2, kMany);
    plan.execution = where;
    FastSum sum(points, Widths(0.4 * spacing_of(points)), plan);
    EnergySystem system(sum, kDamping, kWeight);
    return solve_iteratively(system, {{2, StepKind::kConjugateGradient}}, 0).eta;
  });
}

TEST(Gpu, FieldsEqualThoseOfTheProcessor) {
  constexpr double kAccuracy = 1e-3;  // of a Field
  const shapes::Surface torus = shapes::torus(kPoints, 0.6, 0.25, 3);
  Orientation orientation;
  orientation.normals = torus.normals;
  orientation.areas.assign(kPoints, 4 * std::acos(-1.0) * std::acos(-1.0) * 0.6 * 0.25 / kPoints);
  Random random(2);
  std::vector<Vec3> queries{{9, 0, 0}, {0, 0, -40}};
  for (int i = 0; i < 500; ++i) queries.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.5, 0.5)});
  const Field processor(torus.points, orientation, 0, "cpu");
  const Field device(torus.points, orientation, 0, "gpu:0");
  EXPECT_LE(relative_error(device.value(queries), processor.value(queries)), kAccuracy);
  EXPECT_LE(relative_error(device.gradient(queries), processor.gradient(queries)), kAccuracy);
  EXPECT_EQ(device.value(queries), device.value(queries)) << "not the same bytes";
  std::vector<double> of_other_thread;
  std::thread other([&] { of_other_thread = device.value(queries); });
  EXPECT_EQ(device.value(queries), Field(torus.points, orientation, 0, "gpu:0").value(queries));
  other.join();
  EXPECT_EQ(of_other_thread, device.value(queries));
  EXPECT_THROW(Field(torus.points, orientation, 0, "gpu:" + std::to_string(gpu::list_devices().size())), Unavailable);
  EXPECT_THROW(Field(torus.points, orientation, 0, "gpu:first"), InvalidInput);
}

TEST(Gpu, NearestPointsAreThoseOfTheProcessor) {
  if (!execution()->device().rounds_alike()) GTEST_SKIP() << "the device has no doubles, or rounds them in its own way";
  Random random(3);
  std::vector<Vec3> ties;  // as far from each other, and in the same place
  for (int i = 0; i < 4000; ++i) ties.push_back({std::floor(random.uniform(0, 12)), std::floor(random.uniform(0, 12)), 0});
  std::vector<Case> cases = clouds(kPoints);
  cases.push_back({"ties", ties});
  for (const std::size_t n : {1UL, 2UL, 16UL, 17UL, 33UL}) cases.push_back({"n=" + std::to_string(n), shapes::sphere(n).points});
  for (const Case& c : cases) {
    const Neighbours tree(c.points);
    const std::vector<std::uint32_t> expected = tree.of_all(17);
    const double before = execution()->seconds();
    const gpu::Placed there(execution());
    EXPECT_EQ(tree.of_all(17), expected) << c.name;
    EXPECT_GT(execution()->seconds(), before) << "not on the device";
    EXPECT_TRUE(tree.of_all(0).empty());
  }
  EXPECT_EQ(execution()->failure(), "");
}

TEST(Gpu, SumsStopWhenCancelled) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const std::atomic<bool> cancel{true};
  FastSum sum(points, Widths(0.01), on_device(sum_plan(1e-2, kPoints)), &cancel);
  EXPECT_THROW(sum.winding(random_vectors(points.size(), 1)), Cancelled);
  if (!execution()->device().info().doubles) return;
  const std::unique_ptr<SolveVectors> vectors = sum.energy_vectors(kDamping, kWeight, {});
  EXPECT_THROW((void)product_there(*vectors, random_vectors(points.size(), 1)), Cancelled);
}

TEST(Gpu, OrientationsAndMeshesEqualThoseOfTheProcessor) {
  if (kSanitized) GTEST_SKIP() << "takes minutes";
  constexpr double kSameError = 0.01;  // of the error of the directions, relative
  for (const shapes::Surface& surface : {shapes::torus(4000, 0.6, 0.25, 3), shapes::ellipsoid(3000, 0.9, 0.5, 0.3)}) {
    Options options;
    options.device = "cpu";
    const Orientation processor = orient(surface.points, options);
    options.device = "gpu:0";
    const Orientation device = orient(surface.points, options);
    EXPECT_EQ(processor.stats.device, "cpu");
    EXPECT_EQ(device.stats.device, gpu::list_devices()[0].name);
    EXPECT_FALSE(device.stats.driver.empty());
    EXPECT_TRUE(processor.stats.device_seconds.empty());
    EXPECT_FALSE(device.stats.device_seconds.empty());
    for (const auto& [stage, seconds] : device.stats.device_seconds) EXPECT_GT(seconds, 0) << stage;
    EXPECT_EQ(shapes::share_correct(device.normals, surface.normals), shapes::share_correct(processor.normals, surface.normals));
    const double error = shapes::angle_error(processor.normals, surface.normals);
    EXPECT_NEAR(shapes::angle_error(device.normals, surface.normals), error, kSameError * error);
  }
  Options options;
  options.device = "gpu:0";
  const Reconstruction made = reconstruct(shapes::sphere(2500).points, options);
  EXPECT_TRUE(made.check.closed && made.check.manifold);
  EXPECT_EQ(made.check.genus, 0);
  EXPECT_TRUE(made.orientation.stats.warnings.empty()) << made.orientation.stats.warnings[0];
}

TEST(Gpu, AutoTakesNoSoftwareAndAMissingNumberIsUnavailable) {
  const std::vector<Vec3> points = shapes::sphere(20000).points;
  const bool software = gpu::list_devices()[0].software;
  if (software) {
    EXPECT_EQ(gpu::Scope("auto", points.size()).current(), nullptr);
    EXPECT_THROW(gpu::Scope("gpu", points.size()), Unavailable);
  }
  EXPECT_THROW(gpu::Scope("gpu:" + std::to_string(gpu::list_devices().size()), points.size()), Unavailable);
  EXPECT_EQ(gpu::Scope::current(), nullptr) << "a failed scope stays";
  const gpu::Scope outer("gpu:0", 100);
  const std::shared_ptr<gpu::Execution> shared = gpu::Scope::current();
  EXPECT_NE(shared, nullptr);
  {
    const gpu::Scope inner("gpu:0", 7);
    EXPECT_EQ(gpu::Scope::current(), shared);
    const gpu::Scope processor("cpu", 7);
    EXPECT_EQ(gpu::Scope::current(), nullptr);
  }
  EXPECT_EQ(gpu::Scope::current(), shared);
}

TEST(Gpu, ADeviceThatFailedIsNotKeptForTheNextCall) {
  constexpr std::size_t kCall = 100;  // points
  const gpu::DeviceInfo info = gpu::list_devices().at(0);
  while (gpu::take_kept_device(info) != nullptr) continue;  // of other tests
  { const gpu::Lease lease("gpu:0", kCall); }
  EXPECT_NE(gpu::take_kept_device(info), nullptr);
  {
    const gpu::Lease lease("gpu:0", kCall);
    EXPECT_THROW(lease.execution()->fail("the device was lost"), Unavailable);
    EXPECT_TRUE(lease.execution()->usable(false)) << "the processor took over from a device that was asked for";
  }
  EXPECT_EQ(gpu::take_kept_device(info), nullptr);
}

TEST(Gpu, WhatDoesNotCompileOrFitIsAnErrorThatSaysSo) {
  gpu::Device& device = execution()->device();
  try {
    (void)device.program("this is no kernel\n");
    ADD_FAILURE() << "compiled";
  } catch (const gpu::DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("compile"), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
  EXPECT_THROW((void)device.allocate(device.info().memory * 64), gpu::DeviceError);
}

}  // namespace
}  // namespace g3r

// PoCL and its compiler leak; what g3r leaks, gpu_failures_test finds.
extern "C" const char* __lsan_default_options() { return "detect_leaks=0"; }  // NOLINT(bugprone-reserved-identifier)

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
#ifdef __SANITIZE_THREAD__
  std::puts("skipped: ThreadSanitizer cannot see into drivers");
  return 77;
#endif
  if (g3r::gpu::list_devices().empty()) {
    std::puts("skipped: no OpenCL or CUDA device here; pocl-opencl-icd is one");
    return 77;
  }
  return RUN_ALL_TESTS();
}
