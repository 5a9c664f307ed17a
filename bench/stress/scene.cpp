#include "scene.h"

#include <g3r/error.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "sampling.h"
#include "shapes.h"

namespace g3r::stress {
namespace {

using shapes::Random;

constexpr double kFar = 1000;                    // of the strayed point, in sizes of the cloud
constexpr double kOutlierBox = 1.2;              // half side of the box of the outliers
constexpr Vec3 kUtm{432123.5, 5412345.25, 611};  // metres
constexpr Vec3 kEcef{4158123.25, 687321.5, 4771234.75};

// Points along a closed curve: there is no surface.
std::vector<Vec3> on_curve(std::size_t count, Random& random) {
  const double turns = std::floor(random.uniform(1, 5));
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = random.uniform(0, 6.283185307179586);
    const double r = 0.7 + 0.3 * std::cos(turns * t);
    points.push_back({r * std::cos(t), r * std::sin(t), 0.3 * std::sin(turns * t)});
  }
  return points;
}

std::vector<Vec3> in_volume(std::size_t count, Random& random) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  return points;
}

// Noise and rounding move points, outliers take the place of some.
void spoil(const Recipe& recipe, double spacing, Random& random, Scene& scene) {
  const double noise = recipe.number("noise") * spacing;
  const double step = recipe.number("step") * spacing;
  const double outliers = recipe.number("outliers");
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    for (double& c : scene.points[i]) {
      c += noise * random.gaussian();
      if (step > 0) c = step * std::round(c / step);
    }
    if (outliers > 0 && random.uniform() < outliers) {
      for (double& c : scene.points[i]) c = random.uniform(-kOutlierBox, kOutlierBox);
      scene.truth[i] = {0, 0, 0};
    }
  }
}

void add_points(const Recipe& recipe, Random& random, Scene& scene) {
  const std::size_t sampled = scene.points.size();
  if (sampled == 0) return;
  const auto copies = static_cast<std::size_t>(recipe.number("duplicates") * static_cast<double>(sampled));
  for (std::size_t i = 0; i < copies; ++i) {
    const std::size_t from = random.bits() % sampled;
    scene.points.push_back(scene.points[from]);
    scene.truth.push_back(scene.truth[from]);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(recipe.number("missing")); ++i) {
    Vec3 p = scene.points[random.bits() % sampled];
    p[i % 3] = i % 2 == 0 ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
    scene.points.push_back(p);
    scene.truth.push_back({0, 0, 0});
  }
  if (recipe.number("far") != 0) {
    Vec3 p = random.direction();
    for (double& c : p) c *= kFar;
    scene.points.push_back(p);
    scene.truth.push_back({0, 0, 0});
  }
}

// Other units of the axes turn normals by their inverse; then the offset, and what single precision leaves of it.
void to_world(const Recipe& recipe, Scene& scene) {
  const Vec3 unit{recipe.number("unit_x", 1), recipe.number("unit_y", 1), recipe.number("unit_z", 1)};
  const std::string name = recipe.text("offset", "none");
  if (name != "none" && name != "utm" && name != "ecef") throw InvalidInput("no offset is called " + name);
  const Vec3 offset = name == "utm" ? kUtm : name == "ecef" ? kEcef : Vec3{0, 0, 0};
  const bool single = recipe.number("float32") != 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    Vec3& n = scene.truth[i];
    for (std::size_t k = 0; k < 3; ++k) {
      double& c = scene.points[i][k];
      c = c * unit[k] + offset[k];
      if (single) c = static_cast<double>(static_cast<float>(c));
      n[k] /= unit[k];
    }
    const double size = std::hypot(n[0], n[1], n[2]);
    for (double& c : n) c = size > 0 ? c / size : 0;
  }
}

void shuffle(Random& random, Scene& scene) {
  for (std::size_t i = scene.points.size(); i > 1; --i) {
    const std::size_t j = random.bits() % i;
    std::swap(scene.points[i - 1], scene.points[j]);
    std::swap(scene.truth[i - 1], scene.truth[j]);
  }
}

const char* name_of(Sides sides) { return sides == Sides::kKnown ? "known" : sides == Sides::kEither ? "either" : "none"; }

double to_number(const std::string& word) {
  double out = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  if (error != std::errc() || end != word.data() + word.size()) throw InvalidInput("not a number: " + word);
  return out;
}

}  // namespace

Scene make_scene(const Recipe& recipe) {
  const auto seed = static_cast<std::uint64_t>(recipe.number("seed"));
  const auto count = static_cast<std::size_t>(recipe.number("points", 100));
  const std::string family = recipe.text("shape", "solid");
  Random random(seed ^ 0x7363656e65ULL);
  Scene scene;
  double area = 6;  // of the unit cube, where there is no surface
  if (family == "curve" || family == "volume") {
    scene.points = family == "curve" ? on_curve(count, random) : in_volume(count, random);
    scene.truth.resize(scene.points.size());
  } else {
    const Shape shape = make_shape(family, static_cast<int>(recipe.number("parts", 1)), seed);
    Sampled sampled = sample(shape, recipe.text("sampling", "uniform"), count, seed);
    scene.points = std::move(sampled.points);
    scene.sides = shape.sides;
    area = sampled.area;
    for (const Vec3& p : scene.points) scene.truth.push_back(normal_of(shape, p));
  }
  spoil(recipe, std::sqrt(area / static_cast<double>(std::max<std::size_t>(count, 1))), random, scene);
  add_points(recipe, random, scene);
  to_world(recipe, scene);
  shuffle(random, scene);
  return scene;
}

std::string to_text(const Case& kept) {
  std::string out = kept.recipe.line() + "\n" + name_of(kept.scene.sides) + "\n";
  std::array<char, 32> digits{};
  for (std::size_t i = 0; i < kept.scene.points.size(); ++i) {
    for (const Vec3* v : {&kept.scene.points[i], &kept.scene.truth[i]}) {
      for (const double c : *v) {
        out.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), c).ptr);
        out += v == &kept.scene.truth[i] && &c == &v->back() ? '\n' : ' ';
      }
    }
  }
  return out;
}

Case from_text(const std::string& text) {
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);
  Case kept{Recipe(line), {}};
  std::getline(in, line);
  if (line != "known" && line != "either" && line != "none") throw InvalidInput("the second line of a case says known, either or none");
  kept.scene.sides = line == "known" ? Sides::kKnown : line == "either" ? Sides::kEither : Sides::kNone;
  std::vector<double> row;
  for (std::string word; in >> word;) {
    row.push_back(to_number(word));
    if (row.size() < 6) continue;
    kept.scene.points.push_back({row[0], row[1], row[2]});
    kept.scene.truth.push_back({row[3], row[4], row[5]});
    row.clear();
  }
  if (!row.empty()) throw InvalidInput("a line of a case has six numbers");
  return kept;
}

}  // namespace g3r::stress
