// Binary glTF 2.0 out: one mesh, float32 positions around their centre, which the node's translation puts back, 32-bit indices and colours.
#include "base/vector.h"
#include "io/table.h"
#include "io/text_numbers.h"
#include "io/writers.h"

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

// The binary part: positions, colours, indices, one after the other.
struct BodyBytes {
  std::uint64_t positions, colors, indices;
  [[nodiscard]] std::uint64_t body() const { return positions + colors + indices; }
};

std::array<float, 3> offsets_from(const Vec3& centre, const Vec3& place) {
  return {to_float(place[0] - centre[0]), to_float(place[1] - centre[1]), to_float(place[2] - centre[2])};
}

// The JSON part.
std::string description_of(const Mesh& mesh, const vector::Box& box, const BodyBytes& bytes) {
  const bool colored = !mesh.colors.empty();
  const Vec3 centre = box.centre();
  std::string text = R"({"asset":{"version":"2.0","generator":"g3r"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":)";
  append_array(centre, text);
  text += R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0)";
  text += colored ? R"(,"COLOR_0":2},"indices":1}]}],)" : R"(},"indices":1}]}],)";
  text += R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)";
  append_number(text, std::uint64_t{mesh.vertices.size()});
  text += R"(,"min":)";
  append_array(offsets_from(centre, box.low), text);
  text += R"(,"max":)";
  append_array(offsets_from(centre, box.high), text);
  text += R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)";
  append_number(text, std::uint64_t{3 * mesh.triangles.size()});
  if (colored) {
    text += R"(},{"bufferView":2,"componentType":5121,"normalized":true,"type":"VEC4","count":)";
    append_number(text, std::uint64_t{mesh.colors.size()});
  }
  text += R"(}],"bufferViews":[)";
  append_view(0, bytes.positions, kArrayBuffer, text);
  text += ',';
  append_view(bytes.positions + bytes.colors, bytes.indices, kElementBuffer, text);
  if (colored) {
    text += ',';
    append_view(bytes.positions, bytes.colors, kArrayBuffer, text);
  }
  text += R"(],"buffers":[{"byteLength":)";
  append_number(text, bytes.body());
  text += "}]}";
  return text;
}

}  // namespace

void write_glb_mesh(const Mesh& mesh, OutputFile& file) {
  vector::Box box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  const Vec3 centre = box.centre();
  const BodyBytes body_bytes{12 * std::uint64_t{mesh.vertices.size()}, 4 * std::uint64_t{mesh.colors.size()},
                             12 * std::uint64_t{mesh.triangles.size()}};
  const std::uint64_t body = body_bytes.body();
  std::string text = description_of(mesh, box, body_bytes);
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
    for (const float x : offsets_from(centre, v)) append_u32(bytes, bits_as<std::uint32_t>(x));
    file.write(bytes);
  }
  for (const auto& color : mesh.colors) {
    const char rgba[] = {static_cast<char>(color[0]), static_cast<char>(color[1]), static_cast<char>(color[2]), '\xff'};
    file.write(rgba, sizeof rgba);
  }
  for (const auto& triangle : mesh.triangles) file.write(triangle.data(), 12);
}

}  // namespace g3r::io
