// Options from keyword arguments, as more than one part of the module reads them.
#pragma once

#include <g3r/error.h>
#include <g3r/hints.h>

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "arrays.h"

namespace g3r::python {

/// What a value of an option has to be.
template <class T>
constexpr const char* kind_of() {
  if (std::is_same_v<T, bool>) return "True or False";
  if (std::is_unsigned_v<T>) return "an integer, 0 or more";
  if (std::is_integral_v<T>) return "an integer";
  if (std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>>) return "a number";
  return "a text";
}

/// Reads one option from keyword arguments, if it is there. Throws InvalidInput for a value of another kind.
template <class T>
void take(const nb::dict& from, const char* name, T& into) {
  if (!from.contains(name)) return;
  try {
    into = nb::cast<T>(from[name]);
  } catch (const std::bad_cast&) {
    throw InvalidInput(std::string(name) + " must be " + kind_of<T>() + ", not " + nb::cast<std::string>(nb::repr(from[name])));
  }
}

/// The hints of g3r/_hints.py.
Hints read_hints(const nb::dict& from);

}  // namespace g3r::python
