#include "orient/unsure.h"

#include "cloud/neighbours.h"
#include "cpu/parallel.h"

namespace g3r {
namespace {

// Spacings from an unsure point within which the others are solved for with it: with 3 a tenth more of the error is left, with 8 half as
// many points more are solved for.
constexpr double kAround = 5;

}  // namespace

std::vector<std::uint32_t> around_unsure(const std::vector<Vec3>& points, const std::vector<double>& spacing,
                                         const std::vector<std::uint8_t>& unsure) {
  std::vector<Vec3> seeds;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (unsure[i] != 0) seeds.push_back(points[i]);
  }
  if (seeds.empty()) return {};
  const Neighbours tree(seeds);
  std::vector<std::uint8_t> is_near(points.size(), 0);
  parallel::for_blocks(points.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      is_near[i] = tree.any_within(points[i], kAround * spacing[spacing.size() == 1 ? 0 : i]) ? 1 : 0;
    }
  });
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (is_near[i] != 0) some.push_back(i);
  }
  return some;
}

}  // namespace g3r
