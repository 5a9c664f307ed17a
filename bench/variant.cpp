#include "variant.h"

#include <g3r/error.h>
#include <g3r/names.h>

#include <charconv>
#include <sstream>

namespace g3r::bench {

namespace {

template <class Number>
Number number(const std::string& key, const std::string& text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) throw InvalidInput("option " + key + ": '" + text + "' is not a number");
  return value;
}

Length length(const std::string& key, const std::string& text) {
  const std::optional<Length> value = parse_length(text);
  if (!value) throw InvalidInput("option " + key + ": '" + text + "' is not auto or a number of 0 or more with a unit: none, %, h or n");
  return *value;
}

template <class Value>
Value choice(const std::string& key, const std::string& text) {
  const std::optional<Value> value = parse<Value>(text);
  if (!value) throw InvalidInput(key + " '" + text + "' is none of " + words<Value>());
  return *value;
}

void set_option(Variant& variant, const std::string& key, const std::string& value) {
  if (key == "epsilon") {
    variant.options.epsilon = length(key, value);
  } else if (key == "noise") {
    variant.options.noise = length(key, value);
  } else if (key == "method") {
    variant.options.method = choice<g3r::Method>(key, value);
  } else if (key == "widths") {
    variant.options.wnnc_widths = value;
  } else if (key == "degree") {
    variant.options.degree = number<int>(key, value);
  } else if (key == "harmonics") {
    variant.options.harmonics = value;
  } else if (key == "solver") {
    variant.options.solver = choice<Solver>(key, value);
  } else if (key == "schedule") {
    variant.options.schedule = value;
  } else if (key == "without") {
    variant.options.without = value;
  } else if (key == "tolerance") {
    variant.options.tolerance = number<double>(key, value);
  } else if (key == "accuracy") {
    variant.options.accuracy = number<double>(key, value);
  } else if (key == "mesher") {
    variant.mesh.mesher = choice<Mesher>(key, value);
  } else if (key == "depth") {
    variant.mesh.depth = number<int>(key, value);
  } else {
    throw InvalidInput(
        "method option '" + key +
        "' is none of method, widths, epsilon, noise, degree, harmonics, solver, schedule, without, tolerance, accuracy, mesher, depth");
  }
}

}  // namespace

Variant parse_variant(const std::string& text) {
  Variant variant;
  variant.name = text;
  std::istringstream parts(text);
  std::string part;
  std::getline(parts, part, ';');
  if (part == "paper") {
    variant.options.preset = Preset::kPaper;
  } else if (part == "wnnc" || part == "agr" || part == "pgr") {
    variant.options.method = choice<g3r::Method>("method", part);
  } else if (part == "true") {
    variant.true_normals = true;
  } else if (part == "ceiling") {
    variant.ceiling = true;
  } else if (part != "default") {
    throw InvalidInput("method '" + text + "' does not begin with default, paper, wnnc, agr, pgr, true or ceiling");
  }
  while (std::getline(parts, part, ';')) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) throw InvalidInput("method option '" + part + "' is not KEY=VALUE");
    set_option(variant, part.substr(0, equals), part.substr(equals + 1));
  }
  return variant;
}

}  // namespace g3r::bench
