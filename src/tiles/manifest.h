// The plan of a work folder: what was read, what is where, which tiles there are. manifest.json is written last, so where it is all is.
#pragma once

#include "cloud/canonical_cloud.h"
#include "tiles/cells.h"

#include <g3r/io.h>
#include <g3r/tiles.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

/// The largest side that the box of all points may have in the unit frame; scale_for() makes it this to half of this.
inline constexpr double kLongestSide = kBoxSide;

/// A file of points.
struct Input {
  std::string path;
  std::uint64_t bytes = 0;
  std::uint64_t points = 0;
  std::uint64_t hash = 0;  ///< of its points in their order: point_hash()
  bool operator==(const Input&) const = default;
};

/// Consecutive cells, whose points it solves for.
struct Tile {
  std::uint64_t first_cell = 0;
  std::uint64_t last_cell = 0;  ///< one past the last
  std::uint64_t own = 0;        ///< points in them
  std::uint64_t solved = 0;     ///< points of its solve
  bool operator==(const Tile&) const = default;
};

/// What manifest.json says.
struct Manifest {
  std::string asked;  ///< options of the plan, as text
  std::vector<Input> inputs;
  std::uint64_t points = 0;      ///< of all inputs
  std::uint64_t non_finite = 0;  ///< of them
  Box bounds;                    ///< of the finite points
  Frame frame;
  int level = 0;             ///< of the cells
  std::uint64_t stride = 1;  ///< every stride-th point is in the thinned cloud
  std::uint64_t coarse_points = 0;
  double coarse_spacing = 0;  ///< typical, of the thinned cloud, in the units of the inputs
  std::vector<Tile> tiles;
  std::uint64_t limit = 0;  ///< bytes that a worker may take
  std::uint64_t worker_memory = 0;
  std::uint64_t disk = 0;
  bool converged = false;  ///< of the thinned cloud, as the next four
  bool consistent = false;
  bool doubtful = false;
  double open_share = 0;
  double undecided_share = 0;
  std::vector<std::string> warnings;

  [[nodiscard]] std::uint64_t sorted() const { return points - non_finite; }
};

/// Strides of the files of points: 1, 4, 16, ..., stride, that of the thinned cloud, and on by factors of 4 as far as 1000 of `points` are
/// left. A ring takes its points from the file of its number.
[[nodiscard]] std::vector<std::uint64_t> strides(std::uint64_t stride, std::uint64_t points);

/// Names of files in a folder.
[[nodiscard]] std::string manifest_path(const std::string& folder);
[[nodiscard]] std::string cells_path(const std::string& folder);
[[nodiscard]] std::string points_path(const std::string& folder, std::uint64_t stride);
[[nodiscard]] std::string coarse_path(const std::string& folder);
[[nodiscard]] std::string result_path(const std::string& folder, std::size_t tile);

/// Whether a path is UTF-8, as the manifest has to be.
[[nodiscard]] bool can_be_stored(const std::string& path);
/// Whether a folder holds a plan, sound or not.
[[nodiscard]] bool has_manifest(const std::string& folder);
/// Throws IoError.
void write_manifest(const std::string& folder, const Manifest& manifest);
/// Throws InvalidInput: no manifest, a damaged one, one of another version, or files that do not go with it.
[[nodiscard]] Manifest read_manifest(const std::string& folder);
/// Throws InvalidInput where the file is not that of the manifest, IoError.
[[nodiscard]] Cells read_cells(const std::string& folder, const Manifest& manifest);

/// Throws InvalidInput unless the worker is one of 1 to workers, with a number of threads.
void require_worker(const TileWorker& worker);

/// Throws IoError where the output is an input of the plan, which would be gone before it was read.
void require_no_input(const Manifest& manifest, const std::string& output);

/// Removes what plans, their tiles and meshes leave, so that a new plan takes none of it for its own. Other files stay. manifest.json goes
/// first, so that the rest is no plan wherever this ends. Throws IoError.
void clear_folder(const std::string& folder);
/// The same, and the folder if there is nothing else in it. Does what can be done, and throws nothing.
void remove_plan(const std::string& folder);

/// Tiles of nearly equal numbers of points, cut between cells.
[[nodiscard]] std::vector<Tile> cut(const Cells& cells, std::size_t count);

/// Whether the result of a tile is there, as long as it is to be. What is in it merge_tiles() looks at.
[[nodiscard]] bool is_done(const std::string& folder, const Manifest& manifest, std::size_t tile);
/// Of a plan and its results so far, of which only the sizes are looked at.
[[nodiscard]] TileStatus status_of(const std::string& folder, const Manifest& manifest);

}  // namespace g3r::tiles
