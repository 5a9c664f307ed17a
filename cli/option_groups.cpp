#include "option_groups.h"

#include <cstdint>
#include <vector>

#include "exit_code.h"
#include "option_kinds.h"

namespace g3r::cli {
namespace {

constexpr std::size_t kLeastMemory = std::size_t{1} << 20;  // Less is a unit that was left out: 8 for 8G.
constexpr int kMaxThreads = 4096;                           // No machine has more, so a larger number is a typing error.

// Headings of --help.
constexpr const char* kResultGroup = "Results";
constexpr const char* kMeshGroup = "Mesh";
constexpr const char* kHintGroup = "Hints (what you know and the points cannot say)";
constexpr const char* kRunGroup = "Running";
constexpr const char* kInputGroup = "Input";
constexpr const char* kMethodGroup = "Method (none of these has to be set; docs/parameters.md)";

/// A line for every device.
std::string device_list() {
  const std::vector<std::string> lines = device_lines();
  std::string text = lines.empty() ? "no device: no driver of OpenCL or CUDA was found; the processor does the work" : "";
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

}  // namespace

void add_threads_option(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kRunGroup);
  app.add_option("--threads", s.options.threads, "Threads, 0 (the default) for all cores; the result is the same for any number")
      ->check(range(0, kMaxThreads))
      ->type_name("N");
}

void add_device_option(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kRunGroup);
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
}

void add_console_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kRunGroup);
  app.add_flag("-q,--quiet", s.quiet, "Say nothing but errors");
  app.add_flag_callback(
      "--no-progress", [&s] { s.progress = false; }, "No progress bar");
  app.add_flag("-v,--verbose", s.verbosity, "Say more");
}

void add_run_options(CLI::App& app, Settings& s) {
  add_threads_option(app, s);
  add_device_option(app, s);
  add_console_options(app, s);
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
               "Gaussian splats: keep all, also faint ones, floaters and those inside, which no light from outside reaches");
  app.add_option_function<std::vector<double>>(
         "--box",
         [&s](const std::vector<double>& sides) {
           s.read_options.box = Box{{sides[0], sides[1], sides[2]}, {sides[3], sides[4], sides[5]}};
           for (std::size_t a = 0; a < 3; ++a) {
             if (!(sides[a] <= sides[a + 3])) throw UsageError("--box: expected the low corner first, X0 <= X1, Y0 <= Y1 and Z0 <= Z1");
           }
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
      ->excludes(trim);
  add_component_options(app, o);
  app.add_option("--faces", o.faces, "Simplify to about N triangles (default, or 0: off)")->check(range(std::size_t{0}))->type_name("N");
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
           if (!limit || *limit < kLeastMemory) reject("--max-memory", text, "a size such as 8G or 512M, 1M at least");
           s.options.max_memory = *limit;
         },
         help)
      ->type_name("SIZE")
      ->group(kRunGroup);
}

void add_hint_options(CLI::App& app, Settings& s) {
  app.option_defaults()->group(kHintGroup);
  Hints& hints = s.options.hints;
  app.add_option_function<std::string>(
         "--up",
         [&hints](const std::string& text) {
           hints.up = parse_direction(text);
           if (!hints.up) reject("--up", text, "X,Y,Z, not all 0, or an axis such as +z or -y");
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

}  // namespace g3r::cli
