// The checks of files that come before the work, and text output.
#pragma once

#include <g3r/io.h>
#include <g3r/mesh.h>

#include <optional>
#include <string>

#include "settings.h"

namespace g3r::cli {

/// Throws what reading and writing would throw for the files of these settings, before any work: an input that cannot be opened
/// (IoError), an output or report that cannot be created or is one of the inputs, those of a folder or pattern included (IoError), an
/// unknown extension (UsageError).
void check_files(const Settings& settings);

/// Throws InvalidInput, before the work, where an output cannot hold the points as they are: LAS those that are not finite.
void check_points(const std::vector<Vec3>& points, const std::vector<std::string>& outputs);

/// The mesh in a file, or nothing; `refused` says why if the file has faces.
struct MeshIfAny {
  std::optional<Mesh> mesh;
  std::string refused;
};

/// What may hold a mesh or points: a file, a pipe or standard input, read once, or what stands for several files of points.
class Input {
 public:
  /// Throws IoError, and InvalidInput for a list that is none.
  explicit Input(std::string path);
  [[nodiscard]] MeshIfAny mesh() const;
  /// Throws like read_cloud().
  [[nodiscard]] Cloud cloud(const ReadOptions& options) const;

 private:
  std::string path_;
  std::optional<std::string> bytes_;  // of a single file
};

/// Writes text to a file, whole or not at all, or to standard output for "-". Throws IoError.
void write_text(const std::string& path, const std::string& text);

}  // namespace g3r::cli
