#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <g3r/g3r.h>

#include <cmath>
#include <limits>

namespace g3r {
namespace {

// The points whose colours are mixed: more would blur, and one would look blocky.
constexpr std::size_t kPoints = 4;

}  // namespace

void carry_attributes(Mesh& mesh, const PointsView& points, const std::vector<std::array<std::uint8_t, 3>>& colors,
                      const std::vector<float>& confidence) {
  if ((!colors.empty() && colors.size() != points.count) || (!confidence.empty() && confidence.size() != points.count)) {
    throw InvalidInput("colours or confidences differ in number from the points");
  }
  std::vector<Vec3> finite;
  std::vector<std::size_t> source;
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 p = points[i];
    if (!vector::is_finite(p)) continue;
    finite.push_back(p);
    source.push_back(i);
  }
  if (finite.empty() || (colors.empty() && confidence.empty())) return;
  const Neighbours neighbours(finite);
  mesh.colors.resize(colors.empty() ? 0 : mesh.vertices.size());
  mesh.confidence.resize(confidence.empty() ? 0 : mesh.vertices.size());
  parallel::for_blocks(mesh.vertices.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t v = begin; v < end; ++v) {
      neighbours.nearest(mesh.vertices[v], kPoints, index, squared);
      // A vertex on a point takes that point's colour, and nothing is divided by 0.
      const double floor = mesh::kRounding * squared.back() + std::numeric_limits<double>::min();
      double total = 0, sure = 0;
      std::array<double, 3> color{};
      for (std::size_t k = 0; k < index.size(); ++k) {
        const double weight = 1 / (squared[k] / floor + 1);
        const std::size_t i = source[index[k]];
        total += weight;
        if (!confidence.empty()) sure += weight * static_cast<double>(confidence[i]);
        for (std::size_t a = 0; a < 3 && !colors.empty(); ++a) color[a] += weight * colors[i][a];
      }
      if (!confidence.empty()) mesh.confidence[v] = static_cast<float>(sure / total);
      for (std::size_t a = 0; a < 3 && !colors.empty(); ++a) mesh.colors[v][a] = static_cast<std::uint8_t>(std::lround(color[a] / total));
    }
  });
}

}  // namespace g3r
