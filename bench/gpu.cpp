// The sums, and orientation, on a device beside the processor. One JSON object per line on standard output.
//   g3r_bench_gpu [--device gpu:0] [--points N,N,...] [--accuracy A] [--threads T] [--orient N,N,...]
// pairs: near field alone, of every form; sums: whole sums, points per second; steps: seconds of one step of conjugate gradients, with
// vectors on the device, in memory, and on the processor; memory: bytes on the device in these steps; neighbours: the 17 nearest of every
// point; orient: seconds. Medians of wall clock times of three runs after one that compiles and allocates. kernels: seconds of every kernel
// in one more run, in which each launch waits for its end.
#include "cloud/canonical_cloud.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "solve/energy_system.h"
#include "solve/iterative_solver.h"
#include "sum/device_scope.h"
#include "sum/fast_sum.h"
#include "sum_cases.h"

#include "shapes.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>

namespace {

using namespace g3r;

constexpr std::size_t kPairPoints = 8192;  // all pairs of them: 67 million
constexpr double kEpsilon = 0.4;           // spacings, as in the default solve

struct Arguments {
  std::string device = "gpu:0";
  std::vector<std::size_t> points{50'000, 1'000'000};
  std::vector<std::size_t> orient{50'000};
  double accuracy = 1e-2;
  int threads = 0;
};

std::vector<std::size_t> numbers(const std::string& text) {
  std::vector<std::size_t> out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) out.push_back(static_cast<std::size_t>(std::atof(part.c_str())));
  return out;
}

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string flag = argv[i];
    if (flag == "--device") a.device = argv[i + 1];
    if (flag == "--points") a.points = numbers(argv[i + 1]);
    if (flag == "--orient") a.orient = numbers(argv[i + 1]);
    if (flag == "--accuracy") a.accuracy = std::atof(argv[i + 1]);
    if (flag == "--threads") a.threads = std::atoi(argv[i + 1]);
  }
  return a;
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median_seconds(const std::function<void()>& work) {
  work();
  std::array<double, 3> runs{};
  for (double& run : runs) run = seconds_of(work);
  std::sort(runs.begin(), runs.end());
  return runs[1];
}

// A sum of every form.
struct FormRun {
  const char* form;
  std::function<void()> work;
};
std::vector<FormRun> runs_of(FastSum& sum, const sum_cases::Inputs& in) {
  const auto keep = std::make_shared<std::pair<std::vector<Vec3>, std::vector<double>>>();
  return {{"stokes_winding", [&, keep] { sum.stokes_winding(in.eta, keep->first, keep->second); }},
          {"winding", [&, keep] { keep->second = sum.winding(in.eta); }},
          {"winding_adjoint", [&, keep] { keep->first = sum.winding_adjoint(in.q1); }},
          {"winding_gradient", [&, keep] { keep->first = sum.winding_gradient(in.eta); }},
          {"green_9", [&, keep] { keep->second = sum.green(in.u, in.eta); }},
          {"green_adjoint_9", [&, keep] { keep->first = sum.green_adjoint(in.u, in.q); }}};
}

// A line for every form: `count` things per second on the device and on the processor.
void compare_forms(const char* what, const sum_cases::Inputs& in, SumPlan plan, const std::shared_ptr<gpu::Execution>& execution,
                   double count) {
  FastSum on_processor(in.points, in.widths, plan);
  plan.execution = execution;
  FastSum on_device(in.points, in.widths, plan);
  const std::vector<FormRun> processor = runs_of(on_processor, in);
  const std::vector<FormRun> device = runs_of(on_device, in);
  for (std::size_t i = 0; i < device.size(); ++i) {
    const double cpu_seconds = median_seconds(processor[i].work);
    const double device_seconds = median_seconds(device[i].work);
    execution->device().time_kernels();
    device[i].work();
    std::cout << nlohmann::ordered_json{{"measured", what},
                                        {"form", device[i].form},
                                        {"points", in.points.size()},
                                        {"device_seconds", device_seconds},
                                        {"cpu_seconds", cpu_seconds},
                                        {"device_per_second", count / device_seconds},
                                        {"cpu_per_second", count / cpu_seconds},
                                        {"kernels", execution->device().take_kernel_seconds()}}
              << std::endl;
  }
}

sum_cases::Inputs inputs(std::size_t n, std::vector<Vec3>& points) {
  points = canonical_cloud(shapes::torus(n, 0.6, 0.25, 5).points).points();
  const double h = std::sqrt(4 * std::acos(-1.0) * std::acos(-1.0) * 0.6 * 0.25 / (0.85 * 0.85 * 1.1 * 1.1) / static_cast<double>(n));
  return {points, Widths(kEpsilon * h)};
}

double seconds_of_step(LinearSystem& system) {
  constexpr int kSteps = 10;
  return median_seconds([&] { (void)solve_iteratively(system, {{kSteps, StepKind::kConjugateGradient}}, 0); }) / kSteps;
}

// Copies of vectors and the right side are part of the ten steps.
void compare_steps(const sum_cases::Inputs& in, SumPlan plan, const std::shared_ptr<gpu::Execution>& execution) {
  const double weight = std::pow(in.widths[0], 3);
  FastSum on_processor(in.points, in.widths, plan);
  plan.execution = execution;
  FastSum on_device(in.points, in.widths, plan);
  EnergySystem processor(on_processor, 0, weight);
  EnergySystem device(on_device, 0, weight);
  sum_cases::InMemory in_memory(device);
  std::cout << nlohmann::ordered_json{{"measured", "steps"},
                                      {"points", in.points.size()},
                                      {"device_seconds", seconds_of_step(device)},
                                      {"vectors_in_memory_seconds", seconds_of_step(in_memory)},
                                      {"cpu_seconds", seconds_of_step(processor)}}
            << std::endl;
}

// The nearest points of every point, those of PointSet::near().
void compare_neighbours(const std::vector<Vec3>& points, const std::shared_ptr<gpu::Execution>& execution) {
  constexpr std::size_t kNearest = 17;
  const Neighbours tree(points);
  const auto find = [&] { (void)tree.of_all(kNearest); };
  const double cpu_seconds = median_seconds(find);
  const gpu::Placed there(execution);
  const double device_seconds = median_seconds(find);
  execution->device().time_kernels();
  find();
  std::cout << nlohmann::ordered_json{{"measured", "neighbours"},
                                      {"points", points.size()},
                                      {"device_seconds", device_seconds},
                                      {"cpu_seconds", cpu_seconds},
                                      {"kernels", execution->device().take_kernel_seconds()}}
            << std::endl;
}

nlohmann::ordered_json stages_of(const Orientation& orientation) {
  nlohmann::ordered_json stages;
  for (const auto& [stage, seconds] : orientation.stats.seconds) stages[stage] = seconds;
  return stages;
}

void measure_orient(std::size_t n, const Arguments& arguments) {
  const std::vector<Vec3> points = shapes::torus(n, 0.6, 0.25, 5).points;
  Options options;
  options.threads = arguments.threads;
  Orientation result;
  const auto run = [&](const std::string& device) {
    options.device = device;
    return seconds_of([&] { result = orient(points, options); });
  };
  nlohmann::ordered_json line{{"measured", "orient"}, {"points", n}};
  line["cpu_seconds"] = run("cpu");
  line["cpu_stages"] = stages_of(result);
  line["first_device_seconds"] = run(arguments.device);  // opens the device, compiles what is not kept
  line["device_seconds"] = run(arguments.device);
  line["device_stages"] = stages_of(result);
  std::cout << line << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Arguments arguments = parse(argc, argv);
    parallel::with_threads(arguments.threads, [&] {
      const gpu::Scope scope(arguments.device, kPairPoints);
      const std::shared_ptr<gpu::Execution> execution = gpu::Scope::current();
      Stats stats;
      scope.describe(stats);
      std::cout << nlohmann::ordered_json{{"device", stats.device},
                                          {"driver", stats.driver},
                                          {"threads", parallel::thread_count(arguments.threads)},
                                          {"accuracy", arguments.accuracy}}
                << std::endl;
      const gpu::Scope processor("cpu", kPairPoints);  // what follows says where it runs
      std::vector<Vec3> points;
      SumPlan direct = sum_plan(arguments.accuracy, 1);
      direct.kernel_error = sum_plan(arguments.accuracy, 1'000'000).kernel_error;
      compare_forms("pairs", inputs(kPairPoints, points), direct, execution, static_cast<double>(kPairPoints * kPairPoints));
      for (const std::size_t n : arguments.points) {
        const sum_cases::Inputs in = inputs(n, points);
        compare_forms("sums", in, sum_plan(arguments.accuracy, n), execution, static_cast<double>(n));
        (void)execution->device().take_most_memory();
        compare_steps(in, sum_plan(arguments.accuracy, n), execution);
        std::cout << nlohmann::ordered_json{{"measured", "memory"}, {"points", n}, {"bytes", execution->device().take_most_memory()}}
                  << std::endl;
        compare_neighbours(points, execution);
      }
    });
    for (const std::size_t n : arguments.orient) measure_orient(n, arguments);
  } catch (const std::exception& error) {
    std::cerr << "g3r_bench_gpu: " << error.what() << '\n';
    return 1;
  }
}
