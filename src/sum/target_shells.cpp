#include "sum/target_shells.h"

#include "cloud/morton.h"
#include "cpu/parallel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r::target_shells {
namespace {

// Of a shell's kernels at least: the derivative takes 1 / width to the fifth power, which is a float.
constexpr double kLeastWidth = 2e-7;

int shell_of(const Vec3& p) {
  const double far = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  if (far <= 1) return std::isnan(p[0] + p[1] + p[2]) ? kNoShell : 0;
  if (!(far < std::ldexp(1.0, kShells - 1))) return kNoShell;
  int shell = 0;
  std::frexp(far, &shell);
  return shell;
}

}  // namespace

std::array<std::vector<std::uint32_t>, kShells + 1> members(const std::vector<Vec3>& targets, double width, bool shrinks) {
  std::array<std::vector<std::uint32_t>, kShells + 1> members;
  for (std::uint32_t i = 0; i < targets.size(); ++i) {
    const int shell = shell_of(targets[i]);
    const bool has_sum = shell == 0 || (shrinks && std::ldexp(width, -shell) >= kLeastWidth);
    members[static_cast<std::size_t>(has_sum ? shell : kNoShell)].push_back(i);
  }
  return members;
}

std::vector<Vec3> scaled(std::vector<Vec3> points, double factor) {
  for (Vec3& p : points) {
    for (double& c : p) c *= factor;
  }
  return points;
}

void sort_canonically(const std::vector<Vec3>& targets, double factor, std::vector<std::uint32_t>& index) {
  std::vector<Vec3> some(index.size());
  parallel::for_all(some.size(), [&](std::size_t i) { some[i] = targets[index[i]]; });
  std::vector<std::uint32_t> order = morton_order(scaled(std::move(some), factor));
  for (std::uint32_t& i : order) i = index[i];
  index.swap(order);
}

}  // namespace g3r::target_shells
