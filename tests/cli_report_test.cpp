// Truths about the report: valid JSON for any Stats, every documented field present, nothing that JSON cannot hold.
#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace {

using nlohmann::json;

json report(const g3r::Stats& stats, const g3r::MeshCheck* mesh = nullptr) { return json::parse(g3r::report_json(stats, mesh)); }

// report: an empty run has every documented field.
TEST(Report, HasEveryDocumentedField) {
  const json r = report({});
  for (const char* key : {"schema", "schema_version", "g3r_version", "input", "scales", "method", "iterations", "converged", "consistent",
                          "seconds", "planned_memory_bytes", "peak_memory_bytes", "threads", "device", "confidence", "mesh", "warnings"}) {
    EXPECT_TRUE(r.contains(key)) << key;
  }
  for (const char* stage : {"read", "build", "solve", "refine", "mesh", "write", "total"}) EXPECT_EQ(r["seconds"][stage], 0.0) << stage;
  EXPECT_EQ(r["schema"], "g3r.report");
  EXPECT_EQ(r["schema_version"], 1);
  EXPECT_EQ(r["g3r_version"], std::string(g3r::version()));
  EXPECT_TRUE(r["mesh"].is_null());
  EXPECT_TRUE(r["method"]["condition_number"].is_null());
}

// report: the total is what the caller measured, else the sum of the stages; unknown stages are kept.
TEST(Report, SecondsAddUp) {
  g3r::Stats stats;
  stats.seconds = {{"build", 1.0}, {"solve", 2.0}, {"solve", 0.5}, {"carry", 0.25}};
  json r = report(stats);
  EXPECT_EQ(r["seconds"]["solve"], 2.5);
  EXPECT_EQ(r["seconds"]["carry"], 0.25);
  EXPECT_EQ(r["seconds"]["total"], 3.75);
  stats.seconds.emplace_back("total", 5.0);
  r = report(stats);
  EXPECT_EQ(r["seconds"]["total"], 5.0);
}

// report: what is not a finite number is null, what is not UTF-8 is replaced; the text stays valid JSON.
TEST(Report, HoldsWhatJsonCanHold) {
  g3r::Stats stats;
  stats.spacing = std::numeric_limits<double>::quiet_NaN();
  stats.iterations.push_back({"cg", std::numeric_limits<double>::infinity()});
  stats.warnings = {"bad name \xff\x1b[2J"};
  const json r = report(stats);
  EXPECT_TRUE(r["scales"]["spacing"].is_null());
  EXPECT_TRUE(r["iterations"][0]["residual"].is_null());
  EXPECT_EQ(r["warnings"].size(), 1U);
  EXPECT_EQ(g3r::report_json(stats).find('\x1b'), std::string::npos);
}

// report: a genus is only told of a closed manifold mesh.
TEST(Report, GenusNeedsAClosedManifold) {
  g3r::MeshCheck check;
  check.triangles = 4;
  check.genus = 3;
  EXPECT_TRUE(report({}, &check)["mesh"]["genus"].is_null());
  check.closed = check.manifold = true;
  EXPECT_EQ(report({}, &check)["mesh"]["genus"], 3);
  EXPECT_EQ(report({}, &check)["mesh"]["faces"], 4);
}

}  // namespace
