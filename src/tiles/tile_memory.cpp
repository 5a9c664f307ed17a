#include "tiles/tile_memory.h"

#include "orient/memory_plan.h"
#include "orient/settings.h"
#include "orient/site_parts.h"

#include <algorithm>

namespace g3r::tiles {
namespace {

constexpr std::size_t kFixed = 32u << 20;  // beside that of a solve in core: 131,072 queries of a sum
constexpr std::size_t kBeside = 210;  // bytes of a point beside its solve: part, coarse side, and what facets hold if they are solved for

}  // namespace

std::size_t in_core(std::uint64_t points) {
  Settings clean;
  clean.spacing = 1;
  const auto all = static_cast<std::size_t>(points);
  const std::size_t some = std::min(all, kMostSites);  // of which the certificate takes more each
  return std::max(planned_memory(clean, all, all), planned_memory(clean, some, some));
}

std::size_t memory_for(std::uint64_t points) { return in_core(points) + kFixed + kBeside * static_cast<std::size_t>(points); }

std::uint64_t points_for(std::size_t memory) {
  std::uint64_t enough = 0;
  std::uint64_t more = memory / kBeside + 1;
  while (more - enough > 1) {
    const std::uint64_t middle = enough + (more - enough) / 2;
    (memory_for(middle) <= memory ? enough : more) = middle;
  }
  return enough;
}

}  // namespace g3r::tiles
