// STL out: binary (float32, as the format has it) or text (full precision), which is also taken where float32 would show. Facet normals
// follow from the corners.
#include "base/suits_float.h"
#include "base/vector.h"
#include "io/table.h"
#include "io/text_numbers.h"
#include "io/writers.h"

#include <cmath>

namespace g3r::io {

namespace {

Vec3 facet_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const Vec3 v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  Vec3 n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 0};
  for (double& component : n) component /= length;
  return n;
}

void append_text(const char* before, const Vec3& numbers, std::string& text) {
  text += before;
  for (const double number : numbers) {
    text += ' ';
    append_number(text, number);
  }
  text += '\n';
}

void append_floats(const Vec3& numbers, std::string& bytes) {
  for (const double number : numbers) {
    char stored[4];
    store_double(Type::kFloat32, number, stored);
    bytes.append(stored, sizeof stored);
  }
}

// Far from the origin the steps of float32 are steps of the surface, and triangles collapse.
bool steps_show(const std::vector<Vec3>& vertices) {
  vector::Box box;
  for (const Vec3& v : vertices) box.extend(v);
  return !suits_float(box);
}

}  // namespace

void write_stl_mesh(const Mesh& mesh, bool ascii, OutputFile& file) {
  ascii = ascii || steps_show(mesh.vertices);
  std::string record;
  if (ascii) {
    record = "solid g3r\n";
  } else {
    record.assign(80, '\0');
    record.replace(0, 10, "binary STL");
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    record.append(reinterpret_cast<const char*>(&count), sizeof count);
  }
  file.write(record);
  for (const auto& triangle : mesh.triangles) {
    const Vec3 corners[] = {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]};
    const Vec3 normal = facet_normal(corners[0], corners[1], corners[2]);
    record.clear();
    if (ascii) {
      append_text("facet normal", normal, record);
      record += "outer loop\n";
      for (const Vec3& corner : corners) append_text("vertex", corner, record);
      record += "endloop\nendfacet\n";
    } else {
      append_floats(normal, record);
      for (const Vec3& corner : corners) append_floats(corner, record);
      record.append(2, '\0');
    }
    file.write(record);
  }
  if (ascii) file.write("endsolid g3r\n");
}

}  // namespace g3r::io
