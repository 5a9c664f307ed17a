// Throughput of the inner loops on one thread, and their share of the machine's fused multiply-add rate. One JSON object on stdout.
//   g3r_bench_kernels [--seconds S (of every measurement, default 0.5)]
#include "cpu/aligned_vector.h"
#include "cpu/near_field.h"
#include "cpu/translations.h"

#include "peak.h"
#include "shapes.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

namespace {

using namespace g3r;
using cpu::kLanes;
using cpu::NearForm;

constexpr std::size_t kBlocks = 6;    // target blocks of a leaf
constexpr std::size_t kRuns = 8;      // source leaves
constexpr std::size_t kSources = 96;  // per leaf
constexpr std::size_t kOrder7 = 64;   // coefficients of an expansion of order 7
constexpr std::size_t kColumns = 64;  // expansions through one M2L matrix

// Per second of processor time, best of three: what the neighbours of a shared machine take away is not the kernel's.
template <class Work>
double rate(double seconds, const Work& work) {
  double best = 0;
  for (int repeat = 0; repeat < 3; ++repeat) {
    double amount = 0;
    const std::clock_t start = std::clock();
    double spent = 0;
    while (spent < seconds / 3) {
      amount += work();
      spent = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    }
    best = std::max(best, amount / spent);
  }
  return best;
}

// Floating-point operations per pair beyond the mollifier's reach: 17 for distance, 1/rho, 1/rho^2, 1/rho^3 and the test, then the form's.
struct Form {
  const char* name;
  NearForm form;
  int batch;
  std::size_t fields;
  std::size_t channels;
  std::size_t target_data;
  double operations;
};
constexpr Form kForms[] = {{"green_9", NearForm::kGreen, 9, 21, 9, 0, 59},
                           {"green_adjoint_9", NearForm::kGreenAdjoint, 9, 9, 12, 9, 60},
                           {"winding_adjoint", NearForm::kWindingAdjoint, 1, 1, 3, 0, 24},
                           {"stokes_winding", NearForm::kStokesWinding, 1, 3, 4, 0, 42},
                           {"winding_gradient", NearForm::kWindingGradient, 1, 3, 3, 0, 37}};

double pairs_per_second(const Form& form, double seconds) {
  shapes::Random random(1);
  const std::size_t fields = 3 + form.fields;
  const std::size_t stride = kRuns * kSources + kLanes;
  AlignedVector<float> values(fields * stride);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(random.uniform(i < 3 * stride ? 1 : -1, 2));
  std::vector<cpu::SourceRun<float>> runs;
  for (std::size_t r = 0; r < kRuns; ++r) {
    runs.push_back({static_cast<std::uint32_t>(r * kSources), static_cast<std::uint32_t>(kSources), {0, 0, 0}});
  }
  const std::size_t lanes = kBlocks * kLanes;
  AlignedVector<float> x(lanes);
  AlignedVector<float> u(lanes * std::max<std::size_t>(1, form.target_data), 1.0F);
  for (float& v : x) v = static_cast<float>(random.uniform());
  std::vector<double> out(lanes * form.channels);
  cpu::NearTask<float> task{};
  task.form = form.form;
  task.batch = form.batch;
  task.places = values.data();
  task.values = values.data() + 3 * stride;
  task.stride = stride;
  task.runs = runs.data();
  task.run_count = runs.size();
  task.count = lanes;
  task.x = task.y = task.z = x.data();
  task.u = u.data();
  task.uniform_width_squared = 1e-12F;  // no pair is near
  task.reach = 5;
  task.out = out.data();
  AlignedVector<float> workspace(cpu::near_workspace(fields));
  task.workspace = workspace.data();
  return rate(seconds, [&] {
    cpu::near_field(task);
    return static_cast<double>(lanes * kRuns * kSources);
  });
}

double m2l_operations_per_second(double seconds) {
  AlignedVector<float> matrix(kOrder7 * kOrder7, 0.01F);
  AlignedVector<float> in(kOrder7 * kColumns, 1.0F);
  AlignedVector<float> out(kOrder7 * kColumns, 0.0F);
  const AlignedVector<float> signs(kOrder7, 1.0F);
  const std::vector<cpu::ColumnRange> all(kOrder7 / kLanes, {0, kOrder7});
  std::vector<cpu::Translation<float>> moves;
  for (std::size_t c = 0; c < kColumns; ++c) moves.push_back({in.data() + c * kOrder7, out.data() + c * kOrder7, signs.data(), {}});
  return rate(seconds, [&] {
    cpu::translate({matrix.data(), all.data(), all.size(), kOrder7}, moves.data(), kColumns, 1, kOrder7, cpu::Moved::kAll);
    return 2.0 * kOrder7 * kOrder7 * kColumns;
  });
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc == 3 && std::string(argv[1]) == "--seconds" ? std::atof(argv[2]) : 0.5;
  const double peak = rate(seconds, [] { return bench::run_multiply_adds(1000); });
  nlohmann::json result{{"isa", cpu::instruction_set()}, {"peak_gflops", peak / 1e9}};
  for (const Form& form : kForms) {
    const double pairs = pairs_per_second(form, seconds);
    result["near"][form.name] = {{"gigapairs_per_second", pairs / 1e9}, {"share_of_peak", pairs * form.operations / peak}};
  }
  const double m2l = m2l_operations_per_second(seconds);
  result["m2l_order_7"] = {{"gflops", m2l / 1e9}, {"share_of_peak", m2l / peak}};
  std::cout << result.dump(2) << "\n";
}
