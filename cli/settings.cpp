#include "settings.h"

#include "base/platform.h"
#include "io/source.h"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "command_options.h"
#include "exit_code.h"
#include "help.h"
#include "parse_errors.h"

namespace g3r::cli {
namespace {

// The points drawn from each mesh to score it, which is the number of the paper: scores with another are not those of its tables.
constexpr std::size_t kEvalSamples = 200'000;

constexpr const char* kIntroduction = R"(g3r: from an unoriented point cloud to outward normals and a watertight mesh

  g3r scan.ply                       makes the mesh scan.mesh.ply
  g3r orient scan.ply oriented.ply   keeps the points and adds their normals
  g3r view oriented.ply scan.mesh.ply -o look.html   shows both in a browser
)";

constexpr const char* kFormatHelp = R"(Reads PLY, XYZ/TXT/CSV/PTS, OBJ, OFF, PCD, NPY, LAS/LAZ, E57, PTX, SPZ, STL,
glTF/GLB, ASCII grids; the content tells which. Writes meshes as .ply .obj .stl
.off .glb, points as .ply .xyz .txt .csv .pts .pcd .npy .las .laz .obj; the
extension tells which.

)";

/// What --version says: the first line is the version alone.
std::string version_text() {
  const BuildInfo info = build_info();
  const auto listed = [](std::initializer_list<std::pair<const char*, bool>> parts) {
    std::string names;
    for (const auto& [name, there] : parts) names += there ? (names.empty() ? "" : ", ") + std::string(name) : "";
    return names.empty() ? std::string("none") : names;
  };
  return "g3r " + std::string(version()) +
         "\noptional parts: " + listed({{"LAZ", info.laz}, {"E57", info.e57}, {"screened Poisson (Open3D)", info.poisson}}) +
         "\ninstruction set: " + info.instruction_set + "\ninterfaces to GPUs: " + listed({{"OpenCL", info.opencl}, {"CUDA", info.cuda}}) +
         " (--device list: what they have)";
}

/// Without the separators at the end of a folder.
std::filesystem::path path_of_input(const std::string& input) {
  const std::size_t end = input.find_last_not_of(platform::kSeparators);
  return platform::path_of(input.substr(0, end == std::string::npos ? input.size() : end + 1));
}

/// The folder one is in, and those above it.
bool is_nameless(const std::string& input) {
  const std::filesystem::path name = path_of_input(input).filename();
  return name.empty() || name == "." || name == "..";
}

/// scan.ply -> scan.mesh.ply
std::string default_output(const std::string& input) { return platform::name_of(path_of_input(input).replace_extension(".mesh.ply")); }

Command parsed_command(const CLI::App& app) {
  const std::map<std::string, Command> commands = {{"orient", Command::kOrient}, {"mesh", Command::kMesh}, {"eval", Command::kEval},
                                                   {"sample", Command::kSample}, {"info", Command::kInfo}, {"view", Command::kView},
                                                   {"tiles", Command::kTiles}};
  const auto parsed = app.get_subcommands();
  return parsed.empty() ? Command::kReconstruct : commands.at(parsed.front()->get_name());
}

/// What CLI11 cannot check: rules over several arguments.
void complete(const CLI::App& app, Settings& s) {
  s.command = parsed_command(app);
  s.read_options.threads = s.options.threads;
  if (s.command == Command::kReconstruct) {
    if (s.input.empty()) throw UsageError("expected a point cloud");
    if (s.output.empty() && s.input == "-") throw UsageError("standard input has no name to derive OUT from: give OUT");
    if (s.output.empty() && s.input.find_first_of("*?") != std::string::npos)
      throw UsageError("a pattern has no name to derive OUT from: give OUT");
    if (s.output.empty() && is_nameless(s.input)) throw UsageError("'" + s.input + "' has no name to derive OUT from: give OUT");
    if (s.output.empty()) s.output = default_output(s.input);
  } else if (app.count("IN") > 0) {
    throw UsageError("expected the command '" + app.get_subcommands().front()->get_name() + "' before its files");
  }
  if (s.command == Command::kView) {
    const std::string extension = io::extension(s.output);
    if (s.output != "-" && extension != "html" && extension != "htm" && extension != "png") {
      throw UsageError("unknown extension '" + extension + "' of " + s.output + ": view writes .html or .png");
    }
    const CLI::App& view = *app.get_subcommands().front();
    const bool picture = extension == "png";
    for (const char* option : {"--layers", "--tile", "--views", "--dark"}) {
      if (!picture && view.count(option) > 0) throw UsageError(std::string(option) + " is for pictures (.png), not for pages");
    }
    if (picture && view.count("--figures") > 0) throw UsageError("--figures is for pages (.html), not for pictures");
  }
  if (s.command == Command::kTiles && s.tile_step == TileStep::kPlan) {
    s.tile_folder = s.tile_paths.back();
    s.tile_paths.pop_back();
    if (s.sensors_of_file) throw UsageError("--sensor: expected X,Y,Z, found 'file', which tiles do not support");
  }
  if (s.sensors_of_file && !s.options.hints.sensors.empty()) {
    throw UsageError("--sensor: places and file exclude each other");
  }
  if (s.command == Command::kEval && s.sample_count == 0) s.sample_count = kEvalSamples;
  std::vector<std::string> written = s.outputs();
  written.push_back(s.oriented);
  written.push_back(s.report);
  if (std::count(written.begin(), written.end(), "-") > 1) throw UsageError("only one result can go to standard output");
}

/// Flags take no value: --quiet=no would be quiet.
void refuse_values_of_flags(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 0) option->disable_flag_override();
  }
  for (CLI::App* command : app.get_subcommands({})) refuse_values_of_flags(*command);
}

/// The library knows the grammar of --schedule and --harmonics; the plan of a tetrahedron tells before any file is read.
void check_options(const Options& options) {
  const std::vector<Vec3> tetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Options probe = options;
  probe.max_memory = 0;
  try {
    (void)plan(tetrahedron, probe);
  } catch (const InvalidInput& error) {
    throw UsageError(error.what());
  }
}

}  // namespace

std::vector<std::string> Settings::outputs() const {
  std::vector<std::string> all = also;
  if (!output.empty()) all.insert(all.begin(), output);
  return all;
}

std::optional<Settings> parse_command_line(int argc, const char* const* argv) {
  Settings settings;
  CLI::App app(kIntroduction, "g3r");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", version_text, "Print the version, what this build has and what it runs on, and exit");
  app.set_help_flag("-h,--help", "Print this text and exit");
  app.footer(std::string(kFormatHelp) + kExitCodeHelp);
  app.allow_windows_style_options(false);  // there /folder/file would be options
  app.require_subcommand(0, 1);
  add_commands(app, settings);
  refuse_values_of_flags(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {
    app.exit(request, std::cout, std::cout);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw UsageError(about_parse_error(app, error), named_command(app));
  } catch (const UsageError& error) {
    throw UsageError(error.what(), named_command(app));
  }
  try {
    complete(app, settings);
    check_options(settings.options);
  } catch (const UsageError& error) {
    throw UsageError(error.what(), named_command(app));
  }
  return settings;
}

}  // namespace g3r::cli
