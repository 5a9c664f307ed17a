// Random recipes, and the options of the library and the program that a recipe names. Keys, beside those of recipe.h:
//   preset, method, degree, accuracy, tolerance, schedule, epsilon, noise_given, depth, faces, keep_largest, min_component, keep_all, trim
//   up, sensor, inside, flip, seen_from_inside   1: that hint, placed by the cloud
#pragma once

#include <g3r/g3r.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scene.h"

namespace g3r::stress {

struct RunOptions {
  Options options;
  MeshOptions mesh;
};

/// A recipe with at most `largest` points, small ones more often than large ones. The same for the same seed.
[[nodiscard]] Recipe random_recipe(std::uint64_t seed, std::size_t largest);

/// Throws InvalidInput for a value that is none.
[[nodiscard]] RunOptions run_options(const Case& of);

/// The same as words of the command line.
[[nodiscard]] std::vector<std::string> command_line_options(const Case& of);

/// Whether the recipe asks for another method than the default one, of whose confidence less is promised.
[[nodiscard]] bool has_other_method(const Recipe& recipe);

}  // namespace g3r::stress
