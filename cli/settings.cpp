#include "settings.h"

#include "base/platform.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <sstream>
#include <type_traits>
#include <utility>
#include <vector>

#include <g3r/names.h>
#include <CLI/CLI.hpp>

#include "exit_code.h"
#include "help.h"
#include "text.h"

namespace g3r::cli {
namespace {

constexpr int kMaxThreads = 4096;  // No machine has more, so a larger number is a typing error.
// The most points that can be drawn from a mesh: more need not fit into memory, so a larger number is most likely a typing error.
constexpr std::size_t kMaxSamples = 1'000'000'000;
// The points drawn from each mesh to score it, which is the number of the paper: scores with another are not those of its tables.
constexpr std::size_t kEvalSamples = 200'000;

/// A number of type T from `low` to `high`. It says what it expects, and leaves the help text alone: the descriptions say the range.
template <class T>
CLI::Validator range(T low, T high = std::numeric_limits<T>::max()) {
  const auto check = [low, high](const std::string& text) -> std::string {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && value >= low && value <= high) return {};
    const auto number = [](T bound) { return short_number(static_cast<double>(bound), 10); };
    const std::string bounds =
        high == std::numeric_limits<T>::max() ? number(low) + " or more" : "from " + number(low) + " to " + number(high);
    return std::string("expected a ") + (std::is_integral_v<T> ? "whole number, " : "number, ") + bounds + ", found '" + text + "'";
  };
  return {check, ""};
}

// Headings of --help.
constexpr const char* kResultGroup = "Results";
constexpr const char* kMeshGroup = "Mesh";
constexpr const char* kHintGroup = "Hints (what you know and the points cannot say)";
constexpr const char* kRunGroup = "Running";
constexpr const char* kInputGroup = "Input";
constexpr const char* kMethodGroup = "Method (none of these has to be set; docs/parameters.md)";
constexpr const char* kPageGroup = "Page and picture";
constexpr const char* kCommandGroup = "Commands";

constexpr const char* kIntroduction = R"(g3r: from an unoriented point cloud to outward normals and a watertight mesh

  g3r scan.ply                       makes the mesh scan.mesh.ply
  g3r orient scan.ply oriented.ply   keeps the points and adds their normals
  g3r view oriented.ply scan.mesh.ply -o look.html   shows both in a browser
)";

constexpr const char* kFormatHelp = R"(Reads PLY, XYZ/TXT/CSV/PTS, OBJ, OFF, PCD, NPY, LAS/LAZ, E57, PTX, SPZ, STL,
glTF/GLB; the content tells which. Writes meshes as .ply .obj .stl .off .glb,
points as .ply .xyz .txt .csv .pts .pcd .npy .las .laz .obj; the extension
tells which.

)";

[[noreturn]] void reject(const std::string& option, const std::string& text, const std::string& expected) {
  throw UsageError(option + ": expected " + expected + ", found '" + text + "'");
}

/// An option whose value is one of a few words: g3r/names.h.
template <class T>
void add_choice(CLI::App& app, const std::string& name, T& target, const std::string& help) {
  app.add_option_function<std::string>(
         name,
         [&target, name](const std::string& text) {
           const std::optional<T> value = parse<T>(text);
           if (!value) reject(name, text, "one of " + words<T>());
           target = *value;
         },
         help)
      ->type_name("NAME");
}

/// A line for every device.
std::string device_list() {
  const std::vector<std::string> lines = device_lines();
  std::string text = lines.empty() ? "no device: no driver of OpenCL or CUDA was found; the processor does the work" : "";
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

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

void add_run_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kRunGroup);
  app.add_option("--threads", s.options.threads, "Threads, 0 (the default) for all cores; the result is the same for any number")
      ->check(range(0, kMaxThreads))
      ->type_name("N");
  app.add_option_function<std::string>(
         "--device",
         [&s](const std::string& text) {
           if (text == "list") throw CLI::CallForVersion(device_list(), 0);  // text on standard output, and the end
           const bool numbered = text.rfind("gpu:", 0) == 0 && text.size() > 4 && text.find_first_not_of("0123456789", 4) == text.npos;
           if (!numbered && text != "auto" && text != "cpu" && text != "gpu") reject("--device", text, "auto, cpu, gpu, gpu:N or list");
           s.options.device = s.mesh_options.device = text;
         },
         "Where the sums run: cpu, gpu, gpu:N; auto (the default): a GPU if there is one, for many points; list: what there is")
      ->type_name("NAME");
  app.add_flag("-q,--quiet", s.quiet, "Say nothing but errors");
  app.add_flag_callback(
         "--no-progress", [&s] { s.progress = false; }, "No progress bar")
      ->disable_flag_override();
  app.add_flag("-v,--verbose", s.verbosity, "Say more");
}

void add_report_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kResultGroup);
  app.add_option("--report", s.report, "Write what was done as JSON (docs/report.md); - for standard output")->type_name("FILE");
  app.add_flag("--strict", s.strict,
               "Exit with 65 when the result is doubtful: not converged, sides inconsistent, a mesh that the points cannot carry, or one "
               "not closed that was not trimmed");
}

void add_seed_option(CLI::App& app, Settings& s) {
  app.add_option("--seed", s.seed, "Another number draws other points (default 0)")
      ->check(range(std::uint64_t{0}))
      ->type_name("S")
      ->group(kRunGroup);
}

void add_read_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kInputGroup);
  app.add_option("--min-opacity", s.read_options.min_opacity, "Gaussian splats: leave out those below this opacity, 0 to 1 (default 0.1)")
      ->check(range(0.0, 1.0))
      ->type_name("X");
  app.add_flag("--all-splats", s.read_options.all_splats,
               "Gaussian splats: keep all, also faint ones, floaters and those inside, which no light from outside reaches")
      ->disable_flag_override();
  app.add_option_function<std::vector<double>>(
         "--box",
         [&s](const std::vector<double>& sides) {
           s.read_options.box = Box{{sides[0], sides[1], sides[2]}, {sides[3], sides[4], sides[5]}};
         },
         "Leave out points outside of this box, in the coordinates of the file")
      ->delimiter(',')
      ->expected(6)
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
  app.add_option("--levels", s.read_options.levels, "COPC, EPT: levels of the octree to read, from the coarsest (default all)")
      ->check(range(1))
      ->type_name("N");
}

void add_write_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kResultGroup);
  app.add_flag("--ascii", s.write_options.ascii, "Text instead of binary where the format has both (PLY, PCD, STL)");
}

void add_confidence_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kResultGroup);
  app.add_flag("--cloud-compare-names", s.write_options.cloud_compare_names,
               "Points: name the confidence so that CloudCompare shows it at once");
}

void add_also_option(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kResultGroup);
  app.add_option("--also", s.also, "Write the result to FILE too, in the format of its extension; may be repeated")
      ->type_name("FILE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
}

void add_mesh_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kMeshGroup);
  add_choice(app, "--mesher", s.mesh_options.mesher,
             "field: contours the winding field; poisson: screened Poisson, in builds with Open3D; auto: the preset's");
  app.add_option("--depth", s.mesh_options.depth, "Octree depth of the mesher, 4 to 12 (default: from the density of the points)")
      ->check(range(kLeastMeshDepth, kMostMeshDepth))
      ->type_name("D");
}

void add_component_options(CLI::App& app, MeshOptions& o) {
  app.add_option("--keep-largest", o.keep_largest, "Keep only the N largest components (default, or 0: all)")
      ->check(range(std::size_t{0}))
      ->type_name("N");
  app.add_option("--min-component", o.min_component,
                 "Drop components of less area than N points stand for (default 8, more under noise; 0 keeps all)")
      ->check(range(0.0, 1e15))
      ->type_name("N");
  app.add_flag("--keep-all", o.keep_all, "Keep what too few points hold: spurious components, and points that no surface goes through");
}

void add_finish_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kMeshGroup);
  MeshOptions& o = s.mesh_options;
  CLI::Option* trim = app.add_option_function<std::string>(
                             "--trim",
                             [&o](const std::string& text) {
                               const auto distance = parse_length(text);
                               if (text == "off" || text == "auto") {
                                 o.trim = text == "off" ? MeshOptions::Trim::kOff : MeshOptions::Trim::kAuto;
                               } else if (distance && distance->unit == Length::Unit::kInput && distance->value > 0) {
                                 o.trim = MeshOptions::Trim::kDistance;
                                 o.trim_distance = distance->value;
                               } else {
                                 reject("--trim", text, "off, auto or a distance above 0");
                               }
                             },
                             "Cut away surface that is farther than X (input units) from every point; auto: 4 spacings; off is the default")
                          ->type_name("off|auto|X");
  app.add_flag_callback(
         "--open", [&o] { o.trim = MeshOptions::Trim::kAuto; }, "For open scans: the same as --trim auto")
      ->disable_flag_override()
      ->excludes(trim);
  add_component_options(app, o);
  app.add_option("--faces", o.faces, "Simplify to about N triangles (default, or 0: off)")->check(range(std::size_t{0}))->type_name("N");
}

void add_length(CLI::App& app, const std::string& name, Length& into, bool may_be_zero, const std::string& help) {
  app.add_option_function<std::string>(
         name,
         [&into, name, may_be_zero](const std::string& text) {
           const auto length = parse_length(text);
           const bool good = length && (length->value > 0 || may_be_zero || length->unit == Length::Unit::kAuto);
           if (!good) reject(name, text, "auto, X, X%, Xh or Xn with X " + std::string(may_be_zero ? ">= 0" : "> 0"));
           into = *length;
         },
         help)
      ->type_name("auto|X[%|h|n]");
}

void add_method_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kMethodGroup);
  Options& o = s.options;
  add_choice(app, "--preset", o.preset, "default, or paper: the published method");
  add_choice(app, "--method", o.method,
             "Equations to solve: energy, green (as published), auto: the preset's; wnnc, agr, pgr: earlier methods, to compare with");
  app.add_option("--wnnc-widths", o.wnnc_widths,
                 "Method wnnc: its widths; density (default), clean, scan, noise-0.25, noise-0.5, noise-1 or sparse")
      ->type_name("NAME");
  add_length(app, "--epsilon", o.epsilon, false,
             "Width of the smoothing: X input units, X% of the box diagonal, Xh point spacings, Xn in the paper's unit box");
  add_length(app, "--noise", o.noise, true,
             "Standard deviation of the points from their surface, in the units of --epsilon; 0: clean (default: estimated)");
  CLI::Option* degree = app.add_option("--degree", o.degree, "Method green: highest degree of the harmonic polynomials, 0 to 8")
                            ->check(range(0, kMostDegree))
                            ->type_name("L");
  app.add_option("--harmonics", o.harmonics, "Method green, instead of --degree: \"1,x,y,z\" or \"degree:0-2\"")
      ->excludes(degree)
      ->type_name("LIST");
  add_choice(app, "--solver", o.solver, "auto, dense (O(N^2) memory) or cg");
  app.add_option("--schedule", o.schedule, "Iterations, for example \"20 sd 60 cg\": steepest descent, conjugate gradients")
      ->type_name("LIST");
  app.add_option("--tolerance", o.tolerance, "Stop when the relative residual falls below T; 0: run all iterations")
      ->check(range(0.0, 1.0))
      ->type_name("T");
  app.add_option("--accuracy", o.accuracy, "Relative error of the sums, 1e-6 to 0.1; 0: direct sums, O(N^2) time")
      ->check(range(0.0, 0.1))
      ->type_name("A");
  app.add_flag("--condition-number", o.condition_number, "With --solver dense: report the condition number");
}

void add_memory_option(CLI::App& app, Settings& s, const std::string& help) {
  app.add_option_function<std::string>(
         "--max-memory",
         [&s](const std::string& text) {
           const auto limit = parse_bytes(text);
           if (!limit) reject("--max-memory", text, "a size such as 8G or 512M");
           s.options.max_memory = *limit;
         },
         help)
      ->type_name("SIZE")
      ->group(kRunGroup);
}

constexpr const char* kTilesHelp =
    "If it would need more, for example 8G: work in tiles, on disk beside OUT (.ply; orient: .las, .laz too), or refuse";
constexpr const char* kRefuseHelp = "Refuse before the solve if it would need more, for example 8G";

/// An option that may be repeated and is handed to `take` word by word.
void add_repeated(CLI::App& app, const std::string& name, const std::function<void(const std::string&)>& take, const std::string& type,
                  const std::string& help) {
  app.add_option_function<std::vector<std::string>>(
         name,
         [take](const std::vector<std::string>& words) {
           for (const std::string& word : words) take(word);
         },
         help)
      ->type_name(type)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
}

void add_hint_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kHintGroup);
  Hints& hints = s.options.hints;
  app.add_option_function<std::string>(
         "--up",
         [&hints](const std::string& text) {
           hints.up = parse_direction(text);
           if (!hints.up) reject("--up", text, "X,Y,Z, or an axis such as +z or -y");
         },
         "Open surfaces face this way: a direction, or an axis such as +z or -y")
      ->type_name("X,Y,Z");
  const auto take_sensor = [&s, &hints](const std::string& text) {
    if (text == "file") {
      s.sensors_of_file = true;
    } else if (const auto place = parse_vector(text)) {
      hints.sensors.push_back(*place);
    } else {
      reject("--sensor", text, "X,Y,Z, or file");
    }
  };
  add_repeated(app, "--sensor", take_sensor, "X,Y,Z|file",
               "Open surfaces face the scanner, which stood here; may be repeated. file: where IN says that it stood (PCD, E57, PTX)");
  const auto take_inside = [&hints](const std::string& text) {
    const auto place = parse_vector(text);
    if (!place) reject("--inside", text, "X,Y,Z");
    hints.inside.push_back(*place);
  };
  add_repeated(app, "--inside", take_inside, "X,Y,Z", "A point inside the solid; may be repeated");
  app.add_flag("--seen-from-inside", hints.seen_from_inside, "Rooms, tunnels, streets: normals face the side the scanner was on");
  app.add_flag("--flip", hints.flip, "Turn every normal, after all other hints");
}

void add_reconstruct(CLI::App& app, Settings& s) {
  app.add_option("IN", s.input, "Point cloud; - for standard input")->type_name("");
  app.add_option("OUT", s.output, "Mesh; scan.mesh.ply for scan.ply if left out; - for standard output")->type_name("");
  add_also_option(app, s);
  app.add_option("--oriented", s.oriented, "Write the points with their normals and confidence too")->type_name("FILE");
  add_write_options(app, s);
  add_confidence_options(app, s);
  add_report_options(app, s);
  add_hint_options(app, s);
  add_finish_options(app, s);
  add_mesh_options(app, s);
  add_run_options(app, s);
  add_read_options(app, s);
  add_method_options(app, s);
  add_memory_option(app, s, kTilesHelp);
}

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& help) {
  CLI::App* command = app.add_subcommand(name, help);
  command->group(kCommandGroup)->footer("Formats and exit codes: g3r --help\n");
  command->option_defaults()->group("Options");  // not the parent's latest
  return command;
}

void add_orient(CLI::App& app, Settings& s) {
  CLI::App* sub = add_command(app, "orient", "Same points, same order, all properties kept, plus unit normals and confidence");
  sub->add_option("IN", s.input, "Point cloud; - for standard input")->required()->type_name("");
  sub->add_option("OUT", s.output, "Oriented cloud; - for standard output")->required()->type_name("");
  add_also_option(*sub, s);
  add_write_options(*sub, s);
  add_confidence_options(*sub, s);
  add_report_options(*sub, s);
  add_hint_options(*sub, s);
  add_run_options(*sub, s);
  add_read_options(*sub, s);
  add_method_options(*sub, s);
  add_memory_option(*sub, s, kTilesHelp);
}

void add_mesh(CLI::App& app, Settings& s) {
  CLI::App* sub = add_command(app, "mesh", "Points that have outward normals -> mesh");
  sub->add_option("ORIENTED", s.input, "Point cloud with normals; - for standard input")->required()->type_name("");
  sub->add_option("OUT", s.output, "Mesh; - for standard output")->required()->type_name("");
  add_also_option(*sub, s);
  add_write_options(*sub, s);
  add_report_options(*sub, s);
  add_finish_options(*sub, s);
  add_mesh_options(*sub, s);
  add_length(*sub, "--noise", s.mesh_options.noise, true,
             "Standard deviation of the points from their surface: X input units, X% of the box diagonal, Xh point spacings; 0: clean "
             "(default: estimated)");
  add_run_options(*sub, s);
  add_read_options(*sub, s);
}

void add_eval(CLI::App& app, Settings& s) {
  CLI::App* sub = add_command(app, "eval", "Scores against the truth, as JSON: of normals AE, PCO, RMSE; of meshes CD, HD, F");
  sub->add_option("RESULT", s.input, "Oriented cloud or mesh")->required()->type_name("");
  sub->add_option("--truth", s.truth, "Cloud with true normals in the same order, or true mesh")->required()->type_name("GT");
  sub->add_option("--samples", s.sample_count, "Points sampled on each mesh (default 200000)")
      ->check(range(std::size_t{1}, kMaxSamples))
      ->type_name("N");
  sub->add_option_function<std::string>(
         "--distances",
         [&s](const std::string& text) {
           std::istringstream words(text);
           for (std::string word; std::getline(words, word, ',');) {
             const auto distance = parse_length(word);
             if (!distance || distance->unit != Length::Unit::kInput || !(distance->value > 0))
               reject("--distances", text, "X,X,... above 0");
             s.distances.push_back(distance->value);
           }
         },
         "Meshes: also the F-scores at these distances, in units of the mesh")
      ->type_name("X,X,...");
  add_seed_option(*sub, s);
  add_run_options(*sub, s);
}

void add_sample(CLI::App& app, Settings& s) {
  CLI::App* sub = add_command(app, "sample", "Points on a mesh, uniform by area, with true normals");
  sub->add_option("MESH", s.input, "Mesh")->required()->type_name("");
  sub->add_option("OUT", s.output, "Point cloud; - for standard output")->required()->type_name("");
  sub->add_option("--count", s.sample_count, "Points to draw")->required()->check(range(std::size_t{1}, kMaxSamples))->type_name("N");
  sub->add_option_function<std::string>(
         "--noise",
         [&s](const std::string& text) {
           const auto noise = parse_length(text);
           const bool known = noise && (noise->unit == Length::Unit::kInput || noise->unit == Length::Unit::kPercent);
           if (!known) reject("--noise", text, "X or X% with X >= 0");
           s.noise = *noise;
         },
         "Standard deviation of Gaussian noise: X (mesh units) or X% (of the box diagonal)")
      ->type_name("X[%]");
  add_seed_option(*sub, s);
  add_write_options(*sub, s);
  add_run_options(*sub, s);
}

void add_info(CLI::App& app, Settings& s) {
  CLI::App* sub = add_command(app, "info", "What is in a file, what g3r would do with it, and the memory that would take");
  sub->add_option("FILE", s.input, "Point cloud or mesh")->required()->type_name("");
  add_run_options(*sub, s);
  sub->add_option("--report", s.report, "Write the plan as JSON; - for standard output, instead of the text")->type_name("FILE");
  add_read_options(*sub, s);
  add_method_options(*sub, s);
  add_memory_option(*sub, s, kRefuseHelp);
  add_mesh_options(*sub, s);
}

const std::map<std::string, Layer> kLayers = {{"points", Layer::kPoints}, {"normals", Layer::kNormals}, {"confidence", Layer::kConfidence},
                                              {"colors", Layer::kColors}, {"error", Layer::kError},     {"mesh", Layer::kMesh}};

CLI::App* add_tile_step(CLI::App& tiles, Settings& s, const std::string& name, TileStep step, const std::string& help) {
  CLI::App* sub = tiles.add_subcommand(name, help);
  sub->option_defaults()->group("Options");
  sub->parse_complete_callback([&s, step] { s.tile_step = step; });
  return sub;
}

void add_tiles(CLI::App& app, Settings& s) {
  CLI::App* sub =
      add_command(app, "tiles", "Normals and meshes of clouds of any size: plan, run and mesh (by many workers), status, merge");
  sub->require_subcommand(1);
  CLI::App* plan = add_tile_step(*sub, s, "plan", TileStep::kPlan, "Sort the points into the folder DIR, solve a thinned cloud, cut tiles");
  plan->add_option("IN", s.tile_paths, "Clouds, folders or patterns, and last the work folder DIR")
      ->required()
      ->expected(2, 1 << 20)
      ->type_name("");
  plan->add_option("--tiles", s.tile_count, "Number of tiles (default: as few as the memory allows)")
      ->check(range(std::size_t{1}, std::size_t{1000000}))
      ->type_name("N");
  add_hint_options(*plan, s);
  add_run_options(*plan, s);
  add_memory_option(*plan, s, "What a worker may take, for example 6G (default: three quarters of what is free)");
  CLI::App* run = add_tile_step(*sub, s, "run", TileStep::kRun, "Solve the tiles that are not done");
  CLI::App* mesh = add_tile_step(*sub, s, "mesh", TileStep::kMesh, "Mesh the tiles that are not meshed, once all have normals");
  for (CLI::App* step : {run, mesh}) {
    step->add_option_function<std::string>(
            "--worker",
            [&s](const std::string& text) {
              const auto worker = parse_worker(text);
              if (!worker) reject("--worker", text, "I/N, of workers 1/N to N/N");
              s.worker = *worker;
            },
            "This is worker I of N: does tiles I, I + N, ...")
        ->type_name("I/N");
    add_run_options(*step, s);
  }
  CLI::App* status = add_tile_step(*sub, s, "status", TileStep::kStatus, "What is planned and what is done");
  CLI::App* merge =
      add_tile_step(*sub, s, "merge", TileStep::kMerge, "Write all points in their order with normals and confidence, or the mesh");
  for (CLI::App* step : {run, mesh, status, merge}) step->add_option("DIR", s.tile_folder, "The work folder")->required()->type_name("");
  merge->add_option("OUT", s.output, "Oriented cloud (.ply, .las, .laz), or mesh (.ply)")->required()->type_name("");
  CLI::Option* mesh_flag = merge->add_flag("--mesh", s.merge_mesh, "Write the mesh instead of the points")->disable_flag_override();
  add_component_options(*merge, s.mesh_options);
  for (const char* name : {"--keep-largest", "--min-component", "--keep-all"}) merge->get_option(name)->needs(mesh_flag);
  add_run_options(*merge, s);
}

void add_view(CLI::App& app, Settings& s) {
  CLI::App* sub = add_command(app, "view", "A page (.html) or a picture (.png) of a cloud, a mesh, or both");
  sub->add_option("IN", s.shown, "Cloud, mesh, or one of each")->required()->expected(1, 2)->type_name("");
  sub->add_option("-o,--out", s.output, "Page .html or picture .png; - for the page on standard output")->required()->type_name("OUT");
  sub->option_defaults()->group(kPageGroup);
  sub->add_option("--truth", s.truth, "Cloud with true normals in the same order: adds the map of errors")->type_name("GT");
  sub->add_option("--figures", s.figures, "Page: report of the run, to show beside the view")->type_name("FILE.json");
  sub->add_flag_callback(
         "--z-up", [&s] { s.page.up = s.picture.up = Up::kZ; }, "The z axis points up instead of the y axis")
      ->disable_flag_override();
  sub->add_option_function<std::vector<std::string>>(
         "--layers",
         [&s](const std::vector<std::string>& names) {
           for (const std::string& name : names) {
             const auto layer = kLayers.find(name);
             if (layer == kLayers.end()) reject("--layers", name, "points, normals, confidence, colors, error or mesh");
             s.picture.layers.push_back(layer->second);
           }
         },
         "Picture: a row each, of points,normals,confidence,colors,error,mesh")
      ->delimiter(',')
      ->type_name("LIST");
  sub->add_option("--tile", s.picture.tile, "Picture: side of one view, 16 to 2048")->check(range(16, 2048))->type_name("PIXELS");
  sub->add_option("--views", s.picture.views,
                  "Picture: the first N of three-quarter, front, side and top; with one the layers stand side by side")
      ->check(range(1, 4))
      ->type_name("N");
  sub->add_flag("--dark", s.picture.dark, "Picture: dark background");
  add_read_options(*sub, s);
  add_run_options(*sub, s);
}

/// scan.ply -> scan.mesh.ply
std::string default_output(const std::string& input) {
  const std::size_t end = input.find_last_not_of(platform::kSeparators);  // of a folder
  std::filesystem::path path = platform::path_of(input.substr(0, end == std::string::npos ? input.size() : end + 1));
  return platform::name_of(path.replace_extension(".mesh.ply"));
}

Command parsed_command(const CLI::App& app) {
  const std::map<std::string, Command> commands = {{"orient", Command::kOrient}, {"mesh", Command::kMesh}, {"eval", Command::kEval},
                                                   {"sample", Command::kSample}, {"info", Command::kInfo}, {"view", Command::kView},
                                                   {"tiles", Command::kTiles}};
  const auto parsed = app.get_subcommands();
  return parsed.empty() ? Command::kReconstruct : commands.at(parsed.front()->get_name());
}

/// Letters to change, add or leave out to get from one word to the other (Levenshtein 1966). O(|a| |b|).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// "; did you mean WORD?" if one of the words is near, else nothing.
std::string suggestion(const std::string& found, const std::vector<std::string>& words) {
  constexpr std::size_t kNear = 2;  // Two letters are a slip; with more, words that mean something else are near.
  std::string nearest;
  std::size_t least = kNear + 1;
  for (const std::string& word : words) {
    const std::size_t distance = edit_distance(found, word);
    if (distance < std::min(least, word.size() - 1)) {
      least = distance;
      nearest = word;
    }
  }
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

/// The first argument that nothing takes, and what could have been meant.
std::string about_extras(const CLI::App& app) {
  const std::string first = app.remaining(true).front();
  const auto parsed = app.get_subcommands();
  const CLI::App& command = parsed.empty() ? app : *parsed.front();
  if (first == "-o" || first == "--out" || first == "--output")
    return "unknown option " + first + ": the output stands after the input, without an option";
  if (first.size() > 1 && first.front() == '-') {
    std::vector<std::string> options;
    for (const CLI::Option* option : command.get_options()) {
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    }
    return "unknown option " + first + suggestion(first.substr(0, first.find('=')), options);
  }
  if (!parsed.empty()) return "one file too many for g3r " + command.get_name() + ": " + first;
  std::vector<std::string> names;
  std::string list;
  for (const CLI::App* other : app.get_subcommands({})) {
    names.push_back(other->get_name());
    list += (list.empty() ? "" : ", ") + other->get_name();
  }
  const std::string meant = suggestion(app.get_option("IN")->as<std::string>(), names);
  return "one file too many: " + first + "; expected IN and OUT, or one of the commands " + list + " first" + meant;
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
    if (s.output.empty()) s.output = default_output(s.input);
  } else if (app.count("IN") > 0) {
    throw UsageError("expected the command '" + app.get_subcommands().front()->get_name() + "' before its files");
  }
  if (s.command == Command::kView) {
    const std::string extension = platform::name_of(platform::path_of(s.output).extension());
    if (s.output != "-" && extension != ".html" && extension != ".htm" && extension != ".png") {
      throw UsageError("unknown extension '" + extension + "' of " + s.output + ": view writes .html or .png");
    }
    const CLI::App& view = *app.get_subcommands().front();
    const bool picture = extension == ".png";
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
  add_reconstruct(app, settings);
  add_orient(app, settings);
  add_mesh(app, settings);
  add_eval(app, settings);
  add_sample(app, settings);
  add_info(app, settings);
  add_view(app, settings);
  add_tiles(app, settings);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {
    app.exit(request, std::cout, std::cout);
    return std::nullopt;
  } catch (const CLI::ExtrasError&) {
    throw UsageError(about_extras(app));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  complete(app, settings);
  check_options(settings.options);
  return settings;
}

}  // namespace g3r::cli
