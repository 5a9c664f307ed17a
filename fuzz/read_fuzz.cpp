// libFuzzer target for one reader: G3R_FUZZ_FORMATS names the formats (of io::Format) that it takes; other inputs are not kept.
// Beside crashes, hangs and sanitizer findings it checks the memory law and that what a reader returns is consistent.
#include <g3r/io.h>

#include <initializer_list>

#include "io/recognise.h"
#include "require.h"

namespace {

using g3r::fuzz::require;
using g3r::io::Format;

// Beside the file itself. Compressed PCD expands up to 88 times by its nature: there the law is about what the stream really holds.
constexpr std::size_t kTimesSize = 15;
constexpr std::size_t kTimesCompressed = 88 * 6;
constexpr std::size_t kConstant = std::size_t{1} << 20;

template <class List>
bool fits(const List& list, std::size_t count) {
  return list.empty() || list.size() == count;
}

void read_points(const char* bytes, std::size_t size) {
  try {
    const g3r::Cloud cloud = g3r::read_cloud_bytes(bytes, size, "input");
    const std::size_t count = cloud.positions.size();
    require(fits(cloud.normals, count) && fits(cloud.colors, count) && fits(cloud.confidence, count), "one entry per point");
    require(count <= size, "no more points than bytes");
  } catch (const g3r::InvalidInput&) {
  }
}

void read_faces(const char* bytes, std::size_t size) {
  try {
    const g3r::Mesh mesh = g3r::read_mesh_bytes(bytes, size, "input");
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle) require(vertex < mesh.vertices.size(), "indices name vertices");
    }
  } catch (const g3r::InvalidInput&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const char* bytes = reinterpret_cast<const char*>(data);
  const std::string_view text(bytes, size);
  try {
    const Format found = g3r::io::recognise({text, "input"});
    bool ours = false;
    for (const Format format : {G3R_FUZZ_FORMATS}) ours = ours || format == found;
    if (!ours) return -1;
  } catch (const g3r::InvalidInput&) {
    return -1;
  }
  const bool compressed = text.find("binary_compressed") != std::string_view::npos;
  const g3r::fuzz::MemoryLaw law((compressed ? kTimesCompressed : kTimesSize) * size, kConstant);
  read_points(bytes, size);
  read_faces(bytes, size);
  return 0;
}
