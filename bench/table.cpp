// g3r_bench_table: orients (and meshes) samples of ground-truth meshes and scores the results. README.md holds the protocol.
#include <g3r/g3r.h>
#include <g3r/io.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "inputs.h"
#include "measure.h"
#include "results.h"
#include "variant.h"

namespace g3r::bench {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string data;
  std::vector<std::size_t> points;  ///< empty: as many as each input has by itself
  std::vector<std::string> inputs = {"clean"};
  std::vector<std::string> methods = {"paper", "default"};
  std::vector<std::string> models;  ///< empty: all
  bool mesh = false;
  std::string json = "table.json";
  std::string markdown = "table.md";
  RunInfo run{"", 1, 0};
};

Arguments parse_arguments(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Scores normals and meshes against ground-truth meshes (protocol: bench/README.md)");
  app.add_option("--data", arguments.data, "folder of closed, outward oriented triangle meshes")->required()->check(CLI::ExistingDirectory);
  app.add_option("--points", arguments.points, "numbers of points, comma separated; 5000, and 100000 for pcpnet, unless given")
      ->delimiter(',')
      ->check(CLI::Range(4, 100000000));
  app.add_option("--inputs", arguments.inputs,
                 "clean, noise:P, outliers:P, gradient:R, stripes:R, patches:K, pcpnet (six) or one pcpnet:NAME; comma separated")
      ->delimiter(',');
  app.add_option("--method", arguments.methods,
                 "default, paper, wnnc, agr, pgr, true (normals) or ceiling, then ;KEY=VALUE for ablations; may be given several times");
  app.add_option("--models", arguments.models, "only these models (file names without extension), comma separated")->delimiter(',');
  app.add_flag("--mesh", arguments.mesh, "also mesh, and score CD, AE_m, HD");
  app.add_option("--seed", arguments.run.seed, "seed of the samples");
  app.add_option("--threads", arguments.run.threads, "threads, 0: all cores");
  app.add_option("--label", arguments.run.label, "text for the head of the results, for example the commit");
  app.add_option("--json", arguments.json, "file for all results");
  app.add_option("--markdown", arguments.markdown, "file for the tables");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error));
  }
  return arguments;
}

void show(const Row& row) {
  std::fprintf(stderr, "%-20s %-12s %8zu %-24s ", row.model.c_str(), row.input.c_str(), row.points, row.method.c_str());
  if (!row.error.empty()) {
    std::fprintf(stderr, "error: %s\n", row.error.c_str());
    return;
  }
  std::fprintf(stderr, "AE_p %.3fe-2 PCO %.3f %% %.2f CPU s", 100 * row.ae, 100 * row.pco, row.cpu_seconds);
  if (row.mesh)
    std::fprintf(stderr, " | CD %.3fe-3 AE_m %.3fe-2 HD %.3fe-2", 1e3 * row.mesh->chamfer, 100 * row.mesh->ae, 100 * row.mesh->hausdorff);
  std::fprintf(stderr, "\n");
}

/// All rows of one model. A mesh that cannot be used gives one row with the error.
void measure_model(const fs::path& path, const Arguments& arguments, const std::vector<InputKind>& kinds,
                   const std::vector<Variant>& variants, std::vector<Row>& rows) {
  const std::string model = path.stem().string();
  try {
    const Mesh truth = read_mesh(path.string());
    for (const std::size_t count : arguments.points.empty() ? std::vector<std::size_t>{0} : arguments.points) {
      for (const InputKind& kind : kinds) {
        const Input input = make_input(truth, kind, count > 0 ? count : kind.points, arguments.run.seed);
        for (const Variant& variant : variants) {
          rows.push_back(measure(model, truth, input, kind, variant, arguments.mesh, arguments.run.seed));
          show(rows.back());
        }
      }
    }
  } catch (const Error& error) {
    Row row;
    row.model = model;
    row.error = error.what();
    rows.push_back(row);
    show(row);
  }
}

void run(const Arguments& arguments) {
  const std::vector<InputKind> kinds = parse_input_kinds(arguments.inputs);
  std::vector<Variant> variants;
  for (const std::string& text : arguments.methods) {
    variants.push_back(parse_variant(text));
    variants.back().options.threads = arguments.run.threads;
  }
  std::vector<Row> rows;
  const auto write = [&] {
    write_file(arguments.json, to_json(arguments.run, rows));
    write_file(arguments.markdown, to_markdown(arguments.run, rows));
  };
  write();  // learns before the work whether the results can be written
  for (const fs::path& path : find_models(arguments.data, arguments.models)) {
    measure_model(path, arguments, kinds, variants, rows);
    write();  // what is done is kept if the run is stopped
  }
  std::fprintf(stderr, "%zu rows in %s, tables in %s\n", rows.size(), arguments.json.c_str(), arguments.markdown.c_str());
}

}  // namespace

}  // namespace g3r::bench

int main(int argc, char** argv) {
  try {
    g3r::bench::run(g3r::bench::parse_arguments(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "g3r_bench_table: %s\n", error.what());
    return 1;
  }
  return 0;
}
