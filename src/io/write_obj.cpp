// OBJ out: v (with r g b in 0..1 where there are colours), vn for points, f for meshes.
#include "io/text_numbers.h"
#include "io/writers.h"

namespace g3r::io {

namespace {

void append_triple(const char* keyword, const Vec3& numbers, std::string& line) {
  line += keyword;
  for (const double number : numbers) {
    line += ' ';
    append_number(line, number);
  }
}

void append_vertex(const Vec3& position, const std::vector<std::array<std::uint8_t, 3>>& colors, std::size_t i, std::string& line) {
  append_triple("v", position, line);
  if (!colors.empty()) {
    for (const std::uint8_t channel : colors[i]) {
      line += ' ';
      append_number(line, static_cast<float>(channel) / 255.0F);
    }
  }
  line += '\n';
}

}  // namespace

void write_obj(const PointData& data, OutputFile& file) {
  const std::vector<Vec3>* normals = data.normals != nullptr ? data.normals : data.cloud.normals.empty() ? nullptr : &data.cloud.normals;
  std::string line;
  for (std::size_t i = 0; i < data.size(); ++i) {
    line.clear();
    append_vertex(data.cloud.positions[i], data.cloud.colors, i, line);
    if (normals != nullptr) {
      append_triple("vn", (*normals)[i], line);
      line += '\n';
    }
    file.write(line);
  }
}

void write_obj_mesh(const Mesh& mesh, OutputFile& file) {
  std::string line;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    line.clear();
    append_vertex(mesh.vertices[i], mesh.colors, i, line);
    file.write(line);
  }
  for (const auto& triangle : mesh.triangles) {
    line.assign(1, 'f');
    for (const std::uint32_t vertex : triangle) {
      line += ' ';
      append_number(line, std::uint64_t{vertex} + 1);
    }
    line += '\n';
    file.write(line);
  }
}

}  // namespace g3r::io
