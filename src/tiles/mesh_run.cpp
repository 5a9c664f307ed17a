// The passes over the tiles of one worker; what they need of other tiles is made here where it is not there.
#include "base/platform.h"
#include "base/stages.h"
#include "cpu/parallel.h"
#include "sum/device_scope.h"
#include "tiles/mesh_passes.h"
#include "tiles/patches_file.h"

#include <g3r/io.h>
#include <g3r/tiles.h>

#include <filesystem>
#include <numeric>
#include <system_error>

namespace g3r::tiles {
namespace {

bool is_there(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(platform::path_of(path), ignored);
}

class MeshRun {
 public:
  MeshRun(const MeshFolder& folder, Stages& stages) : folder_(folder), stages_(stages) {}

  void points(std::size_t t) {
    if (is_there(mesh_points_path(folder_.folder, t))) return;
    begin("points", t);
    write_points(folder_, t, stages_.cancel());
  }

  void corners(std::size_t t) {
    if (is_there(mesh_corners_path(folder_.folder, t))) return;
    for (std::size_t k = 0; k < folder_.tiles(); ++k) points((t + k) % folder_.tiles());
    begin("sides", t);
    write_corners(folder_, t, stages_.cancel());
  }

  void patches(std::size_t t) {
    if (is_there(mesh_patches_path(folder_.folder, t))) return;
    for (const std::size_t other : tiles_of_corners(folder_, t)) corners(other);
    begin("surface", t);
    write_patches(folder_, t, stages_.cancel());
  }

  void parts(std::size_t t) {
    if (is_there(mesh_parts_path(folder_.folder, t))) return;
    patches(t);
    const PatchesFile file(folder_.folder, t);
    for (const std::size_t other : file.foreign_tiles()) {
      if (other >= folder_.tiles()) file.fail();
      patches(other);
    }
    for (const std::size_t other : tiles_around(folder_, t)) points(other);
    begin("parts", t);
    write_parts(folder_, t, stages_.cancel());
  }

 private:
  void begin(const std::string& what, std::size_t t) {
    stages_.begin("mesh " + std::to_string(t + 1) + " of " + std::to_string(folder_.tiles()) + ": " + what);
  }

  const MeshFolder& folder_;
  Stages& stages_;
};

void require_normals(const std::string& folder, const Manifest& manifest) {
  const TileStatus status = status_of(folder, manifest);
  if (status.done == status.tiles) return;
  throw InvalidInput(escape_text(folder) + ": " + std::to_string(status.tiles - status.done) + " of " + std::to_string(status.tiles) +
                     " tiles have no normals yet; g3r tiles run FOLDER makes them");
}

}  // namespace
}  // namespace g3r::tiles

namespace g3r {

std::uint64_t planned_mesh_memory(const std::string& folder) {
  return tiles::with_mesh_tiles(folder, tiles::read_manifest(folder)).plan.worker_memory;
}

MeshTiles mesh_tiles(const std::string& folder, const TileWorker& worker, const Monitor& monitor) {
  tiles::require_worker(worker);
  const tiles::Manifest manifest = tiles::read_manifest(folder);
  tiles::require_normals(folder, manifest);
  return parallel::with_threads(worker.threads, [&] {
    const gpu::Scope device(worker.device, static_cast<std::size_t>(manifest.points / manifest.tiles.size()));
    Stages stages(monitor);
    stages.begin("mesh");
    const tiles::MeshFolder opened = tiles::open_mesh_folder(folder, manifest, stages.cancel());
    tiles::MeshRun run(opened, stages);
    const auto for_own = [&](auto pass) {
      for (std::size_t t = worker.number - 1; t < opened.tiles(); t += worker.workers) (run.*pass)(t);
    };
    for_own(&tiles::MeshRun::points);
    for_own(&tiles::MeshRun::corners);
    for_own(&tiles::MeshRun::patches);
    for_own(&tiles::MeshRun::parts);
    MeshTiles out;
    out.tiles = opened.tiles();
    out.worker_memory_bytes = opened.plan.worker_memory;
    for (std::size_t t = 0; t < opened.tiles(); ++t) out.done += tiles::is_there(tiles::mesh_parts_path(folder, t)) ? 1 : 0;
    return out;
  });
}

}  // namespace g3r
