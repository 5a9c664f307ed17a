#include "io/polygons.h"

#include "io/text_numbers.h"

namespace g3r::io {

void Fans::corner(double vertex) {
  constexpr double kMost = 4294967295.0;
  if (!(vertex >= 0 && vertex < static_cast<double>(mesh_.vertices.size()) && vertex <= kMost)) {
    fail(source_, std::string(unit_) + " " + std::to_string(index_) + ": face index out of range: expected 0.." +
                      std::to_string(mesh_.vertices.size()) + " (exclusive, counted from 0), found " + number_text(vertex));
  }
  const auto index = static_cast<std::uint32_t>(vertex);
  if (corners_ == 0) first_ = index;
  if (corners_ >= 2) mesh_.triangles.push_back({first_, previous_, index});
  previous_ = index;
  ++corners_;
}

}  // namespace g3r::io
