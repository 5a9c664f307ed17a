#include "settings.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <vector>

#include <CLI/CLI.hpp>

#include "exit_code.h"

namespace g3r::cli {
namespace {

constexpr int kMaxThreads = 4096;             // more is a typing error, not a machine
constexpr int kMaxDegree = 8;                 // Options::degree
constexpr int kMinDepth = 4, kMaxDepth = 12;  // MeshOptions::depth
constexpr std::size_t kMaxSamples = 1'000'000'000;
constexpr std::size_t kEvalSamples = 200'000;  // per mesh, as in the paper

/// A range check that leaves the help text alone: the descriptions say the range in words.
template <class T>
CLI::Validator range(T low, T high) {
  return CLI::Range(low, high).description("");
}

[[noreturn]] void reject(const std::string& option, const std::string& text, const std::string& expected) {
  throw UsageError(option + ": expected " + expected + ", found '" + text + "'");
}

/// An option whose value is one of a few words.
template <class T>
void add_choice(CLI::App& app, const std::string& name, T& target, const std::map<std::string, T>& choices, const std::string& help) {
  app.add_option_function<std::string>(
         name,
         [&target, name, choices](const std::string& text) {
           const auto choice = choices.find(text);
           if (choice == choices.end()) {
             std::string words;
             for (const auto& [word, value] : choices) words += (words.empty() ? "" : ", ") + word;
             reject(name, text, "one of " + words);
           }
           target = choice->second;
         },
         help)
      ->type_name("NAME");
}

void add_run_options(CLI::App& app, Settings& s) {
  app.add_option("--threads", s.options.threads, "Threads, 0 for all cores; the result is the same for any number")
      ->check(range(0, kMaxThreads))
      ->type_name("N");
  app.add_flag("--quiet,-q", s.quiet, "Only errors on standard error");
  app.add_flag_callback(
      "--no-progress", [&s] { s.progress = false; }, "No progress bar");
  app.add_flag("-v,--verbose", s.verbosity, "More detail on standard error");
}

void add_report_options(CLI::App& app, Settings& s) {
  app.add_option("--report", s.report, "Write a JSON report (docs/report.md), - for standard output")->type_name("FILE");
  app.add_flag("--strict", s.strict, "Exit with 65 when the result is doubtful: not converged, inconsistent, not closed");
}

void add_seed_option(CLI::App& app, Settings& s) { app.add_option("--seed", s.options.seed, "Seed of random steps")->type_name("S"); }

void add_read_options(CLI::App& app, Settings& s) {
  app.add_option("--min-opacity", s.read_options.min_opacity, "Gaussian splats: leave out splats below this opacity")
      ->check(range(0.0, 1.0))
      ->type_name("X");
}

void add_write_options(CLI::App& app, Settings& s) {
  app.add_flag("--ascii", s.write_options.ascii, "Text instead of binary where the format has both");
  app.add_flag("--cloud-compare-names", s.write_options.cloud_compare_names, "Name the confidence so that CloudCompare shows it at once");
}

void add_also_option(CLI::App& app, Settings& s) {
  app.add_option("--also", s.also, "Write the result to FILE too, in the format of its extension; may be given again")
      ->type_name("FILE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
}

void add_mesh_options(CLI::App& app, Settings& s) {
  add_choice(app, "--mesher", s.mesh_options.mesher, {{"auto", Mesher::kAuto}, {"field", Mesher::kField}, {"poisson", Mesher::kPoisson}},
             "field (contours the winding field), poisson (screened Poisson), or auto for the preset's");
  app.add_option("--depth", s.mesh_options.depth, "Octree depth of the mesher, 4 to 12 (default: from the density)")
      ->check(range(kMinDepth, kMaxDepth))
      ->type_name("D");
}

void add_finish_options(CLI::App& app, Settings& s) {
  MeshOptions& o = s.mesh_options;
  app.add_option_function<std::string>(
         "--trim",
         [&o](const std::string& text) {
           const auto distance = parse_length(text);
           if (text == "off" || text == "auto") {
             o.trim = text == "off" ? MeshOptions::Trim::kOff : MeshOptions::Trim::kAuto;
           } else if (distance && !distance->is_percent && distance->value > 0) {
             o.trim = MeshOptions::Trim::kDistance;
             o.trim_distance = distance->value;
           } else {
             reject("--trim", text, "off, auto or a distance above 0");
           }
         },
         "Cut away surface far from every point: off, auto (4 spacings) or a distance; for open scans")
      ->type_name("off|auto|X");
  app.add_flag_callback(
      "--open", [&o] { o.trim = MeshOptions::Trim::kAuto; }, "The scan is open: the same as --trim auto");
  app.add_option("--keep-largest", o.keep_largest, "Keep only the N largest components")->type_name("N");
  app.add_option("--min-component", o.min_component, "Drop components of less area than N points stand for (default 8, 0: keep all)")
      ->check(range(0.0, 1e15))
      ->type_name("N");
  app.add_option("--faces", o.faces, "Simplify to about N triangles")->type_name("N");
}

void add_method_options(CLI::App& app, Settings& s) {
  Options& o = s.options;
  add_choice(app, "--preset", o.preset, {{"default", Preset::kDefault}, {"paper", Preset::kPaper}},
             "default, or paper for the published method");
  add_choice(app, "--method", o.method,
             {{"auto", Method::kAuto},
              {"green", Method::kGreen},
              {"energy", Method::kEnergy},
              {"wnnc", Method::kWnnc},
              {"agr", Method::kAgr},
              {"pgr", Method::kPgr}},
             "Equations to solve: green (as published), energy, auto for the preset's; earlier methods to compare with: wnnc, agr, pgr");
  app.add_option("--wnnc-widths", o.wnnc_widths, "Method wnnc: density (default), clean, scan, noise-0.25, noise-0.5, noise-1 or sparse")
      ->type_name("NAME");
  app.add_option_function<std::string>(
         "--epsilon",
         [&o](const std::string& text) {
           const auto epsilon = parse_epsilon(text);
           if (!epsilon) reject("--epsilon", text, "auto, X, X%, Xh or Xn with X > 0");
           o.epsilon = *epsilon;
         },
         "Width of the mollifier: auto, X (input units), X% (of the box diagonal), Xh (spacings) or Xn (the paper's unit box)")
      ->type_name("auto|X[%|h|n]");
  auto* degree = app.add_option("--degree", o.degree, "Highest degree of the harmonic polynomials, 0 to 8")
                     ->check(range(0, kMaxDegree))
                     ->type_name("L");
  app.add_option("--harmonics", o.harmonics, "Subset of the harmonic polynomials: \"1,x,y,z\", \"degree:0-2\"")
      ->excludes(degree)
      ->type_name("LIST");
  add_choice(app, "--solver", o.solver, {{"auto", Solver::kAuto}, {"dense", Solver::kDense}, {"cg", Solver::kConjugateGradient}},
             "auto, dense or cg");
  app.add_option("--schedule", o.schedule, "Iterations, for example \"20 sd 60 cg\"")->type_name("LIST");
  app.add_option("--tolerance", o.tolerance, "Stop when the relative residual falls below T; 0: never")
      ->check(range(0.0, 1.0))
      ->type_name("T");
  app.add_option("--accuracy", o.accuracy, "Relative error of the hierarchical sums, 1e-6 to 0.1; 0 for direct sums")
      ->check(range(0.0, 0.1))
      ->type_name("A");
  app.add_flag("--condition-number", o.condition_number, "Dense solver: also compute the condition number");
  app.add_option_function<std::string>(
         "--max-memory",
         [&o](const std::string& text) {
           const auto limit = parse_bytes(text);
           if (!limit) reject("--max-memory", text, "a size such as 8G or 512M");
           o.max_memory = *limit;
         },
         "Refuse before the solve if the plan needs more, for example 8G")
      ->type_name("SIZE");
}

void add_reconstruct(CLI::App& app, Settings& s) {
  app.add_option("IN", s.input, "Point cloud; - for standard input")->type_name("");
  app.add_option("OUT", s.output, "Mesh (default: IN with .mesh.ply for its extension); - for standard output")->type_name("");
  add_run_options(app, s);
  add_report_options(app, s);
  add_seed_option(app, s);
  add_read_options(app, s);
  add_write_options(app, s);
  add_also_option(app, s);
  app.add_option("--oriented", s.oriented, "Write the points with their normals and confidence too")->type_name("FILE");
  add_method_options(app, s);
  add_mesh_options(app, s);
  add_finish_options(app, s);
}

void add_orient(CLI::App& app, Settings& s) {
  CLI::App* sub = app.add_subcommand("orient", "Same points, same order, all properties kept, plus unit normals and confidence");
  sub->add_option("IN", s.input, "Point cloud; - for standard input")->required()->type_name("");
  sub->add_option("OUT", s.output, "Oriented cloud; - for standard output")->required()->type_name("");
  add_run_options(*sub, s);
  add_report_options(*sub, s);
  add_seed_option(*sub, s);
  add_read_options(*sub, s);
  add_write_options(*sub, s);
  add_also_option(*sub, s);
  add_method_options(*sub, s);
}

void add_mesh(CLI::App& app, Settings& s) {
  CLI::App* sub = app.add_subcommand("mesh", "Points that have outward normals -> mesh");
  sub->add_option("ORIENTED", s.input, "Point cloud with normals; - for standard input")->required()->type_name("");
  sub->add_option("OUT", s.output, "Mesh; - for standard output")->required()->type_name("");
  add_run_options(*sub, s);
  add_report_options(*sub, s);
  add_read_options(*sub, s);
  add_write_options(*sub, s);
  add_also_option(*sub, s);
  add_mesh_options(*sub, s);
  add_finish_options(*sub, s);
}

void add_eval(CLI::App& app, Settings& s) {
  CLI::App* sub =
      app.add_subcommand("eval", "Scores against the truth as JSON: AE_p, PCO for points with normals; CD, AE_m, HD for meshes");
  sub->add_option("RESULT", s.input, "Oriented cloud or mesh")->required()->type_name("");
  sub->add_option("--truth", s.truth, "Cloud with true normals in the same order, or true mesh")->required()->type_name("GT");
  sub->add_option("--samples", s.sample_count, "Points sampled on each mesh (default 200000)")
      ->check(range(std::size_t{1}, kMaxSamples))
      ->type_name("N");
  add_seed_option(*sub, s);
  add_run_options(*sub, s);
}

void add_sample(CLI::App& app, Settings& s) {
  CLI::App* sub = app.add_subcommand("sample", "Points on a mesh, uniform by area, with true normals");
  sub->add_option("MESH", s.input, "Mesh")->required()->type_name("");
  sub->add_option("OUT", s.output, "Point cloud; - for standard output")->required()->type_name("");
  sub->add_option("--count", s.sample_count, "Points to draw")->required()->check(range(std::size_t{1}, kMaxSamples))->type_name("N");
  sub->add_option_function<std::string>(
         "--noise",
         [&s](const std::string& text) {
           const auto noise = parse_length(text);
           if (!noise) reject("--noise", text, "X or X% with X >= 0");
           s.noise = *noise;
         },
         "Standard deviation of Gaussian noise: X (mesh units) or X% (of the box diagonal)")
      ->type_name("X[%]");
  add_seed_option(*sub, s);
  add_write_options(*sub, s);
  add_run_options(*sub, s);
}

void add_info(CLI::App& app, Settings& s) {
  CLI::App* sub = app.add_subcommand("info", "What is in a file, and what g3r would do with it");
  sub->add_option("FILE", s.input, "Point cloud or mesh")->required()->type_name("");
  add_run_options(*sub, s);
  sub->add_option("--report", s.report, "Write the plan as a JSON report, - for standard output instead of the text")->type_name("FILE");
  add_read_options(*sub, s);
  add_method_options(*sub, s);
  add_mesh_options(*sub, s);
}

const std::map<std::string, Layer> kLayers = {{"points", Layer::kPoints}, {"normals", Layer::kNormals}, {"confidence", Layer::kConfidence},
                                              {"colors", Layer::kColors}, {"error", Layer::kError},     {"mesh", Layer::kMesh}};

void add_view(CLI::App& app, Settings& s) {
  CLI::App* sub = app.add_subcommand("view", "A page (.html) or a picture (.png) of a cloud, a mesh, or both");
  sub->add_option("IN", s.shown, "Cloud, mesh, or one of each")->required()->expected(1, 2)->type_name("");
  sub->add_option("-o,--out", s.output, "Page .html or picture .png; - for the page on standard output")->required()->type_name("OUT");
  sub->add_option("--truth", s.truth, "Cloud with true normals in the same order: adds the map of errors")->type_name("GT");
  sub->add_option("--figures", s.figures, "Report of the run, shown beside the view of a page")->type_name("FILE.json");
  sub->add_flag_callback(
      "--z-up", [&s] { s.page.up = s.picture.up = Up::kZ; }, "The z axis points up instead of the y axis");
  sub->add_option_function<std::vector<std::string>>(
         "--layers",
         [&s](const std::vector<std::string>& names) {
           for (const std::string& name : names) {
             const auto layer = kLayers.find(name);
             if (layer == kLayers.end()) reject("--layers", name, "points, normals, confidence, colors, error or mesh");
             s.picture.layers.push_back(layer->second);
           }
         },
         "Picture: what to draw, one row each: points,normals,confidence,colors,error,mesh")
      ->delimiter(',')
      ->type_name("LIST");
  sub->add_option("--tile", s.picture.tile, "Picture: width and height of one view in pixels, 16 to 2048")
      ->check(range(16, 2048))
      ->type_name("PIXELS");
  sub->add_flag("--dark", s.picture.dark, "Picture: dark background");
  add_read_options(*sub, s);
  add_run_options(*sub, s);
}

/// scan.ply -> scan.mesh.ply
std::string default_output(const std::string& input) { return std::filesystem::path(input).replace_extension(".mesh.ply").string(); }

Command parsed_command(const CLI::App& app) {
  const std::map<std::string, Command> commands = {{"orient", Command::kOrient}, {"mesh", Command::kMesh}, {"eval", Command::kEval},
                                                   {"sample", Command::kSample}, {"info", Command::kInfo}, {"view", Command::kView}};
  const auto parsed = app.get_subcommands();
  return parsed.empty() ? Command::kReconstruct : commands.at(parsed.front()->get_name());
}

/// What CLI11 cannot check: rules over several arguments.
void complete(const CLI::App& app, Settings& s) {
  s.command = parsed_command(app);
  if (s.command == Command::kReconstruct) {
    if (s.input.empty()) throw UsageError("expected a point cloud");
    if (s.output.empty() && s.input == "-") throw UsageError("standard input has no name to derive OUT from: give OUT");
    if (s.output.empty()) s.output = default_output(s.input);
  } else if (app.count("IN") > 0) {
    throw UsageError("expected the command '" + app.get_subcommands().front()->get_name() + "' before its files");
  }
  if (s.command == Command::kView) {
    const std::string extension = std::filesystem::path(s.output).extension().string();
    if (s.output != "-" && extension != ".html" && extension != ".htm" && extension != ".png") {
      throw UsageError("unknown extension '" + extension + "' of " + s.output + ": view writes .html or .png");
    }
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
  CLI::App app("g3r: consistent outward normals and a watertight mesh from an unoriented point cloud", "g3r");
  app.set_version_flag("--version", "g3r " + std::string(version()));
  app.footer(kExitCodeHelp);
  app.require_subcommand(0, 1);
  add_reconstruct(app, settings);
  add_orient(app, settings);
  add_mesh(app, settings);
  add_eval(app, settings);
  add_sample(app, settings);
  add_info(app, settings);
  add_view(app, settings);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {
    app.exit(request, std::cout, std::cout);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  complete(app, settings);
  check_options(settings.options);
  return settings;
}

}  // namespace g3r::cli
