#include "results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>
#include <utility>

#include "mesh/screened_poisson.h"

namespace g3r::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWorstShown = 3;
constexpr double kMostThin = 0.05;  // share of thin parts up to which a model counts as thick

/// One column of the tables: where its value comes from and how it is shown.
struct Score {
  const char* title;
  double factor;
  const char* format;
  bool low_is_good;
  std::function<double(const Row&)> value;
};

const std::vector<Score>& point_scores() {
  static const std::vector<Score> scores = {
      {"AE_p 1e-2", 100, "%.3f", true, [](const Row& r) { return r.ae; }},
      {"PCO %", 100, "%.3f", false, [](const Row& r) { return r.pco; }},
  };
  return scores;
}

const std::vector<Score>& cost_scores() {
  static const std::vector<Score> scores = {{"CPU s", 1, "%.1f", true, [](const Row& r) { return r.cpu_seconds; }}};
  return scores;
}

const std::vector<Score>& mesh_scores() {
  static const std::vector<Score> scores = {
      {"CD 1e-3", 1000, "%.3f", true, [](const Row& r) { return r.mesh->chamfer; }},
      {"AE_m 1e-2", 100, "%.3f", true, [](const Row& r) { return r.mesh->ae; }},
      {"HD 1e-2", 100, "%.3f", true, [](const Row& r) { return r.mesh->hausdorff; }},
      {"mesher CPU s", 1, "%.1f", true, [](const Row& r) { return r.mesh->cpu_seconds; }},
  };
  return scores;
}

std::string shown(const Score& score, double value) {
  char text[64];
  std::snprintf(text, sizeof text, score.format, score.factor * value);
  return text;
}

Json mesh_json(const MeshRow& mesh) {
  return {{"cd", mesh.chamfer},
          {"ae_m", mesh.ae},
          {"hd", mesh.hausdorff},
          {"vertices", mesh.check.vertices},
          {"triangles", mesh.check.triangles},
          {"components", mesh.check.components},
          {"closed", mesh.check.closed},
          {"manifold", mesh.check.manifold},
          {"genus", mesh.check.genus},
          {"volume", mesh.check.volume},
          {"area", mesh.check.area},
          {"self_intersections", mesh.check.self_intersections.value_or(0)},
          {"seconds", mesh.seconds},
          {"cpu_seconds", mesh.cpu_seconds}};
}

Json row_json(const Row& row) {
  Json json = {{"model", row.model}, {"input", row.input}, {"points", row.points}, {"method", row.method}};
  if (!row.error.empty()) {
    json["error"] = row.error;
    return json;
  }
  json["ae_p"] = row.ae;
  json["pco"] = row.pco;
  json["angle_degrees"] = {
      {"50", row.angle_quantiles[0]}, {"90", row.angle_quantiles[1]}, {"95", row.angle_quantiles[2]}, {"99", row.angle_quantiles[3]}};
  if (row.confidence_auc >= 0) json["confidence_auc"] = row.confidence_auc;
  json["right_and_sure"] = row.right_and_sure;
  json["wrong_and_sure"] = row.wrong_and_sure;
  if (row.outlier_confidence >= 0) json["outlier_confidence"] = row.outlier_confidence;
  json["thin"] = row.thin;
  if (row.wrong_thin >= 0) json["wrong_thin"] = row.wrong_thin;
  json["seconds"] = row.seconds;
  json["cpu_seconds"] = row.cpu_seconds;
  for (const auto& [stage, seconds] : row.stats.seconds) json["stage_seconds"][stage] = seconds;
  json["spacing"] = row.stats.spacing;
  json["noise"] = row.stats.noise;
  json["epsilon"] = row.stats.epsilon;
  json["harmonics"] = row.stats.harmonics;
  json["solver"] = row.stats.solver;
  json["sums"] = row.stats.sums;
  json["iterations"] = row.stats.iterations.size();
  if (!row.stats.iterations.empty()) json["residual"] = row.stats.iterations.back().residual;
  json["converged"] = row.stats.converged;
  json["peak_memory_bytes"] = row.stats.peak_memory_bytes;
  if (row.mesh) json["mesh"] = mesh_json(*row.mesh);
  if (!row.mesh_error.empty()) json["mesh_error"] = row.mesh_error;
  return json;
}

/// Distinct values in order of first appearance.
template <class Get>
auto distinct(const std::vector<const Row*>& rows, const Get& get) {
  std::vector<decltype(get(*rows.front()))> values;
  for (const Row* row : rows) {
    if (std::find(values.begin(), values.end(), get(*row)) == values.end()) values.push_back(get(*row));
  }
  return values;
}

std::vector<const Row*> select(const std::vector<const Row*>& rows, const std::function<bool(const Row&)>& wanted) {
  std::vector<const Row*> selected;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(selected), [&](const Row* row) { return wanted(*row); });
  return selected;
}

/// Writes "mean | median | worst three by name" of one score.
void write_summary(const Score& score, std::vector<const Row*> rows, std::ostream& out) {
  if (rows.empty()) {
    out << "- | - | -";
    return;
  }
  double sum = 0;
  for (const Row* row : rows) sum += score.value(*row);
  std::stable_sort(rows.begin(), rows.end(), [&](const Row* a, const Row* b) {
    return score.low_is_good ? score.value(*a) > score.value(*b) : score.value(*a) < score.value(*b);
  });
  const std::size_t n = rows.size();
  const double median = (score.value(*rows[(n - 1) / 2]) + score.value(*rows[n / 2])) / 2;
  out << shown(score, sum / static_cast<double>(n)) << " | " << shown(score, median) << " | ";
  for (std::size_t i = 0; i < std::min(n, kWorstShown); ++i) {
    out << (i > 0 ? ", " : "") << rows[i]->model << ' ' << shown(score, score.value(*rows[i]));
  }
}

void write_summaries(const std::vector<Score>& scores, const std::vector<std::string>& methods, const std::vector<const Row*>& rows,
                     std::ostream& out) {
  out << "| method | models |";
  for (const Score& score : scores) out << ' ' << score.title << " mean | median | worst |";
  out << "\n|---|---|";
  for (std::size_t i = 0; i < scores.size(); ++i) out << "---|---|---|";
  out << '\n';
  for (const std::string& method : methods) {
    const auto of_method = select(rows, [&](const Row& row) { return row.method == method; });
    out << "| " << method << " | " << of_method.size() << " |";
    for (const Score& score : scores) {
      out << ' ';
      write_summary(score, of_method, out);
      out << " |";
    }
    out << '\n';
  }
  out << '\n';
}

// The summary of the models that the sample can hold, where there are others.
void write_thick_summaries(const std::vector<std::string>& methods, const std::vector<const Row*>& rows, std::ostream& out) {
  const auto thick = select(rows, [](const Row& row) { return row.thin <= kMostThin; });
  if (thick.size() == rows.size()) return;
  const auto thin = select(rows, [](const Row& row) { return row.thin > kMostThin; });
  out << "Without the models of which more than " << 100 * kMostThin << " % of the points lie within " << kThinSpacings << " spacings, or "
      << kThinDeviations << " standard deviations of the noise, of points on another side:";
  const char* separator = " ";
  for (const std::string& model : distinct(thin, [](const Row& row) { return row.model; })) {
    const auto found = std::find_if(thin.begin(), thin.end(), [&](const Row* row) { return row->model == model; });
    char share[32];
    std::snprintf(share, sizeof share, " %.0f %%", 100 * (*found)->thin);
    out << separator << model << share;
    separator = ", ";
  }
  out << ".\n\n";
  write_summaries(point_scores(), methods, thick, out);
}

void write_cell(const Row& row, std::ostream& out) {
  if (!row.error.empty()) {
    out << "error: " << row.error;
    return;
  }
  const char* separator = "";
  for (const Score& score : point_scores()) {
    out << separator << shown(score, score.value(row));
    separator = " / ";
  }
  if (!row.mesh_error.empty()) out << " no mesh: " << row.mesh_error;
  if (!row.mesh) return;
  for (const Score& score : mesh_scores()) out << separator << shown(score, score.value(row));
  const MeshCheck& check = row.mesh->check;
  out << (check.boundary_edges == 0 ? "" : " open") << (check.manifold ? "" : " non-manifold") << " g" << check.genus << " c"
      << check.components << " x" << check.self_intersections.value_or(0);
}

void write_models(const std::vector<std::string>& methods, const std::vector<const Row*>& rows, bool with_mesh, std::ostream& out) {
  out << "Per model: AE_p 1e-2 / PCO %";
  if (with_mesh)
    out << " / CD 1e-3 / AE_m 1e-2 / HD 1e-2 / CPU s of the mesher, g = genus, c = components, x = pairs of triangles that intersect";
  out << "\n\n| model |";
  for (const std::string& method : methods) out << ' ' << method << " |";
  out << "\n|---|";
  for (std::size_t i = 0; i < methods.size(); ++i) out << "---|";
  out << '\n';
  for (const std::string& model : distinct(rows, [](const Row& row) { return row.model; })) {
    out << "| " << model << " |";
    for (const std::string& method : methods) {
      const auto found = select(rows, [&](const Row& row) { return row.model == model && row.method == method; });
      out << ' ';
      if (found.empty()) {
        out << '-';
      } else {
        write_cell(*found[0], out);
      }
      out << " |";
    }
    out << '\n';
  }
  out << '\n';
}

}  // namespace

std::string to_json(const RunInfo& run, const std::vector<Row>& rows) {
  Json json = {{"schema", 1},
               {"version", std::string(version())},
               {"label", run.label},
               {"seed", run.seed},
               {"threads", run.threads},
               {"poisson_available", screened_poisson_available()}};
  json["rows"] = Json::array();
  for (const Row& row : rows) json["rows"].push_back(row_json(row));
  return json.dump(1) + "\n";
}

std::string to_markdown(const RunInfo& run, const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "# Benchmark" << (run.label.empty() ? "" : ": ") << run.label << "\n\nSeed " << run.seed << ", g3r " << version()
      << ". How to read and repeat this: bench/README.md.\n\n";
  std::vector<const Row*> all;
  for (const Row& row : rows) {
    if (!row.method.empty()) {
      all.push_back(&row);
    } else {
      out << "Not measured: " << row.model << ": " << row.error << "\n\n";
    }
  }
  const auto methods = distinct(all, [](const Row& row) { return row.method; });
  for (const auto& cloud : distinct(all, [](const Row& row) { return std::pair(row.input, row.points); })) {
    const auto here = select(all, [&](const Row& row) { return std::pair(row.input, row.points) == cloud; });
    const auto good = select(here, [](const Row& row) { return row.error.empty(); });
    const auto meshed = select(good, [](const Row& row) { return row.mesh.has_value(); });
    out << "## " << cloud.first << ", " << cloud.second << " points\n\n";
    write_summaries(point_scores(), methods, good, out);
    write_thick_summaries(methods, good, out);
    write_summaries(cost_scores(), methods, good, out);
    if (!meshed.empty()) write_summaries(mesh_scores(), methods, meshed, out);
    write_models(methods, here, !meshed.empty(), out);
  }
  return out.str();
}

}  // namespace g3r::bench
