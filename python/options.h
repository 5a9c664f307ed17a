// Options from keyword arguments, as more than one part of the module reads them.
#pragma once

#include <g3r/hints.h>

#include <cstdint>
#include <vector>

#include "arrays.h"

namespace g3r::python {

/// Reads one option from keyword arguments, if it is there.
template <class T>
void take(const nb::dict& from, const char* name, T& into) {
  if (from.contains(name)) into = nb::cast<T>(from[name]);
}

/// The hints of g3r/_hints.py.
Hints read_hints(const nb::dict& from);

}  // namespace g3r::python
