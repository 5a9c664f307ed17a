#include "solve/iterative_solver.h"

#include "cpu/parallel.h"

#include <g3r/error.h>

#include <cmath>
#include <sstream>

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
  int total = 0;
  for (const Steps& steps : schedule) total += steps.count;
  IterativeResult result;
  std::vector<Vec3> residual = system.right_side();
  std::vector<Vec3> product;
  const double size = std::sqrt(dot(residual, residual));
  result.eta = std::move(start);
  if (result.eta.empty()) {
    result.eta.assign(residual.size(), Vec3{0, 0, 0});
  } else {
    system.apply(result.eta, product);
    combine(residual, 1, -1, product);
  }
  double squared = dot(residual, residual);  // |r|^2
  int done = 0;
  for (const Steps& steps : schedule) {
    std::vector<Vec3> direction = residual;
    for (int i = 0; i < steps.count; ++i) {
      if (squared == 0 || std::sqrt(squared) <= tolerance * size) {
        result.converged = true;
        return result;
      }
      system.apply(direction, product);
      const double curvature = dot(direction, product);
      const double step = squared / curvature;  // alpha = r.r / p.Mp
      // M is indefinite below the accuracy of its sums, or out of the range of numbers: no step can be trusted any more.
      if (!(curvature > 0) || !(step > 0) || !std::isfinite(step)) return result;
      combine(result.eta, 1, step, direction);
      combine(residual, 1, -step, product);
      const double next = dot(residual, residual);
      if (steps.kind == StepKind::kConjugateGradient) {
        combine(direction, next / squared, 1, residual);  // p = r + beta p
      } else {
        direction = residual;
      }
      squared = next;
      result.kinds.push_back(steps.kind);
      result.residuals.push_back(std::sqrt(squared) / size);
      if (after_step) after_step(++done, total, result.residuals.back());
    }
  }
  result.converged = squared == 0 || std::sqrt(squared) <= tolerance * size;
  return result;
}

}  // namespace g3r
