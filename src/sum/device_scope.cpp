#include "sum/device_scope.h"

#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace g3r::gpu {
namespace {

// Points per core of the machine from which "auto" takes a GPU: below, starting kernels and moving data take longer than the cores do. With
// 16 cores and an H200 an orientation takes as long on both at 50,000 points.
constexpr std::size_t kFewestPointsPerCore = 3'000;
constexpr std::size_t kTrialPoints = 2'000;  // some levels of a tree
constexpr double kTrialAccuracy = 1e-2;
constexpr std::size_t kTrialNeighbours = 17;  // those of PointSet::near()

thread_local Scope* innermost = nullptr;

enum class Wanted { kAuto, kProcessor, kGpu, kNumber };
struct Request {
  Wanted wanted = Wanted::kAuto;
  std::size_t number = 0;
};

Request parse(const std::string& text) {
  if (text.empty() || text == "auto") return {};
  if (text == "cpu") return {Wanted::kProcessor};
  if (text == "gpu") return {Wanted::kGpu};
  Request request{Wanted::kNumber};
  const char* end = text.data() + text.size();
  if (text.rfind("gpu:", 0) == 0) {
    const auto [last, error] = std::from_chars(text.data() + 4, end, request.number);
    if (error == std::errc() && last == end) return request;
  }
  throw InvalidInput("device must be auto, cpu, gpu or gpu:N with N a number of the list of devices, not '" + text + "'");
}

// The device that is asked for, if there is one.
std::optional<DeviceInfo> choose(const Request& request) {
  const std::vector<DeviceInfo> all = list_devices(request.wanted == Wanted::kAuto ? Software::kNotLoaded : Software::kListed);
  if (request.wanted == Wanted::kNumber) {
    if (request.number < all.size()) return all[request.number];
    throw Unavailable("there is no device gpu:" + std::to_string(request.number) + ": " +
                      (all.empty() ? "no driver of OpenCL or CUDA was found" : "the last one is gpu:" + std::to_string(all.size() - 1)));
  }
  if (!all.empty() && !all[0].software) return all[0];
  if (request.wanted == Wanted::kAuto) return std::nullopt;
  throw Unavailable(all.empty() ? "there is no GPU: no driver of OpenCL or CUDA was found"
                                : "there is no GPU: OpenCL runs on the processor only (--device gpu:0 takes that)");
}

// Points on a sphere, and a density on them: Fibonacci's lattice.
std::vector<Vec3> trial_points() {
  std::vector<Vec3> out(kTrialPoints);
  const double golden = std::acos(-1.0) * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / kTrialPoints;
    const double r = 0.9 * std::sqrt(1 - z * z);
    const double angle = golden * static_cast<double>(i);
    out[i] = {r * std::cos(angle), r * std::sin(angle), 0.9 * z};
  }
  return out;
}

// |a - b| <= kTrialAccuracy |b|
bool agree(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double difference = 0;
  double size = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      difference += (a[i][k] - b[i][k]) * (a[i][k] - b[i][k]);
      size += b[i][k] * b[i][k];
    }
  }
  return difference <= kTrialAccuracy * kTrialAccuracy * size;
}

// A product with the energy's matrix, and every other thing that a solve does with its vectors: x + p = (p + M p) / (p . M p), x = 0.
// `solve` on the device, `sum` on the processor.
void try_solve(SolveVectors& solve, FastSum& sum, const std::vector<Vec3>& p) {
  using enum SolveVector;
  std::vector<Vec3> expected;
  std::vector<double> w;
  sum.stokes_winding(p, expected, w);
  sum.add_winding_adjoint(w, 1, expected);
  double dot = 0;
  for (std::size_t i = 0; i < p.size(); ++i) dot += vector::dot(p[i], expected[i]);
  for (std::size_t i = 0; i < p.size(); ++i) expected[i] = vector::scale(vector::add(p[i], expected[i]), 1 / dot);
  try {
    solve.set(kDirection, p);
    solve.multiply(kDirection, kProduct);
    const double dot_there = solve.dot(kDirection, kProduct);
    solve.copy(kProduct, kSolution);
    solve.combine(kSolution, 1 / dot_there, 1 / dot_there, kDirection);
    if (!agree(solve.take(kSolution), expected)) throw DeviceError("its solves are wrong; a newer driver may help");
  } catch (const VectorsLost& lost) {
    throw DeviceError(lost.what());
  }
}

// Drivers have bugs: every pass of a small sum has to agree with the processor before a device is trusted.
void try_out(const std::shared_ptr<Execution>& execution) {
  const CanonicalCloud cloud = canonical_cloud(trial_points());
  SumPlan plan = sum_plan(kTrialAccuracy, kTrialPoints);
  const Widths widths(1 / std::sqrt(static_cast<double>(kTrialPoints)));
  std::vector<std::vector<Vec3>> s(2);
  std::vector<double> w;
  const Placed processor(nullptr);  // the first of the two
  parallel::with_threads(1, [&] {
    FastSum here(cloud.points(), widths, plan);
    plan.execution = execution;
    FastSum there(cloud.points(), widths, plan);
    here.stokes_winding(cloud.points(), s[0], w);
    there.stokes_winding(cloud.points(), s[1], w);
    if (!agree(s[1], s[0])) throw DeviceError("its sums are wrong; a newer driver may help");
    const std::unique_ptr<SolveVectors> solve = there.energy_vectors(0, 1, {});
    if (solve != nullptr) try_solve(*solve, here, cloud.points());
    const Neighbours tree(cloud.points());
    const std::vector<std::uint32_t> near = tree.of_all(kTrialNeighbours);
    const Placed there_too(execution);
    execution->device().set_rounds_alike(tree.of_all(kTrialNeighbours) == near);
  });
}

}  // namespace

Lease::Lease(const std::string& request, std::size_t points) {
  const Request parsed = parse(request);
  const auto cores = static_cast<std::size_t>(parallel::thread_count(0));
  if (parsed.wanted == Wanted::kProcessor || (parsed.wanted == Wanted::kAuto && points < kFewestPointsPerCore * cores)) return;
  const std::optional<DeviceInfo> info = choose(parsed);
  if (!info) return;
  try {
    std::shared_ptr<Device> device = take_kept_device(*info);
    const bool trusted = device != nullptr;
    if (!trusted) device = open_device(*info);
    execution_ = std::make_shared<Execution>(std::move(device), parsed.wanted != Wanted::kAuto);
    if (!trusted) try_out(execution_);
    if (!execution_->failure().empty()) note_ = execution_->failure();
  } catch (const DeviceError& error) {
    note_ = info->name + ": " + error.what();
    if (parsed.wanted != Wanted::kAuto) throw Unavailable(note_);
    execution_.reset();
  }
}

Lease::~Lease() {
  if (execution_ != nullptr && execution_->sound()) keep_device(execution_->shared_device());
}

Scope::Scope(const std::string& request, std::size_t points)
    : request_(request),
      lease_(innermost != nullptr && innermost->request_ == request ? innermost->lease_ : std::make_shared<const Lease>(request, points)),
      placed_(execution()),
      outer_(innermost) {
  innermost = this;
}

Scope::~Scope() { innermost = outer_; }

void Scope::describe(Stats& stats) const {
  const std::string failure = execution() && lease_->note().empty() ? execution()->failure() : lease_->note();
  const bool used = execution() && failure.empty();
  stats.device = used ? execution()->device().info().name : "cpu";
  stats.driver = used ? execution()->device().info().driver : "";
  if (failure.empty()) return;
  const std::string warning = "computed on the processor, not on the GPU: " + failure;
  if (std::find(stats.warnings.begin(), stats.warnings.end(), warning) == stats.warnings.end()) stats.warnings.push_back(warning);
}

}  // namespace g3r::gpu

namespace g3r {

std::vector<ComputeDevice> compute_devices() {
  std::vector<ComputeDevice> out;
  for (const gpu::DeviceInfo& info : gpu::list_devices()) out.push_back({info.name, info.driver, info.software, info.memory});
  return out;
}

}  // namespace g3r
