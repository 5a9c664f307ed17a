// g3r_bench_stress: clouds nobody made by hand, held to what must hold for every cloud. README.md, "Stress".
#include <g3r/error.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stress/run_apart.h"
#include "stress/run_options.h"
#include "stress/shrink.h"

namespace g3r::stress {
namespace {

constexpr double kManyTimes = 50;       // the median time per point is too slow
constexpr double kSetUp = 1000;         // points: what a run takes at any size, in time per point
constexpr std::size_t kForMedian = 20;  // runs that make a median

struct Arguments {
  std::uint64_t seed = 1;
  std::uint64_t count = 100;
  std::size_t largest = 20000;
  double seconds = 0;
  int attempts = 150;
  bool shrink = true;
  std::string keep;
  std::string program;
  std::vector<std::string> replay;
  std::string recipe;
};

struct Run {
  Recipe recipe;
  Outcome outcome;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  CLI::App app{"Runs g3r on clouds made from seeds and holds it to what must hold for every cloud"};
  app.add_option("--seed", a.seed, "Seed of the first cloud; the following have the following ones");
  app.add_option("--count", a.count, "Number of clouds");
  app.add_option("--largest", a.largest, "Points of the largest cloud");
  app.add_option("--seconds", a.seconds, "Stop after so many seconds; 0: never");
  app.add_option("--program", a.program, "The g3r program, held to the library on every cloud");
  app.add_option("--keep", a.keep, "Folder that gets a small case for every failure");
  app.add_option("--attempts", a.attempts, "Runs spent on making a failure small");
  app.add_flag("!--no-shrink", a.shrink, "Report failures as they are");
  app.add_option("--replay", a.replay, "Cases that were kept, instead of seeds");
  app.add_option("--recipe", a.recipe, "One cloud, by its recipe as it was printed, instead of seeds");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error));
  }
  return a;
}

void tell(const Run& run) {
  for (const Finding& f : run.outcome.findings) {
    std::printf("%s: %s\n  %s\n", f.kind.c_str(), f.what.c_str(), run.recipe.line().c_str());
  }
  std::fflush(stdout);
}

bool has_kind(const Outcome& outcome, const std::string& kind) {
  return std::any_of(outcome.findings.begin(), outcome.findings.end(), [&](const Finding& f) { return f.kind == kind; });
}

void keep_small(const Run& run, const Finding& finding, const Demands& demands, const Arguments& a) {
  const auto fails = [&](const Case& c) { return has_kind(hold_apart(c, demands), finding.kind); };
  const Case small = shrink(run.recipe, fails, !is_statistical(finding.kind), a.attempts);
  std::printf("  smaller: %s (%zu points)\n", small.recipe.line().c_str(), small.scene.points.size());
  if (a.keep.empty()) return;
  const std::string name = a.keep + "/" + finding.kind + "_" + run.recipe.text("seed") + ".txt";
  std::ofstream out(name, std::ios::binary);
  out << to_text(small);
  if (!out.flush()) throw IoError(IoError::Kind::kFailed, "cannot write " + name);
  std::printf("  kept: %s\n", name.c_str());
}

double time_per_point(const Run& run) { return run.outcome.cpu_seconds / (run.recipe.number("points") + kSetUp); }

// What is asked for: methods and given depths have times of their own.
std::string kind_of(const Recipe& recipe) {
  std::string kind;
  for (const char* key : {"preset", "method", "accuracy", "depth"}) {
    if (recipe.has(key)) kind += std::string(" ") + key + '=' + recipe.text(key);
  }
  return kind;
}

// Runs that take many times the median of their kind, told when all are known.
void find_slow(std::vector<Run>& runs) {
  std::map<std::string, std::vector<double>> times;
  for (const Run& run : runs) {
    if (run.outcome.cpu_seconds > 0) times[kind_of(run.recipe)].push_back(time_per_point(run));
  }
  for (auto& [kind, all] : times) {
    if (all.size() < kForMedian) continue;
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    std::printf("median time per point%s: %.1f us\n", kind.c_str(), 1e6 * *middle);
    for (Run& run : runs) {
      const double ratio = time_per_point(run) / *middle;
      if (kind_of(run.recipe) != kind || ratio <= kManyTimes) continue;
      run.outcome.findings = {{"slow", std::to_string(ratio) + " times the median time per point"}};
      tell(run);
    }
  }
}

int summary(const std::vector<Run>& runs, std::map<std::string, std::size_t> findings) {
  std::size_t refused = 0;
  std::size_t warned = 0;
  std::size_t judged = 0;
  std::size_t touching = 0;
  for (const Run& run : runs) {
    refused += run.outcome.refused ? 1 : 0;
    warned += run.outcome.warned ? 1 : 0;
    touching += run.outcome.touches ? 1 : 0;
    judged += run.outcome.wrong > 0 ? 1 : 0;
    if (has_kind(run.outcome, "slow")) ++findings["slow"];
  }
  std::printf("%zu clouds: %zu refused, %zu with a warning of sides, %zu with a wrong side, %zu with a mesh that touches itself\n",
              runs.size(), refused, warned, judged, touching);
  for (const auto& [kind, count] : findings) std::printf("  %s: %zu\n", kind.c_str(), count);
  if (findings.empty()) std::printf("  no finding\n");
  return findings.empty() ? 0 : 1;
}

int run_seeds(Arguments a) {
  const Demands demands{a.program};
  const std::optional<Recipe> given = a.recipe.empty() ? std::nullopt : std::optional(Recipe(a.recipe));
  if (given) a.count = 1;
  const auto start = std::chrono::steady_clock::now();
  std::vector<Run> runs;
  std::map<std::string, std::size_t> findings;
  for (std::uint64_t i = 0; i < a.count; ++i) {
    if (a.seconds > 0 && std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > a.seconds) break;
    Run run{given ? *given : random_recipe(a.seed + i, a.largest), {}};
    run.outcome = hold_apart(run.recipe, demands);
    tell(run);
    for (const Finding& f : run.outcome.findings) {
      ++findings[f.kind];
      if (a.shrink) keep_small(run, f, demands, a);
    }
    runs.push_back(std::move(run));
  }
  find_slow(runs);
  return summary(runs, findings);
}

int replay(const Arguments& a) {
  std::map<std::string, std::size_t> findings;
  std::vector<Run> runs;
  for (const std::string& name : a.replay) {
    std::ifstream in(name, std::ios::binary);
    const Case kept = from_text({std::istreambuf_iterator<char>(in), {}});
    runs.push_back({kept.recipe, hold_apart(kept, {a.program})});
    tell(runs.back());
    for (const Finding& f : runs.back().outcome.findings) ++findings[f.kind];
  }
  return summary(runs, findings);
}

}  // namespace
}  // namespace g3r::stress

int main(int argc, char** argv) {
  try {
    const g3r::stress::Arguments a = g3r::stress::parse(argc, argv);
    return a.replay.empty() ? g3r::stress::run_seeds(a) : g3r::stress::replay(a);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "g3r_bench_stress: %s\n", error.what());
    return 2;
  }
}
