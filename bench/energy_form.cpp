// g3r_bench_energy_form: the energy form of docs/math.md with every number given, from eta = 0 by conjugate gradients, and one refinement.
// All combinations of the lists are measured; the method of a row names the lists that have more than one value. Same inputs, scores and
// files as g3r_bench_table (README.md). Lengths are in spacings.
#include <g3r/io.h>
#include <g3r/metrics.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "cloud/canonical_cloud.h"
#include "cloud/spacing.h"
#include "inputs.h"
#include "results.h"
#include "solve/energy_system.h"
#include "solve/iterative_solver.h"
#include "solve/refine.h"

namespace g3r::bench {

namespace {

constexpr double kAccuracy = 1e-2;  // of the sums, as in orient()

struct Arguments {
  std::string data;
  std::vector<std::string> models;
  std::vector<std::size_t> points = {50000};
  std::vector<std::string> inputs = {"clean"};
  std::vector<double> epsilons = {0.3}, weights = {0.1}, dampings = {0}, widths = {0, 0.55};
  std::vector<int> iterations = {45};
  std::string json = "energy_form.json", markdown = "energy_form.md";
  RunInfo run{"", 1, 0};
};

Arguments parse_arguments(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Scores the energy form at given widths and weights (protocol: bench/README.md)");
  app.add_option("--data", arguments.data, "folder of closed, outward oriented triangle meshes")->required()->check(CLI::ExistingDirectory);
  app.add_option("--models", arguments.models, "only these models")->delimiter(',');
  app.add_option("--points", arguments.points, "numbers of points")->delimiter(',');
  app.add_option("--inputs", arguments.inputs, "kinds of input, as for g3r_bench_table")->delimiter(',');
  app.add_option("--epsilon", arguments.epsilons, "e: widths of the mollifier in spacings")->delimiter(',');
  app.add_option("--weight", arguments.weights, "l: weights of W eta = 1/2 in spacings")->delimiter(',');
  app.add_option("--damping", arguments.dampings, "d: dampings, times one over the spacing")->delimiter(',');
  app.add_option("--iterations", arguments.iterations, "steps of conjugate gradients")->delimiter(',');
  app.add_option("--width", arguments.widths, "s: widths of the refinement in spacings, 0: none")->delimiter(',');
  app.add_option("--seed", arguments.run.seed, "seed of the samples");
  app.add_option("--label", arguments.run.label, "text for the head of the results");
  app.add_option("--json", arguments.json, "file for all results");
  app.add_option("--markdown", arguments.markdown, "file for the tables");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error));
  }
  return arguments;
}

template <class T>
std::string named(const char* key, const std::vector<T>& list, T value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, ";%s=%g%s", key, static_cast<double>(value), unit);
  return list.size() > 1 ? text : "";
}

/// Scores the normals, which are in canonical order.
void score(const std::vector<Vec3>& normals, const CanonicalCloud& cloud, const Input& input, Row row, std::vector<Row>& rows) {
  std::vector<Vec3> handed_out(input.surface);
  for (std::size_t i = 0; i < input.surface; ++i) handed_out[i] = normals[cloud.point_of[i]];
  const NormalScore result = score_normals(handed_out, input.normals);
  row.ae = result.ae;
  row.pco = result.pco;
  std::fprintf(stderr, "%s %s %zu %s AE_p %.3fe-2 PCO %.3f %%\n", row.model.c_str(), row.input.c_str(), row.points, row.method.c_str(),
               100 * row.ae, 100 * row.pco);
  rows.push_back(row);
}

void measure_cloud(const Input& input, Row row, const Arguments& a, std::vector<Row>& rows) {
  const CanonicalCloud cloud = canonical_cloud(input.points);
  const double h = typical_spacing(local_spacing(cloud.points()));
  const SumPlan plan = sum_plan(kAccuracy, cloud.size());
  for (const double e : a.epsilons) {
    FastSum sum(cloud.points(), Widths(e * h), plan);
    for (const double l : a.weights) {
      for (const double d : a.dampings) {
        for (const int steps : a.iterations) {
          EnergySystem system(sum, d / h, l * h);
          const std::vector<Vec3> eta = solve_iteratively(system, {{steps, StepKind::kConjugateGradient}}, 0).eta;
          for (const double s : a.widths) {
            row.method = "energy" + named("epsilon", a.epsilons, e, "h") + named("weight", a.weights, l, "h") +
                         named("damping", a.dampings, d, "") + named("iterations", a.iterations, steps, "") +
                         named("width", a.widths, s, "h");
            if (s == 0) {
              score(normalised(eta), cloud, input, row, rows);
            } else {
              FastSum refining(cloud.points(), Widths(s * h), plan);
              score(refine_normals(refining, eta).normals, cloud, input, row, rows);
            }
          }
        }
      }
    }
  }
}

void run(const Arguments& arguments) {
  std::vector<Row> rows;
  for (const auto& path : find_models(arguments.data, arguments.models)) {
    const Mesh truth = read_mesh(path.string());
    for (const std::size_t count : arguments.points) {
      for (const std::string& text : arguments.inputs) {
        const InputKind kind = parse_input_kind(text);
        Row row;
        row.model = path.stem().string();
        row.input = kind.name;
        row.points = count;
        measure_cloud(make_input(truth, kind, count, arguments.run.seed), row, arguments, rows);
      }
    }
    write_file(arguments.json, to_json(arguments.run, rows));
    write_file(arguments.markdown, to_markdown(arguments.run, rows));
  }
}

}  // namespace

}  // namespace g3r::bench

int main(int argc, char** argv) {
  try {
    g3r::bench::run(g3r::bench::parse_arguments(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "g3r_bench_energy_form: %s\n", error.what());
    return 1;
  }
  return 0;
}
