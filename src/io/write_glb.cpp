// Binary glTF 2.0 out: one mesh, float32 positions around their centre, which the node's translation puts back, 32-bit indices and colours.
#include "io/table.h"
#include "io/text.h"
#include "io/writers.h"

#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

namespace g3r::io {

namespace {

constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kUnsignedByte = 5121;
constexpr int kArrayBuffer = 34962;
constexpr int kElementBuffer = 34963;

void append_u32(std::string& bytes, std::uint32_t value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); }

float to_float(double value) {
  float number = 0;
  store_double(Type::kFloat32, value, reinterpret_cast<char*>(&number));
  return number;
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
  using nlohmann::json;
  json gltf;
  gltf["asset"] = {{"version", "2.0"}, {"generator", "g3r"}};
  gltf["scene"] = 0;
  gltf["scenes"] = json::array({{{"nodes", {0}}}});
  gltf["nodes"] = json::array({{{"mesh", 0}, {"translation", centre}}});
  json primitive = {{"attributes", {{"POSITION", 0}}}, {"indices", 1}};
  gltf["bufferViews"] =
      json::array({{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", position_bytes}, {"target", kArrayBuffer}},
                   {{"buffer", 0}, {"byteOffset", position_bytes + color_bytes}, {"byteLength", index_bytes}, {"target", kElementBuffer}}});
  gltf["accessors"] = json::array(
      {{{"bufferView", 0}, {"componentType", kFloat}, {"count", mesh.vertices.size()}, {"type", "VEC3"}, {"min", least}, {"max", most}},
       {{"bufferView", 1}, {"componentType", kUnsignedInt}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}}});
  if (!mesh.colors.empty()) {
    primitive["attributes"]["COLOR_0"] = 2;
    gltf["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", position_bytes}, {"byteLength", color_bytes}, {"target", kArrayBuffer}});
    gltf["accessors"].push_back(
        {{"bufferView", 2}, {"componentType", kUnsignedByte}, {"normalized", true}, {"count", mesh.colors.size()}, {"type", "VEC4"}});
  }
  gltf["meshes"] = json::array({{{"primitives", json::array({primitive})}}});
  const std::uint64_t body = position_bytes + color_bytes + index_bytes;
  gltf["buffers"] = json::array({{{"byteLength", body}}});
  std::string text = gltf.dump();
  text.append((4 - text.size() % 4) % 4, ' ');
  constexpr std::uint64_t kHeaders = 12 + 8 + 8;
  if (body + text.size() + kHeaders > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput("write_mesh: GLB files hold at most 4 GiB; write PLY");

  std::string bytes = "glTF";
  append_u32(bytes, 2);
  append_u32(bytes, static_cast<std::uint32_t>(kHeaders + text.size() + body));
  append_u32(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += "JSON" + text;
  append_u32(bytes, static_cast<std::uint32_t>(body));
  bytes.append("BIN\0", 4);
  file.write(bytes);
  for (const Vec3& v : mesh.vertices) {
    bytes.clear();
    for (std::size_t a = 0; a < 3; ++a) append_u32(bytes, std::bit_cast<std::uint32_t>(to_float(v[a] - centre[a])));
    file.write(bytes);
  }
  for (const auto& color : mesh.colors) {
    const char rgba[] = {static_cast<char>(color[0]), static_cast<char>(color[1]), static_cast<char>(color[2]), '\xff'};
    file.write(rgba, sizeof rgba);
  }
  for (const auto& triangle : mesh.triangles) file.write(triangle.data(), 12);
}

}  // namespace g3r::io
