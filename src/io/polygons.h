// Polygons cut into fans of triangles, with every index checked.
#pragma once

#include "io/source.h"

#include <cstdint>
#include <string>

namespace g3r::io {

/// Adds the polygons of a file to a mesh, in two passes: count() each polygon and reserve(), then begin() each and give its corners. So the
/// triangles never take more memory than the corners in the file account for.
class Fans {
 public:
  Fans(const Source& source, Mesh& mesh) : source_(source), mesh_(mesh) {}
  void count(std::size_t corners) { triangles_ += corners > 2 ? corners - 2 : 0; }
  void reserve() { mesh_.triangles.reserve(triangles_); }
  /// Starts a polygon; `index` or `line` says where it is, for errors.
  void begin(std::uint64_t index, const char* unit) {
    index_ = index;
    unit_ = unit;
    corners_ = 0;
  }
  /// The next corner, counted from 0. Throws InvalidInput unless it is a vertex of the mesh.
  void corner(double vertex);

 private:
  const Source& source_;
  Mesh& mesh_;
  std::size_t triangles_ = 0;
  std::uint64_t index_ = 0;
  const char* unit_ = "face";
  std::size_t corners_ = 0;
  std::uint32_t first_ = 0;
  std::uint32_t previous_ = 0;
};

}  // namespace g3r::io
