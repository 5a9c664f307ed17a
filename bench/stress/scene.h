// A cloud with what is known of its normals, made from a recipe or read back from a case that was kept.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <string>
#include <vector>

#include "recipe.h"
#include "shape.h"

namespace g3r::stress {

struct Scene {
  std::vector<Vec3> points;
  std::vector<Vec3> truth;  ///< one per point: unit normal of the surface, (0, 0, 0) where none is known
  Sides sides = Sides::kNone;
};

/// The scene of the recipe: the same bytes for the same recipe.
[[nodiscard]] Scene make_scene(const Recipe& recipe);

/// A recipe and the cloud that belongs to it, which the shrinker may have thinned.
struct Case {
  Recipe recipe;
  Scene scene;
};

/// Text: the recipe, then the sides ("known", "either", "none"), then one line "x y z nx ny nz" a point, all digits.
[[nodiscard]] std::string to_text(const Case& kept);
/// Throws InvalidInput for anything else.
[[nodiscard]] Case from_text(const std::string& text);

}  // namespace g3r::stress
