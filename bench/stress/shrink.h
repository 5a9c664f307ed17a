// Makes a failing case as simple as it gets.
#pragma once

#include <functional>

#include "scene.h"

namespace g3r::stress {

/// Leaves out words of the recipe, then (with `thin`) halves the number of points and leaves out points, as long as `fails` stays true.
/// `fails` is called at most `attempts` times. `recipe` must fail; the result does.
[[nodiscard]] Case shrink(const Recipe& recipe, const std::function<bool(const Case&)>& fails, bool thin, int attempts);

}  // namespace g3r::stress
