// g3r_bench_spectra MESH [POINTS]: eigenvalues of the systems that the methods solve, on samples of a mesh, as JSON for plots.py.
// Every system is turned into a matrix column by column, in double, without fast sums: O(N^3), a minute for 400 points.
#include <g3r/io.h>
#include <g3r/metrics.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "baselines/gauss_system.h"
#include "cloud/canonical_cloud.h"
#include "cloud/spacing.h"
#include "solve/energy_system.h"
#include "solve/green_system.h"

namespace g3r::bench {
namespace {

constexpr std::size_t kPoints = 400;
constexpr double kEpsilon = 0.4;        // spacings, of every system
constexpr double kWindingWeight = 0.1;  // spacings: l of the energy form
constexpr double kLeastDamping = 1e-9;  // of pgr: almost none, so that its null space shows

Eigen::MatrixXd matrix_of(LinearSystem& system, std::size_t points) {
  const auto size = static_cast<Eigen::Index>(3 * points);
  Eigen::MatrixXd matrix(size, size);
  std::vector<Vec3> unit(points, Vec3{0, 0, 0});
  for (std::size_t column = 0; column < 3 * points; ++column) {
    unit[column / 3][column % 3] = 1;
    const std::vector<Vec3> product = product_of(system, unit);
    for (std::size_t row = 0; row < 3 * points; ++row) {
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = product[row / 3][row % 3];
    }
    unit[column / 3][column % 3] = 0;
  }
  return matrix;
}

/// Eigenvalues from the largest down, divided by the largest.
std::vector<double> spectrum(LinearSystem& system, std::size_t points) {
  const Eigen::MatrixXd matrix = matrix_of(system, points);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (matrix + matrix.transpose()), Eigen::EigenvaluesOnly);
  std::vector<double> values(solver.eigenvalues().begin(), solver.eigenvalues().end());
  std::reverse(values.begin(), values.end());
  const double largest = values.front();
  for (double& v : values) v /= largest;
  return values;
}

nlohmann::ordered_json spectra(const std::string& path, std::size_t count) {
  const CanonicalCloud cloud = canonical_cloud(sample_mesh(read_mesh(path), count, 1).points);
  const double h = typical_spacing(local_spacing(cloud.points()));
  SumPlan plan;
  plan.direct = true;
  plan.double_precision = true;
  FastSum sum(cloud.points(), Widths(kEpsilon * h), plan);
  nlohmann::ordered_json out = {
      {"mesh", path.substr(path.find_last_of('/') + 1)}, {"points", cloud.size()}, {"epsilon_spacings", kEpsilon}};
  GaussSystem pgr(cloud.points(), {{1, 1, 1}}, kEpsilon * h, kLeastDamping, plan, nullptr);
  out["spectra"]["pgr: {1}"] = spectrum(pgr, cloud.size());
  for (const char* set : {"x,y,z", "1,x,y,z", "degree:0-2", "degree:0-3"}) {
    GreenSystem green(sum, cloud.points(), parse_harmonics(set));
    out["spectra"][std::string("green: {").append(set).append("}")] = spectrum(green, cloud.size());
  }
  EnergySystem energy(sum, 0, kWindingWeight * h);
  out["spectra"]["energy"] = spectrum(energy, cloud.size());
  return out;
}

}  // namespace
}  // namespace g3r::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: g3r_bench_spectra MESH [POINTS]\n");
    return 2;
  }
  try {
    const std::size_t count = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : g3r::bench::kPoints;
    std::printf("%s\n", g3r::bench::spectra(argv[1], count).dump(1).c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "g3r_bench_spectra: %s\n", error.what());
    return 1;
  }
  return 0;
}
