#include "variant.h"

#include <g3r/error.h>

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

Length parse_length(const std::string& key, std::string text) {
  using Unit = Length::Unit;
  if (text == "auto" || text.empty()) return {};
  Unit unit = Unit::kInput;
  const char last = text.back();
  if (last == '%') unit = Unit::kPercent;
  if (last == 'h') unit = Unit::kSpacing;
  if (last == 'n') unit = Unit::kNormalised;
  if (unit != Unit::kInput) text.pop_back();
  return {unit, number<double>(key, text)};
}

Solver parse_solver(const std::string& text) {
  if (text == "auto") return Solver::kAuto;
  if (text == "dense") return Solver::kDense;
  if (text == "cg") return Solver::kConjugateGradient;
  throw InvalidInput("solver '" + text + "' is none of auto, dense, cg");
}

g3r::Method parse_equations(const std::string& text) {
  if (text == "green") return g3r::Method::kGreen;
  if (text == "energy") return g3r::Method::kEnergy;
  if (text == "wnnc") return g3r::Method::kWnnc;
  if (text == "agr") return g3r::Method::kAgr;
  if (text == "pgr") return g3r::Method::kPgr;
  throw InvalidInput("method '" + text + "' is none of green, energy, wnnc, agr, pgr");
}

Mesher parse_mesher(const std::string& text) {
  if (text == "field") return Mesher::kField;
  if (text == "poisson") return Mesher::kPoisson;
  throw InvalidInput("mesher '" + text + "' is none of field, poisson");
}

void set_option(Variant& variant, const std::string& key, const std::string& value) {
  if (key == "epsilon") {
    variant.options.epsilon = parse_length(key, value);
  } else if (key == "noise") {
    variant.options.noise = parse_length(key, value);
  } else if (key == "method") {
    variant.options.method = parse_equations(value);
  } else if (key == "widths") {
    variant.options.wnnc_widths = value;
  } else if (key == "degree") {
    variant.options.degree = number<int>(key, value);
  } else if (key == "harmonics") {
    variant.options.harmonics = value;
  } else if (key == "solver") {
    variant.options.solver = parse_solver(value);
  } else if (key == "schedule") {
    variant.options.schedule = value;
  } else if (key == "without") {
    variant.options.without = value;
  } else if (key == "tolerance") {
    variant.options.tolerance = number<double>(key, value);
  } else if (key == "accuracy") {
    variant.options.accuracy = number<double>(key, value);
  } else if (key == "mesher") {
    variant.mesh.mesher = parse_mesher(value);
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
    variant.options.method = parse_equations(part);
  } else if (part == "true") {
    variant.true_normals = true;
  } else if (part != "default") {
    throw InvalidInput("method '" + text + "' does not begin with default, paper, wnnc, agr, pgr or true");
  }
  while (std::getline(parts, part, ';')) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) throw InvalidInput("method option '" + part + "' is not KEY=VALUE");
    set_option(variant, part.substr(0, equals), part.substr(equals + 1));
  }
  return variant;
}

}  // namespace g3r::bench
