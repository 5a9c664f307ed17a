#include "command_options.h"

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "option_groups.h"
#include "option_kinds.h"

namespace g3r::cli {
namespace {

// The most points that can be drawn from a mesh: more need not fit into memory, so a larger number is most likely a typing error.
constexpr std::size_t kMaxSamples = 1'000'000'000;

constexpr const char* kPageGroup = "Page and picture";
constexpr const char* kCommandGroup = "Commands";

constexpr const char* kTilesHelp =
    "If it would need more, for example 8G: work in tiles, on disk beside OUT (.ply; orient: .las, .laz too), or refuse "
    "(default: what is free; tiles from three quarters of it on, which is told; the same bytes everywhere need it given)";
constexpr const char* kMemoryHelp = "Warn if reconstruction would need more, for example 8G (default: three quarters of what is free)";

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
  add_memory_option(*sub, s, "If it would need more, for example 8G: refuse (default: what is free)");
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
  add_threads_option(*sub, s);
  add_console_options(*sub, s);
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
  add_console_options(*sub, s);
}

void add_info(CLI::App& app, Settings& s) {
  CLI::App* sub = add_command(app, "info", "What is in a file, what g3r would do with it, and the memory that would take");
  sub->add_option("FILE", s.input, "Point cloud or mesh")->required()->type_name("");
  add_run_options(*sub, s);
  sub->add_option("--report", s.report, "Write the plan as JSON; - for standard output, instead of the text")->type_name("FILE");
  add_read_options(*sub, s);
  add_method_options(*sub, s);
  add_memory_option(*sub, s, kMemoryHelp);
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
      ->type_name("DIR");
  plan->add_option("--tiles", s.tile_count, "Number of tiles (default: as few as the memory allows)")
      ->check(range(std::size_t{1}, std::size_t{1000000}))
      ->type_name("N");
  add_hint_options(*plan, s);
  add_run_options(*plan, s);
  add_memory_option(
      *plan, s,
      "What a worker may take, for example 6G (default: three quarters of what is free, which is told; the same bytes everywhere "
      "need it given)");
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
  CLI::Option* mesh_flag = merge->add_flag("--mesh", s.merge_mesh, "Write the mesh instead of the points");
  add_component_options(*merge, s.mesh_options);
  for (const char* name : {"--keep-largest", "--min-component", "--keep-all"}) merge->get_option(name)->needs(mesh_flag);
  add_console_options(*merge, s);
}

void add_view(CLI::App& app, Settings& s) {
  CLI::App* sub = add_command(app, "view", "A page (.html) or a picture (.png) of a cloud, a mesh, or both");
  sub->add_option("IN", s.shown, "Cloud, mesh, or one of each")->required()->expected(1, 2)->type_name("");
  sub->add_option("-o,--out", s.output, "Page .html or picture .png; - for the page on standard output")->required()->type_name("OUT");
  sub->option_defaults()->group(kPageGroup);
  sub->add_option("--truth", s.truth, "Cloud with true normals in the same order: adds the map of errors")->type_name("GT");
  sub->add_option("--figures", s.figures, "Page: report of the run, to show beside the view")->type_name("FILE.json");
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
  add_threads_option(*sub, s);
  add_console_options(*sub, s);
}

}  // namespace

void add_commands(CLI::App& app, Settings& settings) {
  add_reconstruct(app, settings);
  add_orient(app, settings);
  add_mesh(app, settings);
  add_eval(app, settings);
  add_sample(app, settings);
  add_info(app, settings);
  add_view(app, settings);
  add_tiles(app, settings);
}

}  // namespace g3r::cli
