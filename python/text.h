// Texts that need not be UTF-8: names of files, and what files say.
#pragma once

#include <g3r/io.h>

#include <string>
#include <vector>

#include <nanobind/nanobind.h>

namespace g3r::python {

namespace nb = nanobind;

/// The name of a file, as os.fsencode() gives it.
inline std::string name_of(const nb::bytes& path) { return {path.c_str(), path.size()}; }

/// Words of a file without loss: bytes that are no UTF-8 become surrogates, as in names of files.
inline nb::list exact_texts(const std::vector<std::string>& texts) {
  nb::list out;
  for (const std::string& text : texts) {
    PyObject* word = PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape");
    if (word == nullptr) throw nb::python_error();
    out.append(nb::steal(word));
  }
  return out;
}

/// Lines to print.
inline std::vector<std::string> printable(std::vector<std::string> lines) {
  for (std::string& line : lines) line = escape_text(line);
  return lines;
}

/// Warns who called the function of the package that calls the module.
inline void warn_caller(const std::vector<std::string>& warnings) {
  constexpr Py_ssize_t kCaller = 2;  // frames up
  for (const std::string& warning : printable(warnings)) {
    if (PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), kCaller) < 0) throw nb::python_error();
  }
}

}  // namespace g3r::python
