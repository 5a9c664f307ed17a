// What the XML of an E57 file says of its scans. For sources of E57 alone, as it shows libE57Format.
#pragma once

#include "io/file_bytes.h"
#include "io/table.h"

#include <g3r/points.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <E57Format.h>

namespace g3r::io {

/// One number of a scan's records.
struct E57Field {
  std::string name;                   ///< in the file
  Type type;                          ///< that holds all its values
  unsigned bits;                      ///< in the file
  double most = 0;                    ///< of integers
  std::size_t to = Element::npos;     ///< property of the table
  std::size_t block = Element::npos;  ///< its numbers, where they are unpacked
};

/// From a scan's coordinates to those of the file: rotate by a unit quaternion, then shift.
struct E57Pose {
  std::array<double, 4> q{1, 0, 0, 0};
  Vec3 shift{0, 0, 0};

  [[nodiscard]] bool is_identity() const { return q == E57Pose().q && shift == E57Pose().shift; }

  /// v + 2 w (u x v) + 2 u x (u x v), q = (w, u)
  [[nodiscard]] Vec3 rotate(const Vec3& v) const {
    if (q[1] == 0 && q[2] == 0 && q[3] == 0) return v;
    const auto cross = [&](const Vec3& a) { return Vec3{q[2] * a[2] - q[3] * a[1], q[3] * a[0] - q[1] * a[2], q[1] * a[1] - q[2] * a[0]}; };
    const Vec3 once = cross(v);
    const Vec3 twice = cross(once);
    return {v[0] + 2 * (q[0] * once[0] + twice[0]), v[1] + 2 * (q[0] * once[1] + twice[1]), v[2] + 2 * (q[0] * once[2] + twice[2])};
  }
};

struct E57Scan {
  std::size_t number;  ///< in the file, from 1
  e57::CompressedVectorNode points;
  std::uint64_t count;
  std::vector<E57Field> fields{};
  E57Pose pose{};
  bool spherical = false;
  std::array<std::size_t, 3> position{Element::npos, Element::npos, Element::npos};  ///< fields
  std::array<std::size_t, 3> normal{Element::npos, Element::npos, Element::npos};
  std::array<std::size_t, 3> color{Element::npos, Element::npos, Element::npos};
  std::size_t invalid = Element::npos;
  double brightest = 255;  ///< largest value of the colours
};

/// Where a reader is, for errors.
struct E57Place {
  const Source& source;
  std::size_t scan = 0;  ///< number of the one that is worked on, 0 for none

  [[nodiscard]] std::string text() const { return scan == 0 ? "" : "scan " + std::to_string(scan) + ": "; }
  [[noreturn]] void fail(const std::string& what) const { io::fail(source, text() + what); }
};

/// The scans that have points. Counts are checked against the bytes that the fields have. Throws InvalidInput, and the library's
/// exceptions.
std::vector<E57Scan> find_e57_scans(FileBytes& bytes, const e57::StructureNode& root, E57Place& place);

}  // namespace g3r::io
