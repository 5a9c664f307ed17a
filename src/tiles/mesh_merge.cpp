// The patches of all tiles into one mesh, without the components that nothing holds: vertices by tile, then those in the middle of polygons
// by tile, then the triangles.
#include "base/platform.h"
#include "base/stages.h"
#include "io/output_file.h"
#include "io/source.h"
#include "tiles/mesh_plan.h"
#include "tiles/parts.h"
#include "tiles/patches_file.h"

#include <g3r/io.h>
#include <g3r/tiles.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numeric>
#include <system_error>

namespace g3r::tiles {
namespace {

constexpr std::uint64_t kMostVertices = std::numeric_limits<std::int32_t>::max();  // that readers of PLY take

// Where the vertices of each tile begin in the mesh, and those in the middle of its polygons.
struct Numbers {
  std::vector<std::uint64_t> vertices, centres;
  std::uint64_t all_vertices = 0, triangles = 0;
};

Numbers number_vertices(const MeshFolder& folder, const KeptParts& kept) {
  Numbers out;
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    out.vertices.push_back(out.all_vertices);
    out.all_vertices += kept.counts(t).vertices;
    out.triangles += kept.counts(t).triangles;
  }
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    out.centres.push_back(out.all_vertices);
    out.all_vertices += kept.counts(t).centres;
  }
  if (out.triangles == 0) throw InvalidInput("no surface found: the oriented points do not enclose a volume");
  if (out.all_vertices > kMostVertices) {
    throw Unavailable("a PLY file holds at most 2,147,483,647 vertices, the mesh has " + std::to_string(out.all_vertices) +
                      "; thin the cloud, or mesh parts of it one by one");
  }
  return out;
}

// The triangles of one tile that stay, and the numbers in the whole mesh of what they stand on.
class KeptSurface {
 public:
  KeptSurface(const MeshFolder& folder, const KeptParts& kept, const Numbers& numbers, std::size_t tile)
      : surface_(read_surface(folder, tile)) {
    const PartsFile file(folder, tile);
    const std::vector<ForeignPart> foreign = file.foreign();
    for (std::size_t f = 0; f < foreign.size(); ++f) {
      const TileSurface::Place& at = surface_.foreign[f];
      if (foreign[f].tile != at.tile || foreign[f].vertex != at.vertex) file.fail();
    }
    for (const MovedVertex& moved : file.moved()) {
      if (moved.vertex >= surface_.own) surface_.mesh.vertices[moved.vertex + surface_.foreign.size()] = moved.position;
    }
    const std::vector<std::uint32_t> part = file.parts_of(0, surface_.own);
    const auto keeps = [&](std::uint32_t v) { return kept.keeps(tile, v < surface_.own ? part[v] : foreign[v - surface_.own].part); };
    number_own(folder, kept, numbers, tile);
    std::vector<std::uint8_t> seen(mesh().vertices.size() - number_.size(), 0);
    const auto centres = static_cast<std::uint32_t>(number_.size());
    for (const auto& t : mesh().triangles) {
      const std::uint32_t known = *std::min_element(t.begin(), t.end());  // a triangle has one centre at most
      if (!keeps(known)) continue;
      triangles_.push_back(t);
      for (const std::uint32_t v : t) {
        if (v >= centres) seen[v - centres] = 1;
      }
    }
    for (const std::uint8_t is_there : seen) {
      number_.push_back(numbers.centres[tile] + centres_.size());
      if (is_there != 0) centres_.push_back(mesh().vertices[number_.size() - 1]);
    }
    const Part& counts = kept.counts(tile);
    if (triangles_.size() != counts.triangles || centres_.size() != counts.centres) file.fail();
  }

  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<Vec3>& centres() const { return centres_; }
  [[nodiscard]] std::uint64_t number(std::uint32_t vertex) const { return number_[vertex]; }

 private:
  [[nodiscard]] const Mesh& mesh() const { return surface_.mesh; }

  // Of own and of foreign vertices: those that stay before it in its tile, after those of all tiles before.
  void number_own(const MeshFolder& folder, const KeptParts& kept, const Numbers& numbers, std::size_t tile) {
    const auto add = [&](std::size_t of, const auto& wanted, std::size_t count) {
      const PartsFile file(folder, of);
      const std::vector<std::uint32_t> part = file.parts_of(0, file.header().vertices);
      std::uint64_t next = numbers.vertices[of];
      std::uint64_t at = 0;
      for (std::size_t k = 0; k < count; ++k) {
        for (; at < wanted(k); ++at) next += kept.keeps(of, part[static_cast<std::size_t>(at)]) ? 1 : 0;
        number_.push_back(next);
      }
    };
    add(
        tile, [](std::size_t k) { return std::uint64_t{k}; }, surface_.own);
    for (std::size_t f = 0; f < surface_.foreign.size();) {
      const std::size_t from = surface_.foreign[f].tile;
      std::size_t last = f;
      while (last < surface_.foreign.size() && surface_.foreign[last].tile == from) ++last;
      add(
          from, [&](std::size_t k) { return surface_.foreign[f + k].vertex; }, last - f);
      f = last;
    }
  }

  TileSurface surface_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Vec3> centres_;
  std::vector<std::uint64_t> number_;  // of each vertex; of those that go, nobody asks
};

std::string ply_header(const MeshFolder& folder, const Numbers& numbers) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment g3r " + std::string(version()) + ", " + std::to_string(folder.tiles()) +
                     " tiles\nelement vertex " + std::to_string(numbers.all_vertices) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += std::string("property double ") + axis + "\n";
  return text + "element face " + std::to_string(numbers.triangles) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

void append_vertex(const MeshFolder& folder, const Vec3& unit, std::string& bytes) {
  const Frame& frame = folder.manifest.frame;
  for (std::size_t a = 0; a < 3; ++a) {
    const double c = unit[a] / frame.scale + frame.centre[a];
    bytes.append(reinterpret_cast<const char*>(&c), sizeof c);
  }
}

void require_parts(const MeshFolder& folder) {
  std::size_t missing = 0;
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    std::error_code ignored;
    missing += std::filesystem::exists(platform::path_of(mesh_parts_path(folder.folder, t)), ignored) ? 0 : 1;
  }
  if (missing == 0) return;
  throw InvalidInput(escape_text(folder.folder) + ": " + std::to_string(missing) + " of " + std::to_string(folder.tiles()) +
                     " tiles are not meshed; g3r tiles mesh FOLDER does them");
}

void require_known(const MeshOptions& options) {
  if (options.trim == MeshOptions::Trim::kOff && options.faces == 0 && options.depth == 0 && options.mesher != Mesher::kPoisson) return;
  throw Unavailable("meshes of tiles take keep_largest, min_component and keep_all alone; leave mesher, depth, trim and faces as they are");
}

// Of the vertices of a tile those that stay.
void append_vertices(const MeshFolder& folder, const KeptParts& kept, std::size_t tile, std::string& bytes) {
  const PatchesFile patches(folder.folder, tile);
  const PartsFile parts(folder, tile);
  const std::vector<MovedVertex> moved = parts.moved();
  std::vector<MeshVertex> vertices;
  std::uint64_t count = 0;
  std::size_t next = 0;
  for (std::uint64_t at = 0; at < patches.header().vertices; at += kRecordsAtOnce) {
    const std::uint64_t end = std::min(patches.header().vertices, at + kRecordsAtOnce);
    vertices.clear();
    patches.append_vertices(at, end, vertices);
    const std::vector<std::uint32_t> part = parts.parts_of(at, end);
    for (std::size_t k = 0; k < part.size(); ++k) {
      if (next < moved.size() && moved[next].vertex == at + k) vertices[k].position = moved[next++].position;
      if (!kept.keeps(tile, part[k])) continue;
      append_vertex(folder, vertices[k].position, bytes);
      ++count;
    }
  }
  if (count != kept.counts(tile).vertices) parts.fail();
}

MergedMesh merge(const MeshFolder& folder, const std::string& output, const MeshOptions& options, const Monitor& monitor) {
  require_known(options);
  require_parts(folder);
  Stages stages(monitor);
  stages.begin("merge");
  MergedMesh out;
  const KeptParts kept(folder, options, out.dropped);
  const Numbers numbers = number_vertices(folder, kept);
  io::OutputFile file(output, monitor.cancel);
  file.write(ply_header(folder, numbers));
  std::string bytes;
  const auto write = [&](std::size_t step) {
    file.write(bytes);
    bytes.clear();
    stages.progress(static_cast<double>(step) / static_cast<double>(3 * folder.tiles()));
  };
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    append_vertices(folder, kept, t, bytes);
    write(t);
  }
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    if (kept.counts(t).centres == 0) continue;
    const KeptSurface surface(folder, kept, numbers, t);
    for (const Vec3& centre : surface.centres()) append_vertex(folder, centre, bytes);
    write(folder.tiles() + t);
  }
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const KeptSurface surface(folder, kept, numbers, t);
    for (auto corners : surface.triangles()) {
      if (folder.plan.inside_out) std::swap(corners[1], corners[2]);
      bytes.push_back(3);
      for (const std::uint32_t v : corners) {
        const auto number = static_cast<std::int32_t>(surface.number(v));
        bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
      }
    }
    write(2 * folder.tiles() + t);
  }
  file.commit();
  out.vertices = numbers.all_vertices;
  out.triangles = numbers.triangles;
  out.components = kept.components();
  out.dropped.area /= folder.manifest.frame.scale * folder.manifest.frame.scale;
  return out;
}

}  // namespace
}  // namespace g3r::tiles

namespace g3r {

MergedMesh merge_mesh(const std::string& folder, const std::string& output, const MeshOptions& options, const Monitor& monitor) {
  if (io::extension(output) != "ply") {
    throw InvalidInput(escape_text(output) + ": meshes of tiles are written as binary PLY: expected a name that ends in .ply");
  }
  const tiles::Manifest manifest = tiles::read_manifest(folder);
  tiles::require_no_input(manifest, output);
  return tiles::merge(tiles::read_mesh_folder(folder, manifest), output, options, monitor);
}

}  // namespace g3r
