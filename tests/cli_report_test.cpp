// Truths about the report: valid JSON for any Stats, every documented field present, nothing that JSON cannot hold.
#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using nlohmann::json;

json report(const g3r::Stats& stats, const g3r::MeshCheck* mesh = nullptr) { return json::parse(g3r::report_json(stats, mesh)); }

// Every field of `kept` is in `now`, with a value of the same type; null stands for a number that does not apply.
void expect_fields(const json& kept, const json& now, const std::string& where) {
  for (const auto& [key, value] : kept.items()) {
    ASSERT_TRUE(now.contains(key)) << where << key << " is gone: raise schema_version";
    const json& other = now[key];
    if (value.is_object()) {
      ASSERT_TRUE(other.is_object()) << where << key;
      expect_fields(value, other, where + key + ".");
    } else if (value.is_number()) {
      EXPECT_TRUE(other.is_number() || other.is_null()) << where << key;
    } else if (!value.is_null()) {
      EXPECT_EQ(std::string(value.type_name()), other.type_name()) << where << key;
    }
  }
}

// report: what reads a report of 0.1.0, the first with version 1 of the schema, reads any later one of that version.
TEST(Report, KeepsEveryFieldOfTheFirstVersion) {
  std::ifstream file(std::string(G3R_REPORTS) + "/0.1.0.json");
  const json kept = json::parse(file);
  EXPECT_EQ(kept["schema"], "g3r.report");
  EXPECT_EQ(kept["g3r_version"], "0.1.0");
  g3r::MeshCheck mesh;
  mesh.closed = mesh.manifold = true;
  g3r::Stats stats;
  const json now = report(stats, &mesh);
  ASSERT_EQ(now["schema_version"], kept["schema_version"]) << "keep a report of the new version, and read both";
  expect_fields(kept, now, "");
}

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
