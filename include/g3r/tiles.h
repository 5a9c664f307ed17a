// Clouds of any size: normals and a mesh tile by tile, out of core, by any number of workers.
//
//   g3r::plan_tiles({"scans/"}, "work", options);   // reads, sorts, solves a thinned cloud; then the tiles are known
//   g3r::run_tiles("work", {1, 4});                 // first of four workers, in any order, at any time, anywhere
//   g3r::merge_tiles("work", "oriented.ply");       // the points in the order of the input
//   g3r::mesh_tiles("work", {1, 4});                // and, if a mesh is wanted: by four workers again
//   g3r::merge_mesh("work", "mesh.ply");
//
// The work folder holds all state. What is there is complete or absent: a process may be killed at any time, and the same call then goes
// on. The result depends on the points and the plan alone, not on workers, threads or restarts. How it works: docs/algorithms/tiles.md.
#pragma once

#include <g3r/export.h>
#include <g3r/g3r.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace G3R_PUBLIC g3r {

/// How a plan is made.
struct TileOptions {
  std::size_t max_memory = 0;   ///< bytes that a worker may take; 0: three quarters of what the machine has free and the container leaves
  std::size_t tiles = 0;        ///< their number; 0: as few as the memory allows
  Hints hints;                  ///< as of orient(), but sensor_of_point must be empty
  int threads = 0;              ///< of the sorting and the coarse solve, 0: all cores
  std::string device = "auto";  ///< see Options::device
};

/// Which tiles a call of run_tiles() does, and how.
struct TileWorker {
  std::size_t number = 1;  ///< 1..workers: tiles number, number + workers, ...
  std::size_t workers = 1;
  int threads = 0;  ///< 0: all cores
  std::string device = "auto";
};

/// What a work folder holds.
struct TileStatus {
  std::uint64_t points = 0;      ///< in the input
  std::uint64_t non_finite = 0;  ///< of them, which take no part
  std::size_t tiles = 0;
  std::size_t done = 0;
  std::uint64_t coarse_points = 0;        ///< of the thinned cloud
  std::uint64_t largest_tile = 0;         ///< points of the largest solve: its own, those around it, and the thinned ones beyond
  double work = 0;                        ///< points of all solves over the points: what tiles cost, 1 for none
  std::uint64_t worker_memory_bytes = 0;  ///< planned, of the largest tile
  std::uint64_t disk_bytes = 0;           ///< planned, of the whole folder at its fullest
  bool converged = false;                 ///< of the thinned cloud, as in Stats; the sides follow it
  bool consistent = false;
  bool doubtful = false;
  double open_share = 0;
  double undecided_share = 0;
  std::vector<std::string> warnings;
};

/// Whether orient(), or with `mesh` reconstruct(), would refuse these inputs under a limit of `max_memory` bytes and tiles may not: its
/// plan exceeds it, and the points are many enough. Of files with fewer bytes than these are points nothing is looked at; of others the
/// points are counted, which for LAS and binary PLY takes a look at the headers; text, PTX, grids and E57 are read. Throws like
/// read_cloud().
[[nodiscard]] bool needs_tiles(const std::vector<std::string>& inputs, std::size_t max_memory, bool mesh = false);

/// Reads the inputs (files, folders and patterns as of read_cloud(), regular files only) twice, sorts their points into Morton order in the
/// folder, which is made if need be, and solves every R-th of them for the sides. A folder that holds the plan of the same files and
/// options is left as it is. Takes 75 bytes of disk a point. Throws InvalidInput (too few points for
/// tiles, a folder with another plan), Unavailable (too little memory for any), IoError, Cancelled.
TileStatus plan_tiles(const std::vector<std::string>& inputs, const std::string& folder, const TileOptions& options = {},
                      const Monitor& monitor = {});

/// Solves the tiles of this worker that are not done, each in at most TileStatus::worker_memory_bytes. Throws InvalidInput (no plan, a
/// damaged one, a number that is not 1..workers), Unavailable (a device that is not there), IoError, Cancelled.
TileStatus run_tiles(const std::string& folder, const TileWorker& worker = {}, const Monitor& monitor = {});

/// What is there and what is done. Throws like run_tiles().
[[nodiscard]] TileStatus tiles_status(const std::string& folder);

/// Of all points that are finite.
struct MergedTiles {
  double confidence_mean = 0;
  double confidence_below_half = 0;   ///< share, 0..1
  std::vector<std::string> warnings;  ///< what the format cannot hold as it is: WriteOptions::warnings
};

/// Writes one binary .ply, .las or .laz, whole or not at all: for every input point, in the order of the input, its position, unit normal
/// (0 for points that are not finite), confidence, and colours and other properties as write_cloud() writes them of the same cloud; one LAS
/// or LAZ keeps its header, scale and offset as LAS or LAZ. Left out are elements of a PLY beside its points, and colours that no property
/// holds (of splats). Reads the inputs once more, once again where colours must be brought to 8 bits, and again where they become a LAS
/// with steps and fields of its own. Memory does not depend on the number of points, as far as the inputs are streams (docs/tiles.md).
/// Throws InvalidInput (tiles that are not done, inputs that have changed, another extension, points that LAS cannot hold: not finite),
/// Unavailable (LAZ in builds without it), IoError, Cancelled.
MergedTiles merge_tiles(const std::string& folder, const std::string& output, const Monitor& monitor = {});

/// Throws what merge_tiles() will throw of this output, as far as it is known from the plan, before any tile is solved: InvalidInput
/// (another extension, points that LAS cannot hold as they are not finite), Unavailable (LAZ in builds without it).
void check_merge(const std::string& folder, const std::string& output);

/// The memory in bytes that mesh_tiles() will take for its largest tile: known from the plan, before any tile is solved. Throws
/// InvalidInput (no plan, a damaged one), Unavailable (no tile of a mesh fits the memory of the plan).
[[nodiscard]] std::uint64_t planned_mesh_memory(const std::string& folder);

/// What mesh_tiles() has done and left.
struct MeshTiles {
  std::size_t tiles = 0;  ///< of the mesh: as many as of the normals, or more where its memory asks for it
  std::size_t done = 0;
  std::uint64_t worker_memory_bytes = 0;  ///< planned, of the largest tile
};

/// Meshes the tiles of this worker that are not done, once all have normals. What it needs of tiles of other workers it makes where it is
/// not there. The mesh depends on the points and the plan alone. Throws like run_tiles(), and Unavailable (no tile of the mesh fits the
/// memory of the plan).
MeshTiles mesh_tiles(const std::string& folder, const TileWorker& worker = {}, const Monitor& monitor = {});

/// What merge_mesh() has written.
struct MergedMesh {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::size_t components = 0;
  Dropped dropped;  ///< for want of support: strays, whatever the options, and components
};

/// Writes the mesh of all tiles as one binary .ply, whole or not at all: closed and 2-manifold, outward. Its memory is that of a tile and
/// those around it. Of the options the components that stay (keep_largest, min_component, keep_all) are taken, by the law of meshes in
/// core. Throws InvalidInput (tiles that are not done, no surface, another extension), Unavailable (other options, more vertices than a PLY
/// file can number), IoError, Cancelled.
MergedMesh merge_mesh(const std::string& folder, const std::string& output, const MeshOptions& options = {}, const Monitor& monitor = {});

}  // namespace g3r
