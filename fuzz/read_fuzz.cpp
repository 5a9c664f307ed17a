// libFuzzer target for one reader: G3R_FUZZ_FORMATS names the formats (of io::Format) that it takes; other inputs are not kept.
// Beside crashes, hangs and sanitizer findings it checks the memory law and that what a reader returns is consistent.
#include <g3r/io.h>

#include <initializer_list>

#include "io/recognise.h"
#include "require.h"

namespace {

using g3r::fuzz::require;
using g3r::io::Format;

// What reading may take beside the file itself: so many times its size and so many bytes; and how many points for a byte.
struct Limits {
  std::size_t times = 15;
  std::size_t constant = std::size_t{1} << 20;
  std::size_t points = 1;
};

bool is_laz(std::string_view bytes) {
  constexpr std::size_t kPointFormat = 104;
  return bytes.substr(0, 4) == "LASF" && bytes.size() > kPointFormat && (bytes[kPointFormat] & 0xC0) != 0;
}

// Compressed files expand by their nature; how far, their readers say (src/io). LASzip and libE57Format take memory of their own.
Limits limits_of(std::string_view bytes, Format format) {
  constexpr std::size_t kLibrary = std::size_t{16} << 20;
  if (is_laz(bytes)) return {256 * 5, kLibrary, 13};
  if (format == Format::kE57) return {64 * 5, kLibrary, 3};
  if (format == Format::kSpz) return {32 * 6, std::size_t{1} << 20, 2};
  if (bytes.find("binary_compressed") != std::string_view::npos) return {88 * 6};
  return {};
}

template <class List>
bool fits(const List& list, std::size_t count) {
  return list.empty() || list.size() == count;
}

void read_points(const char* bytes, std::size_t size, std::size_t most_points) {
  try {
    const g3r::Cloud cloud = g3r::read_cloud_bytes(bytes, size, "input");
    const std::size_t count = cloud.positions.size();
    require(fits(cloud.normals, count) && fits(cloud.colors, count) && fits(cloud.confidence, count), "one entry per point");
    require(fits(cloud.scan_of_point, count), "one scan per point");
    for (const std::uint32_t scan : cloud.scan_of_point) require(scan < cloud.sensor_positions.size(), "scans have positions");
    require(count <= most_points * size, "no more points than bytes hold");
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
  Format found{};
  try {
    found = g3r::io::recognise({text, "input"});
  } catch (const g3r::InvalidInput&) {
    return -1;
  }
  bool ours = false;
  for (const Format format : {G3R_FUZZ_FORMATS}) ours = ours || format == found;
#ifdef G3R_FUZZ_LAZ
  ours = ours && is_laz(text);
#endif
  if (!ours) return -1;
  const Limits limits = limits_of(text, found);
  const g3r::fuzz::MemoryLaw law(limits.times * size, limits.constant);
  read_points(bytes, size, limits.points);
  read_faces(bytes, size);
  return 0;
}
