#include "orient/open_to_views.h"

#include "base/vector.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace g3r {

void open_to_views(const Views& views, const std::vector<Vec3>& points, OpenSurfaces& surfaces, std::vector<Vec3>& normals,
                   std::vector<Vec3>& eta) {
  const std::size_t n = points.size();
  surfaces.part.resize(n, OpenSurfaces::kNone);
  surfaces.certainty.resize(n, 1);
  surfaces.certified.resize(n, 1);
  surfaces.agrees.resize(n, 0);
  std::uint32_t part = OpenSurfaces::kNone;  // as all parts, by its first point
  for (std::uint32_t i = 0; i < n; ++i) {
    if (surfaces.part[i] != OpenSurfaces::kNone) continue;
    if (part == OpenSurfaces::kNone) part = i;
    const double cosine = vector::dot(normals[i], vector::normalised(vector::subtract(views.place_of(i), points[i])));
    if (cosine < 0) {
      normals[i] = vector::scale(normals[i], -1);
      eta[i] = vector::scale(eta[i], -1);
    }
    surfaces.part[i] = part;
    surfaces.certainty[i] = 1;
    surfaces.certified[i] = static_cast<float>((1 + std::abs(cosine)) / 2);
    surfaces.agrees[i] = 1;
  }
}

}  // namespace g3r
