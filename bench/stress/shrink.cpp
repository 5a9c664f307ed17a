// Sources: points are left out in ever smaller runs (Zeller and Hildebrandt, "Simplifying and isolating failure-inducing input", 2002).
#include "shrink.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace g3r::stress {
namespace {

class Shrinker {
 public:
  Shrinker(Case failing, const std::function<bool(const Case&)>& fails, int attempts)
      : best_(std::move(failing)), fails_(fails), attempts_(attempts) {}

  void drop_words() {
    const std::vector<std::string> keys = words();
    for (const std::string& key : keys) {
      Recipe simpler = best_.recipe;
      simpler.erase(key);
      try_recipe(simpler);
    }
    while (best_.recipe.number("parts", 1) > 1 && try_number("parts", best_.recipe.number("parts") - 1)) {
    }
  }

  void halve_points() {
    while (best_.recipe.number("points", 4) > 8 &&
           try_number("points", static_cast<double>(static_cast<int>(best_.recipe.number("points") / 2)))) {
    }
  }

  void leave_out_points() {
    for (std::size_t run = best_.scene.points.size() / 2; run > 0; run /= 2) {
      for (std::size_t from = 0; from < best_.scene.points.size() && attempts_ > 0;) {
        Case fewer = best_;
        erase(fewer.scene.points, from, run);
        erase(fewer.scene.truth, from, run);
        if (!try_case(std::move(fewer))) from += run;
      }
    }
  }

  [[nodiscard]] Case best() && { return std::move(best_); }

 private:
  static void erase(std::vector<Vec3>& values, std::size_t from, std::size_t count) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(from);
    values.erase(begin, begin + static_cast<std::ptrdiff_t>(std::min(count, values.size() - from)));
  }

  [[nodiscard]] std::vector<std::string> words() const {
    std::vector<std::string> keys;
    for (const auto& [key, value] : best_.recipe.words()) {
      if (key != "seed" && key != "shape" && key != "points" && key != "parts") keys.push_back(key);
    }
    return keys;
  }

  bool try_number(const std::string& key, double value) {
    Recipe simpler = best_.recipe;
    simpler.set(key, value);
    return try_recipe(simpler);
  }

  bool try_recipe(const Recipe& recipe) { return attempts_ > 0 && try_case({recipe, make_scene(recipe)}); }

  bool try_case(Case simpler) {
    if (attempts_ <= 0) return false;
    --attempts_;
    if (!fails_(simpler)) return false;
    best_ = std::move(simpler);
    return true;
  }

  Case best_;
  const std::function<bool(const Case&)>& fails_;
  int attempts_;
};

}  // namespace

Case shrink(const Recipe& recipe, const std::function<bool(const Case&)>& fails, bool thin, int attempts) {
  Shrinker shrinker({recipe, make_scene(recipe)}, fails, attempts);
  shrinker.drop_words();
  if (thin) {
    shrinker.halve_points();
    shrinker.leave_out_points();
  }
  return std::move(shrinker).best();
}

}  // namespace g3r::stress
