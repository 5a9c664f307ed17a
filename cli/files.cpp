#include "files.h"

#include "base/platform.h"
#include "base/vector.h"
#include "io/ept.h"
#include "io/output_file.h"
#include "io/source.h"
#include "io/tiles.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "exit_code.h"

namespace g3r::cli {
namespace {

std::string reason() { return std::error_code(errno, std::generic_category()).message(); }

void check_input(const std::string& path) {
  if (path.empty() || path == "-") return;
  if (path.find_first_of("*?") != std::string::npos) return;  // a pattern of names, which reading looks for
  // Not by opening it: the writer of a named pipe would see its reader come and go.
  if (!platform::may_read(path)) throw IoError(IoError::Kind::kNotFound, "cannot read " + escape_text(path) + ": " + reason());
}

/// `g3r oriend scan.ply` asks for a file named oriend.
void check_not_a_command(const std::string& input) {
  if (std::all_of(input.begin(), input.end(), [](char c) { return c >= 'a' && c <= 'z'; }) && !platform::exists(input)) {
    const std::string option = input == "help" || input == "version" ? "; did you mean --" + input + "?" : "";
    throw UsageError("there is no file and no command named " + input + option);
  }
}

/// A report or a page, which check_output() cannot judge by its extension.
void check_text_output(const std::string& path, const std::vector<std::string>& others) {
  if (path.empty() || path == "-") return;
  const std::string refused = "cannot create " + escape_text(path) + ": ";
  for (const std::string& other : others) {
    if (io::same_file(path, other)) throw IoError(IoError::Kind::kCannotCreate, refused + "it is also the input or the result");
  }
  std::error_code ignored;
  if (std::filesystem::is_directory(platform::path_of(path), ignored))
    throw IoError(IoError::Kind::kCannotCreate, refused + "it is a folder");
  std::filesystem::path folder = platform::path_of(path).parent_path();
  if (folder.empty()) folder = ".";
  if (!platform::may_create_in(platform::name_of(folder))) {
    throw IoError(IoError::Kind::kCannotCreate, refused + (errno == ENOENT ? "there is no such folder" : reason()));
  }
}

void check_view_files(const Settings& settings) {
  std::vector<std::string> inputs = settings.shown;
  inputs.push_back(settings.truth);
  inputs.push_back(settings.figures);
  for (const std::string& input : inputs) check_input(input);
  std::error_code ignored;
  if (!settings.figures.empty() && !std::filesystem::is_regular_file(platform::path_of(settings.figures), ignored)) {
    throw IoError(IoError::Kind::kNotFound,
                  "cannot read " + escape_text(settings.figures) + ": --figures is the file that --report of a run has written");
  }
  check_text_output(settings.output, inputs);
}

/// A result: its extension must be one that is written, and no two files may be the same.
void check_result(const std::string& path, bool is_mesh, std::vector<std::string>& taken) {
  try {
    check_output(path, {taken.front()}, is_mesh);
  } catch (const InvalidInput& error) {
    throw UsageError(error.what());
  }
  for (const std::string& other : taken) {
    if (io::same_file(path, other)) {
      throw IoError(IoError::Kind::kCannotCreate, "cannot create " + escape_text(path) + ": it is also the input or another result");
    }
  }
  taken.push_back(path);
}

/// A folder, a pattern or a list stands for files, which a result must not be one of: the next run would take it for points.
void check_not_read(const std::vector<std::string>& results, const std::string& input) {
  if (input.empty() || input == "-" || !io::find_ept(input).empty()) return;
  for (const std::string& file : io::find_tiles(input)) {
    for (const std::string& result : results) {
      if (!io::same_file(result, file)) continue;
      throw IoError(IoError::Kind::kCannotCreate,
                    "cannot create " + escape_text(result) + ": it is one of the files that " + escape_text(input) +
                        " stands for, and would be read as points; write it elsewhere, or move it away first");
    }
  }
}

bool makes_mesh(Command command) { return command == Command::kReconstruct || command == Command::kMesh; }

}  // namespace

void check_files(const Settings& settings) {
  if (settings.command == Command::kView) return check_view_files(settings);
  if (settings.command == Command::kTiles) {
    for (const std::string& input : settings.tile_paths) check_input(input);
    if (!settings.output.empty()) check_text_output(settings.output, settings.tile_paths);
    return;
  }
  if (settings.command == Command::kReconstruct) check_not_a_command(settings.input);
  check_input(settings.input);
  check_input(settings.truth);
  std::vector<std::string> taken = {settings.input};
  for (const std::string& output : settings.outputs()) check_result(output, makes_mesh(settings.command), taken);
  if (!settings.oriented.empty()) check_result(settings.oriented, false, taken);
  check_text_output(settings.report, taken);
  taken.erase(taken.begin());
  check_not_read(taken, settings.input);
}

void check_points(const std::vector<Vec3>& points, const std::vector<std::string>& outputs) {
  const auto bad = static_cast<std::size_t>(points.end() - points.begin() - std::count_if(points.begin(), points.end(), vector::is_finite));
  for (const std::string& output : outputs) {
    const std::string format = io::extension(output);
    if (bad == 0 || (format != "las" && format != "laz")) continue;
    throw InvalidInput("cannot write " + escape_text(output) + ": LAS holds no points that are not finite, of which there are " +
                       std::to_string(bad) + "; write PLY, or leave them out");
  }
}

Input::Input(std::string path) : path_(std::move(path)) {
  if (io::find_ept(path_).empty() && io::find_tiles(path_).empty()) bytes_ = io::read_bytes(path_);
}

MeshIfAny Input::mesh() const {
  if (!bytes_) return {};
  try {
    return {read_mesh_bytes(bytes_->data(), bytes_->size(), path_), ""};
  } catch (const NoFaces&) {
    return {};
  } catch (const InvalidInput& error) {
    return {std::nullopt, error.what()};
  }
}

Cloud Input::cloud(const ReadOptions& options) const {
  return bytes_ ? read_cloud_bytes(bytes_->data(), bytes_->size(), path_, options) : read_cloud(path_, options);
}

void write_text(const std::string& path, const std::string& text) {
  if (path != "-") {
    write_file(path, text);
    return;
  }
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw IoError(IoError::Kind::kFailed, "cannot write to standard output: " + reason());
  }
}

}  // namespace g3r::cli
