// The sheets of all tiles into one mesh: vertices by tile, then those in the middle of polygons by tile, then the triangles.
#include "base/stages.h"
#include "io/output_file.h"
#include "io/source.h"
#include "mesh/field_contour.h"
#include "tiles/mesh_passes.h"

#include <g3r/io.h>
#include <g3r/tiles.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numeric>
#include <system_error>

namespace g3r::tiles {
namespace {

constexpr std::uint64_t kAtOnce = 4096;                                            // records read at once
constexpr std::uint64_t kMostVertices = std::numeric_limits<std::int32_t>::max();  // that readers of PLY take

// A file of sheets, piece by piece.
class SheetsFile {
 public:
  SheetsFile(const std::string& folder, std::size_t tile) : file_(mesh_sheets_path(folder, tile)) {
    if (file_.size() < sizeof header_) fail();
    file_.read(0, &header_, sizeof header_);
    constexpr std::uint64_t kMost = std::uint64_t{1} << 40U;  // records; sums below do not overflow
    for (const std::uint64_t count : {header_.vertices, header_.foreign, header_.polygons, header_.corners}) {
      if (count > kMost) fail();
    }
    if (file_.size() != corners_at() + header_.corners * sizeof(std::uint32_t)) fail();
  }

  [[nodiscard]] const SheetsHeader& header() const { return header_; }
  void append_vertices(std::uint64_t begin, std::uint64_t end, std::vector<MeshVertex>& out) const {
    append(sizeof header_ + begin * sizeof(MeshVertex), end - begin, out);
  }
  void append_foreign(std::vector<ForeignVertex>& out) const { append(foreign_at(), header_.foreign, out); }

  // Checked: every corner is one of `vertices`, and the polygons use all corners.
  void read_polygons(mesh::DualSurface& surface) const {
    std::vector<std::uint8_t> sizes;
    append(polygons_at(), 2 * header_.polygons, sizes);
    append(corners_at(), header_.corners, surface.polygon_vertices);
    surface.polygon_begin.assign(1, 0);
    for (std::size_t p = 0; p < header_.polygons; ++p) {
      if (sizes[2 * p] < 3 || (sizes[2 * p + 1] != 0 && sizes[2 * p] != 4)) fail();
      surface.polygon_begin.push_back(surface.polygon_begin.back() + sizes[2 * p]);
      surface.safe_diagonals.push_back(sizes[2 * p + 1]);
    }
    surface.crossings.resize(header_.polygons);
    const std::uint64_t count = header_.vertices + header_.foreign;
    const auto is_number = [&](std::uint32_t v) { return v < count; };
    if (surface.polygon_begin.back() != header_.corners ||
        !std::all_of(surface.polygon_vertices.begin(), surface.polygon_vertices.end(), is_number)) {
      fail();
    }
  }

  [[noreturn]] void fail() const { throw InvalidInput(escape_text(file_.path()) + ": damaged; remove it, and mesh again"); }

 private:
  [[nodiscard]] std::uint64_t foreign_at() const { return sizeof header_ + header_.vertices * sizeof(MeshVertex); }
  [[nodiscard]] std::uint64_t polygons_at() const { return foreign_at() + header_.foreign * sizeof(ForeignVertex); }
  [[nodiscard]] std::uint64_t corners_at() const { return polygons_at() + 2 * header_.polygons; }
  template <class T>
  void append(std::uint64_t at, std::uint64_t count, std::vector<T>& out) const {
    const std::size_t before = out.size();
    out.resize(before + static_cast<std::size_t>(count));
    file_.read(at, out.data() + before, static_cast<std::size_t>(count) * sizeof(T));
  }

  io::RandomFile file_;
  SheetsHeader header_;
};

// Where the vertices of each tile begin in the mesh.
struct Numbers {
  std::vector<std::uint64_t> vertices, centres;
  std::uint64_t all_vertices = 0, triangles = 0;
};

Numbers number_vertices(const MeshFolder& folder) {
  Numbers out;
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const SheetsHeader header = SheetsFile(folder.folder, t).header();
    out.vertices.push_back(out.all_vertices);
    out.centres.push_back(header.centres);
    out.all_vertices += header.vertices;
    out.triangles += header.triangles;
  }
  for (std::uint64_t& centres : out.centres) {
    const std::uint64_t count = centres;
    centres = out.all_vertices;
    out.all_vertices += count;
  }
  if (out.triangles == 0) throw InvalidInput("no surface found: the oriented points do not enclose a volume");
  if (out.all_vertices > kMostVertices) {
    throw Unavailable("a PLY file holds at most 2,147,483,647 vertices, the mesh has " + std::to_string(out.all_vertices) +
                      "; thin the cloud, or mesh parts of it one by one");
  }
  return out;
}

// The triangles of one tile, and the numbers in the whole mesh of what they stand on.
struct TileMesh {
  Mesh mesh;
  std::vector<std::uint64_t> number;  // of each vertex
};

TileMesh triangles_of(const MeshFolder& folder, const Numbers& numbers, std::size_t tile) {
  const SheetsFile file(folder.folder, tile);
  std::vector<MeshVertex> vertices;
  std::vector<ForeignVertex> foreign;
  file.append_vertices(0, file.header().vertices, vertices);
  file.append_foreign(foreign);
  TileMesh out;
  for (std::size_t v = 0; v < vertices.size(); ++v) out.number.push_back(numbers.vertices[tile] + v);
  for (std::size_t f = 0; f < foreign.size();) {
    const std::uint64_t from = foreign[f].tile;
    if (from >= folder.tiles()) file.fail();
    const SheetsFile there(folder.folder, static_cast<std::size_t>(from));
    std::vector<MeshVertex> read;
    for (std::uint64_t at = 0; at < there.header().vertices; at += kAtOnce) {
      read.clear();
      there.append_vertices(at, std::min(there.header().vertices, at + kAtOnce), read);
      for (std::size_t k = 0; k < read.size(); ++k) {
        if (f == foreign.size() || foreign[f].tile != from || read[k].key != foreign[f].key) continue;
        vertices.push_back(read[k]);
        out.number.push_back(numbers.vertices[static_cast<std::size_t>(from)] + at + k);
        ++f;
      }
    }
    if (f < foreign.size() && foreign[f].tile == from) there.fail();
  }
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  for (const MeshVertex& v : vertices) {
    positions.push_back(v.position);
    normals.push_back({v.normal[0], v.normal[1], v.normal[2]});
  }
  mesh::DualSurface surface;
  file.read_polygons(surface);
  out.mesh = mesh::triangulate(surface, std::move(positions), normals);
  for (std::uint64_t c = 0; out.number.size() < out.mesh.vertices.size(); ++c) out.number.push_back(numbers.centres[tile] + c);
  if (out.mesh.triangles.size() != file.header().triangles || out.number.size() != vertices.size() + file.header().centres) file.fail();
  return out;
}

std::string ply_header(const MeshFolder& folder, const Numbers& numbers) {
  const std::string type = folder.manifest.single_precision ? "float" : "double";
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment g3r " + std::string(version()) + ", " + std::to_string(folder.tiles()) +
                     " tiles\nelement vertex " + std::to_string(numbers.all_vertices) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += "property " + type + " " + axis + "\n";
  return text + "element face " + std::to_string(numbers.triangles) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

void append_vertex(const MeshFolder& folder, const Vec3& unit, std::string& bytes) {
  const Frame& frame = folder.manifest.frame;
  for (std::size_t a = 0; a < 3; ++a) {
    const double c = unit[a] / frame.scale + frame.centre[a];
    const auto rounded = static_cast<float>(c);
    if (folder.manifest.single_precision) {
      bytes.append(reinterpret_cast<const char*>(&rounded), sizeof rounded);
    } else {
      bytes.append(reinterpret_cast<const char*>(&c), sizeof c);
    }
  }
}

void require_sheets(const MeshFolder& folder) {
  std::size_t missing = 0;
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    std::error_code ignored;
    missing += std::filesystem::exists(mesh_sheets_path(folder.folder, t), ignored) ? 0 : 1;
  }
  if (missing == 0) return;
  throw InvalidInput(escape_text(folder.folder) + ": " + std::to_string(missing) + " of " + std::to_string(folder.tiles()) +
                     " tiles are not meshed; g3r tiles mesh FOLDER does them");
}

MergedMesh merge(const MeshFolder& folder, const std::string& output, const Monitor& monitor) {
  require_sheets(folder);
  Stages stages(monitor);
  stages.begin("merge");
  const Numbers numbers = number_vertices(folder);
  io::OutputFile file(output, monitor.cancel);
  file.write(ply_header(folder, numbers));
  std::string bytes;
  const auto write = [&](std::size_t step) {
    file.write(bytes);
    bytes.clear();
    stages.progress(static_cast<double>(step) / static_cast<double>(3 * folder.tiles()));
  };
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const SheetsFile sheets(folder.folder, t);
    std::vector<MeshVertex> vertices;
    sheets.append_vertices(0, sheets.header().vertices, vertices);
    for (const MeshVertex& v : vertices) append_vertex(folder, v.position, bytes);
    write(t);
  }
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    if (SheetsFile(folder.folder, t).header().centres == 0) continue;
    const TileMesh tile = triangles_of(folder, numbers, t);
    for (std::size_t v = 0; v < tile.number.size(); ++v) {
      if (tile.number[v] >= numbers.centres[0]) append_vertex(folder, tile.mesh.vertices[v], bytes);
    }
    write(folder.tiles() + t);
  }
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const TileMesh tile = triangles_of(folder, numbers, t);
    for (auto corners : tile.mesh.triangles) {
      if (folder.plan.inside_out) std::swap(corners[1], corners[2]);
      bytes.push_back(3);
      for (const std::uint32_t v : corners) {
        const auto number = static_cast<std::int32_t>(tile.number[v]);
        bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
      }
    }
    write(2 * folder.tiles() + t);
  }
  file.commit();
  return {numbers.all_vertices, numbers.triangles};
}

}  // namespace
}  // namespace g3r::tiles

namespace g3r {

MergedMesh merge_mesh(const std::string& folder, const std::string& output, const Monitor& monitor) {
  if (io::extension(output) != "ply") {
    throw InvalidInput(escape_text(output) + ": meshes of tiles are written as binary PLY: expected a name that ends in .ply");
  }
  return tiles::merge(tiles::read_mesh_folder(folder, tiles::read_manifest(folder)), output, monitor);
}

}  // namespace g3r
