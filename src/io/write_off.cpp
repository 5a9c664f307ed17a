// OFF out, in text; COFF where there are colours.
#include "io/text_numbers.h"
#include "io/writers.h"

namespace g3r::io {

void write_off_mesh(const Mesh& mesh, OutputFile& file) {
  std::string line = mesh.colors.empty() ? "OFF\n" : "COFF\n";
  line += std::to_string(mesh.vertices.size()) + ' ' + std::to_string(mesh.triangles.size()) + " 0\n";
  file.write(line);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    line.clear();
    for (const double coordinate : mesh.vertices[i]) {
      append_number(line, coordinate);
      line += ' ';
    }
    if (!mesh.colors.empty()) {
      for (const std::uint8_t channel : mesh.colors[i]) {
        append_number(line, std::uint64_t{channel});
        line += ' ';
      }
      line += "255 ";
    }
    line.back() = '\n';
    file.write(line);
  }
  for (const auto& triangle : mesh.triangles) {
    line.assign(1, '3');
    for (const std::uint32_t vertex : triangle) {
      line += ' ';
      append_number(line, std::uint64_t{vertex});
    }
    line += '\n';
    file.write(line);
  }
}

}  // namespace g3r::io
