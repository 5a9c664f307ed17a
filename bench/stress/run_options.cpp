#include "run_options.h"

#include <g3r/error.h>
#include <g3r/names.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "shapes.h"

namespace g3r::stress {
namespace {

using shapes::Random;

constexpr double kSmallFirst = 1.7;         // power of the uniform number that tells the size: a third is below 30 points of 20,000
constexpr std::size_t kSlowMethods = 2000;  // points up to which methods of more than linear time are drawn
constexpr double kCommon = 0.55;            // share of the runs without any option

template <std::size_t N>
std::string one_of(Random& random, const std::array<const char*, N>& words) {
  return words[random.bits() % N];
}

void draw_shape(Random& random, Recipe& recipe) {
  recipe.set("shape",
             one_of<11>(random, {"solid", "solid", "solid", "shell", "wire", "patch", "terrain", "room", "curve", "volume", "shell"}));
  recipe.set("parts", static_cast<double>(1 + random.bits() % 6));
  recipe.set("sampling", one_of<6>(random, {"uniform", "uniform", "uneven", "lines", "raster", "views"}));
}

void draw_defects(Random& random, Recipe& recipe) {
  const auto sometimes = [&](double share) { return random.uniform() < share; };
  if (sometimes(0.3)) recipe.set("noise", std::pow(10, random.uniform(-2, 0.2)));
  if (sometimes(0.15)) recipe.set("step", std::pow(10, random.uniform(-2, 0.3)));
  if (sometimes(0.15)) recipe.set("outliers", std::pow(10, random.uniform(-3, -0.5)));
  if (sometimes(0.15)) recipe.set("duplicates", std::pow(10, random.uniform(-2, 0.5)));
  if (sometimes(0.1)) recipe.set("missing", static_cast<double>(1 + random.bits() % 5));
  if (sometimes(0.05)) recipe.set("far", 1);
  if (sometimes(0.15)) recipe.set("float32", 1);
  if (sometimes(0.15)) recipe.set("offset", one_of<2>(random, {"utm", "ecef"}));
  if (sometimes(0.1)) recipe.set("unit_z", std::pow(10, random.uniform(-1, 1)));
  if (sometimes(0.1)) {
    const double all = std::pow(10, random.uniform(-12, 12));
    for (const char* axis : {"unit_x", "unit_y", "unit_z"}) recipe.set(axis, all * recipe.number(axis, 1));
  }
}

void draw_method(Random& random, bool small, Recipe& recipe) {
  const double kind = random.uniform();
  if (kind < 0.15) recipe.set("preset", "paper");
  if (kind > 0.8 && small) recipe.set("method", one_of<5>(random, {"green", "wnnc", "agr", "pgr", "energy"}));
  if (random.uniform() < 0.1) recipe.set("epsilon", one_of<4>(random, {"0.5h", "2h", "1%", "0.05n"}));
  if (random.uniform() < 0.1) recipe.set("accuracy", small ? one_of<3>(random, {"0", "1e-4", "0.1"}) : "0.1");
  if (random.uniform() < 0.05) recipe.set("tolerance", one_of<2>(random, {"1e-6", "0.3"}));
  if (random.uniform() < 0.05) recipe.set("schedule", one_of<3>(random, {"1_cg", "5_sd", "3_sd_30_cg"}));
  if (recipe.text("method") == "wnnc") {
    for (const char* none : {"epsilon", "tolerance", "schedule"}) recipe.erase(none);  // it has its own
  }
  const bool energy = recipe.text("preset") != "paper" && recipe.text("method", "energy") == "energy";
  if (energy && random.uniform() < 0.15) recipe.set("noise_given", one_of<4>(random, {"0", "0.3h", "1h", "1%"}));
}

void draw_mesh(Random& random, Recipe& recipe) {
  if (random.uniform() < 0.15) recipe.set("depth", static_cast<double>(4 + random.bits() % 4));
  if (random.uniform() < 0.15) recipe.set("faces", std::round(std::pow(10, random.uniform(0.5, 4))));
  if (random.uniform() < 0.1) recipe.set("keep_largest", static_cast<double>(1 + random.bits() % 3));
  if (random.uniform() < 0.1) recipe.set("min_component", static_cast<double>(random.bits() % 100));
  if (random.uniform() < 0.15) recipe.set("keep_all", 1);
  if (random.uniform() < 0.2) recipe.set("trim", "auto");
}

// The value of a key whose words are those of g3r/names.h; without the key, `otherwise`.
template <class Value>
Value choice_of(const Recipe& recipe, const std::string& key, Value otherwise) {
  if (!recipe.has(key)) return otherwise;
  const std::optional<Value> value = parse<Value>(recipe.text(key));
  if (!value) throw InvalidInput(key + " must be one of " + words<Value>() + ", not " + recipe.text(key));
  return *value;
}

Length length_of(const Recipe& recipe, const std::string& key) {
  const std::optional<Length> length = parse_length(recipe.text(key, "auto"));
  if (!length) throw InvalidInput(key + " is not a length: " + recipe.text(key));
  return *length;
}

struct Bounds {
  Vec3 low;
  Vec3 high;
  [[nodiscard]] Vec3 at(const Vec3& t) const {
    Vec3 p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = low[k] + t[k] * (high[k] - low[k]);
    return p;
  }
};

Bounds bounds_of(const std::vector<Vec3>& points) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Bounds out{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const Vec3& p : points) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!std::isfinite(p[k])) continue;
      out.low[k] = std::min(out.low[k], p[k]);
      out.high[k] = std::max(out.high[k], p[k]);
    }
  }
  return out;
}

Hints hints_of(const Case& of) {
  const Recipe& r = of.recipe;
  Hints hints;
  if (r.has("up")) hints.up = Vec3{0, 0, 1};
  if (r.has("sensor")) hints.sensors = {bounds_of(of.scene.points).at({0.4, 0.5, 3})};
  if (r.has("inside")) hints.inside = {bounds_of(of.scene.points).at({0.45, 0.5, 0.55})};
  hints.flip = r.has("flip");
  hints.seen_from_inside = r.has("seen_from_inside");
  return hints;
}

std::string schedule_of(const Recipe& recipe) {
  std::string text = recipe.text("schedule");
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string as_text(const Vec3& v) {
  std::string out;
  std::array<char, 32> digits{};
  for (const double c : v) {
    if (!out.empty()) out += ',';
    out.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), c).ptr);
  }
  return out;
}

}  // namespace

Recipe random_recipe(std::uint64_t seed, std::size_t largest) {
  Random random(seed * 0x9e3779b97f4a7c15ULL + 1);
  Recipe recipe;
  recipe.set("seed", static_cast<double>(seed));
  const double size = std::pow(random.uniform(), kSmallFirst);
  recipe.set("points", std::floor(4 * std::pow(static_cast<double>(largest) / 4, size)));
  draw_shape(random, recipe);
  draw_defects(random, recipe);
  if (random.uniform() < kCommon) return recipe;
  if (random.uniform() < 0.4) draw_method(random, recipe.number("points") <= kSlowMethods, recipe);
  if (random.uniform() < 0.5) draw_mesh(random, recipe);
  if (random.uniform() < 0.3) recipe.set(one_of<5>(random, {"up", "sensor", "inside", "flip", "seen_from_inside"}), 1);
  return recipe;
}

RunOptions run_options(const Case& of) {
  const Recipe& r = of.recipe;
  RunOptions out;
  out.options.device = "cpu";
  out.options.preset = choice_of(r, "preset", Preset::kDefault);
  out.options.method = choice_of(r, "method", Method::kAuto);
  out.options.degree = static_cast<int>(r.number("degree", -1));
  out.options.accuracy = r.number("accuracy", -1);
  out.options.tolerance = r.number("tolerance", -1);
  out.options.schedule = schedule_of(r);
  out.options.epsilon = length_of(r, "epsilon");
  out.options.noise = length_of(r, "noise_given");
  out.options.hints = hints_of(of);
  out.mesh.depth = static_cast<int>(r.number("depth"));
  out.mesh.faces = static_cast<std::size_t>(r.number("faces"));
  out.mesh.keep_largest = static_cast<std::size_t>(r.number("keep_largest"));
  if (r.has("min_component")) out.mesh.min_component = r.number("min_component");
  out.mesh.keep_all = r.has("keep_all");
  out.mesh.trim = choice_of(r, "trim", MeshOptions::Trim::kOff);
  return out;
}

std::vector<std::string> command_line_options(const Case& of) {
  const Recipe& r = of.recipe;
  std::vector<std::string> out{"--device", "cpu"};
  const auto add = [&](const std::string& flag, const std::string& value) {
    out.push_back(flag);
    if (!value.empty()) out.push_back(value);
  };
  for (const char* key : {"preset", "method", "degree", "accuracy", "tolerance", "epsilon", "depth", "faces", "trim"}) {
    if (r.has(key)) add(std::string("--") + key, r.text(key));
  }
  if (r.has("schedule")) add("--schedule", schedule_of(r));
  if (r.has("noise_given")) add("--noise", r.text("noise_given"));
  if (r.has("keep_largest")) add("--keep-largest", r.text("keep_largest"));
  if (r.has("min_component")) add("--min-component", r.text("min_component"));
  if (r.has("keep_all")) add("--keep-all", "");
  const Hints hints = hints_of(of);
  if (hints.up) add("--up", as_text(*hints.up));
  for (const Vec3& p : hints.sensors) add("--sensor", as_text(p));
  for (const Vec3& p : hints.inside) add("--inside", as_text(p));
  if (hints.flip) add("--flip", "");
  if (hints.seen_from_inside) add("--seen-from-inside", "");
  return out;
}

bool has_other_method(const Recipe& recipe) {
  for (const char* key : {"preset", "method", "epsilon", "accuracy", "tolerance", "schedule", "noise_given"}) {
    if (recipe.has(key)) return true;
  }
  return false;
}

}  // namespace g3r::stress
