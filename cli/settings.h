// The command line: what can be asked for, and how it is read.
#pragma once

#include <g3r/g3r.h>
#include <g3r/io.h>
#include <g3r/tiles.h>
#include <g3r/view.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "text.h"

namespace g3r::cli {

enum class Command { kReconstruct, kOrient, kMesh, kEval, kSample, kInfo, kView, kTiles };
enum class TileStep { kPlan, kRun, kMesh, kStatus, kMerge };

/// Everything a command line says, with the defaults for what it does not say.
struct Settings {
  Command command = Command::kReconstruct;
  std::string input;
  std::string output;
  std::vector<std::string> also;         ///< further files for the same result
  std::string oriented;                  ///< reconstruct: file for the oriented points, empty for none
  std::string truth;                     ///< eval, view
  std::vector<std::string> shown;        ///< view: a cloud, a mesh, or both; the other commands have `input`
  std::string figures;                   ///< view: the JSON report of a run
  PageOptions page;                      ///< view
  PictureOptions picture;                ///< view
  bool sensors_of_file = false;          ///< orient, reconstruct: the hint sensor is what the input file says
  TileStep tile_step = TileStep::kPlan;  ///< tiles
  std::vector<std::string> tile_paths;   ///< tiles: inputs of the plan
  std::string tile_folder;               ///< tiles: the work folder
  std::size_t tile_count = 0;            ///< tiles
  TileWorker worker;                     ///< tiles
  bool merge_mesh = false;               ///< tiles merge: the mesh instead of the points
  Options options;
  MeshOptions mesh_options;
  ReadOptions read_options;
  WriteOptions write_options;
  std::uint64_t seed = 0;         ///< sample, eval: of the points drawn
  std::size_t sample_count = 0;   ///< sample: points to draw; eval: points per mesh
  std::vector<double> distances;  ///< eval: of the F-scores
  Length noise;                   ///< sample
  std::string report;             ///< file for the JSON report, "-" for standard output, empty for none
  bool strict = false;
  bool quiet = false;
  bool progress = true;
  int verbosity = 0;

  /// OUT and every --also.
  [[nodiscard]] std::vector<std::string> outputs() const;
};

/// Reads the command line. Empty when it asked for help or the version, which is then on standard output. Throws UsageError.
[[nodiscard]] std::optional<Settings> parse_command_line(int argc, const char* const* argv);

}  // namespace g3r::cli
