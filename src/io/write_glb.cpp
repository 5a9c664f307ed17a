// Binary glTF 2.0 out: one mesh, float32 positions around their centre, which the node's translation puts back, 32-bit indices and colours.
#include "io/table.h"
#include "io/text.h"
#include "io/writers.h"

#include <algorithm>
#include <limits>

namespace g3r::io {

namespace {

constexpr int kArrayBuffer = 34962;
constexpr int kElementBuffer = 34963;

void append_u32(std::string& bytes, std::uint32_t value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); }

float to_float(double value) {
  float number = 0;
  store_double(Type::kFloat32, value, reinterpret_cast<char*>(&number));
  return number;
}

template <class Number>
void append_array(const std::array<Number, 3>& numbers, std::string& text) {
  char mark = '[';
  for (const Number number : numbers) {
    text += mark;
    append_number(text, number);
    mark = ',';
  }
  text += ']';
}

void append_view(std::uint64_t offset, std::uint64_t bytes, int target, std::string& text) {
  text += R"({"buffer":0,"byteOffset":)";
  append_number(text, offset);
  text += R"(,"byteLength":)";
  append_number(text, bytes);
  text += R"(,"target":)";
  append_number(text, static_cast<std::int64_t>(target));
  text += '}';
}

}  // namespace

void write_glb_mesh(const Mesh& mesh, OutputFile& file) {
  Vec3 low{mesh.vertices[0]};
  Vec3 high{mesh.vertices[0]};
  for (const Vec3& v : mesh.vertices) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], v[a]);
      high[a] = std::max(high[a], v[a]);
    }
  }
  Vec3 centre{};
  std::array<float, 3> least{};
  std::array<float, 3> most{};
  for (std::size_t a = 0; a < 3; ++a) {
    centre[a] = low[a] / 2 + high[a] / 2;
    least[a] = to_float(low[a] - centre[a]);
    most[a] = to_float(high[a] - centre[a]);
  }
  const std::uint64_t position_bytes = 12 * std::uint64_t{mesh.vertices.size()};
  const std::uint64_t color_bytes = 4 * std::uint64_t{mesh.colors.size()};
  const std::uint64_t index_bytes = 12 * std::uint64_t{mesh.triangles.size()};
  const std::uint64_t body = position_bytes + color_bytes + index_bytes;
  const bool colored = !mesh.colors.empty();
  std::string text = R"({"asset":{"version":"2.0","generator":"g3r"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":)";
  append_array(centre, text);
  text += R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0)";
  text += colored ? R"(,"COLOR_0":2},"indices":1}]}],)" : R"(},"indices":1}]}],)";
  text += R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)";
  append_number(text, std::uint64_t{mesh.vertices.size()});
  text += R"(,"min":)";
  append_array(least, text);
  text += R"(,"max":)";
  append_array(most, text);
  text += R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)";
  append_number(text, std::uint64_t{3 * mesh.triangles.size()});
  if (colored) {
    text += R"(},{"bufferView":2,"componentType":5121,"normalized":true,"type":"VEC4","count":)";
    append_number(text, std::uint64_t{mesh.colors.size()});
  }
  text += R"(}],"bufferViews":[)";
  append_view(0, position_bytes, kArrayBuffer, text);
  text += ',';
  append_view(position_bytes + color_bytes, index_bytes, kElementBuffer, text);
  if (colored) {
    text += ',';
    append_view(position_bytes, color_bytes, kArrayBuffer, text);
  }
  text += R"(],"buffers":[{"byteLength":)";
  append_number(text, body);
  text += "}]}";
  text.append((4 - text.size() % 4) % 4, ' ');
  constexpr std::uint64_t kHeaders = 12 + 8 + 8;
  if (body + text.size() + kHeaders > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput("write_mesh: GLB files hold at most 4 GiB; write PLY");

  std::string bytes = "glTF";
  append_u32(bytes, 2);
  append_u32(bytes, static_cast<std::uint32_t>(kHeaders + text.size() + body));
  append_u32(bytes, static_cast<std::uint32_t>(text.size()));
  (bytes += "JSON") += text;
  append_u32(bytes, static_cast<std::uint32_t>(body));
  bytes.append("BIN\0", 4);
  file.write(bytes);
  for (const Vec3& v : mesh.vertices) {
    bytes.clear();
    for (std::size_t a = 0; a < 3; ++a) append_u32(bytes, bits_as<std::uint32_t>(to_float(v[a] - centre[a])));
    file.write(bytes);
  }
  for (const auto& color : mesh.colors) {
    const char rgba[] = {static_cast<char>(color[0]), static_cast<char>(color[1]), static_cast<char>(color[2]), '\xff'};
    file.write(rgba, sizeof rgba);
  }
  for (const auto& triangle : mesh.triangles) file.write(triangle.data(), 12);
}

}  // namespace g3r::io
