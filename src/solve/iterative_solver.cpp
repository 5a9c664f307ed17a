#include "solve/iterative_solver.h"

#include "cpu/parallel.h"

#include <g3r/error.h>

#include <array>
#include <cmath>
#include <sstream>
#include <utility>

namespace g3r {
namespace {

// The points in a block of a reduction: a fixed number gives sums one order, whatever the number of threads.
constexpr std::size_t kBlock = 4096;
// The most steps of a schedule: more would run for days, so a larger number is a typing error.
constexpr int kMostSteps = 100000;

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return parallel::sum_blocks(a.size(), kBlock, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i][0] * b[i][0] + a[i][1] * b[i][1] + a[i][2] * b[i][2];
    return sum;
  });
}

// y = y * scale + x * factor
void combine(std::vector<Vec3>& y, double scale, double factor, const std::vector<Vec3>& x) {
  parallel::for_blocks(y.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t a = 0; a < 3; ++a) y[i][a] = scale * y[i][a] + factor * x[i][a];
    }
  });
}

// In memory, and products with the system's own function.
class VectorsInMemory : public SolveVectors {
 public:
  VectorsInMemory(LinearSystem& system, std::vector<Vec3> solution, std::vector<Vec3> residual) : system_(system) {
    at(SolveVector::kSolution) = std::move(solution);
    at(SolveVector::kResidual) = std::move(residual);
  }
  void set(SolveVector to, const std::vector<Vec3>& values) override { at(to) = values; }
  std::vector<Vec3> take(SolveVector from) override { return std::move(at(from)); }
  void copy(SolveVector from, SolveVector to) override { at(to) = at(from); }
  double dot(SolveVector a, SolveVector b) override { return g3r::dot(at(a), at(b)); }
  void combine(SolveVector y, double scale, double factor, SolveVector x) override { g3r::combine(at(y), scale, factor, at(x)); }
  void multiply(SolveVector x, SolveVector product) override { system_.apply(at(x), at(product)); }

 private:
  std::vector<Vec3>& at(SolveVector v) { return vectors_[static_cast<std::size_t>(v)]; }

  LinearSystem& system_;
  std::array<std::vector<Vec3>, kSolveVectors> vectors_;
};

// What a solve is asked for.
struct Task {
  const std::vector<Steps>& schedule;
  double tolerance;
  const std::function<void(int, int, double)>& after_step;
};

// The steps from x, the solution, and b, the residual: `size` is |b|, and `squared` |r|^2.
void follow_schedule(SolveVectors& v, const Task& task, double size, double squared, IterativeResult& result) {
  using enum SolveVector;
  int total = 0;
  for (const Steps& steps : task.schedule) total += steps.count;
  int done = 0;
  for (const Steps& steps : task.schedule) {
    v.copy(kResidual, kDirection);
    for (int i = 0; i < steps.count; ++i) {
      if (squared == 0 || std::sqrt(squared) <= task.tolerance * size) {
        result.converged = true;
        return;
      }
      v.multiply(kDirection, kProduct);
      const double curvature = v.dot(kDirection, kProduct);
      const double step = squared / curvature;  // alpha = r.r / p.Mp
      // M is indefinite below the accuracy of its sums, or out of the range of numbers: no step can be trusted any more.
      if (!(curvature > 0) || !(step > 0) || !std::isfinite(step)) return;
      v.combine(kSolution, 1, step, kDirection);
      v.combine(kResidual, 1, -step, kProduct);
      const double next = v.dot(kResidual, kResidual);
      if (steps.kind == StepKind::kConjugateGradient) {
        v.combine(kDirection, next / squared, 1, kResidual);  // p = r + beta p
      } else {
        v.copy(kResidual, kDirection);
      }
      squared = next;
      result.kinds.push_back(steps.kind);
      result.residuals.push_back(std::sqrt(squared) / size);
      if (task.after_step) task.after_step(++done, total, result.residuals.back());
    }
  }
  result.converged = squared == 0 || std::sqrt(squared) <= task.tolerance * size;
}

// The same from b, and x that is not zero if `started`.
IterativeResult iterate(SolveVectors& v, const Task& task, bool started) {
  using enum SolveVector;
  IterativeResult result;
  double squared = v.dot(kResidual, kResidual);
  const double size = std::sqrt(squared);
  if (started) {
    v.multiply(kSolution, kProduct);
    v.combine(kResidual, 1, -1, kProduct);
    squared = v.dot(kResidual, kResidual);
  }
  follow_schedule(v, task, size, squared, result);
  result.eta = v.take(kSolution);
  return result;
}

}  // namespace

std::vector<Steps> parse_schedule(const std::string& text) {
  std::vector<Steps> schedule;
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  int count = 0;
  std::string kind;
  while (words >> count) {
    if (!(words >> kind) || (kind != "sd" && kind != "cg") || count < 0 || count > kMostSteps) {
      throw InvalidInput("schedule \"" + text + "\": expected counts and kinds, for example \"20 sd 60 cg\"");
    }
    schedule.push_back({count, kind == "sd" ? StepKind::kSteepestDescent : StepKind::kConjugateGradient});
  }
  if (!words.eof() || schedule.empty()) {
    throw InvalidInput("schedule \"" + text + "\": expected counts and kinds, for example \"20 sd 60 cg\"");
  }
  return schedule;
}

IterativeResult solve_iteratively(LinearSystem& system, const std::vector<Steps>& schedule, double tolerance, std::vector<Vec3> start,
                                  const std::function<void(int, int, double)>& after_step) {
  const Task task{schedule, tolerance, after_step};
  const bool started = !start.empty();
  std::vector<Vec3> right = system.right_side();
  if (!started) start.assign(right.size(), Vec3{0, 0, 0});
  if (const std::unique_ptr<SolveVectors> elsewhere = system.vectors_elsewhere()) {
    try {
      elsewhere->set(SolveVector::kSolution, start);
      elsewhere->set(SolveVector::kResidual, right);
      return iterate(*elsewhere, task, started);
    } catch (const VectorsLost&) {  // from the start again
    }
  }
  VectorsInMemory vectors(system, std::move(start), std::move(right));
  return iterate(vectors, task, started);
}

}  // namespace g3r
