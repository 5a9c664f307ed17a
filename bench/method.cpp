#include "method.h"

#include <g3r/error.h>

#include <charconv>
#include <sstream>

namespace g3r::bench {

namespace {

constexpr int kPaperDepth = 10;

template <class Number>
Number number(const std::string& key, const std::string& text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) throw InvalidInput("option " + key + ": '" + text + "' is not a number");
  return value;
}

Epsilon parse_epsilon(std::string text) {
  using Unit = Epsilon::Unit;
  if (text == "auto" || text.empty()) return {};
  Unit unit = Unit::kInput;
  const char last = text.back();
  if (last == '%') unit = Unit::kPercent;
  if (last == 'h') unit = Unit::kSpacing;
  if (last == 'n') unit = Unit::kNormalised;
  if (unit != Unit::kInput) text.pop_back();
  return {unit, number<double>("epsilon", text)};
}

Solver parse_solver(const std::string& text) {
  if (text == "auto") return Solver::kAuto;
  if (text == "dense") return Solver::kDense;
  if (text == "cg") return Solver::kConjugateGradient;
  throw InvalidInput("solver '" + text + "' is none of auto, dense, cg");
}

void set_option(Method& method, const std::string& key, const std::string& value) {
  if (key == "epsilon") {
    method.options.epsilon = parse_epsilon(value);
  } else if (key == "degree") {
    method.options.degree = number<int>(key, value);
  } else if (key == "harmonics") {
    method.options.harmonics = value;
  } else if (key == "solver") {
    method.options.solver = parse_solver(value);
  } else if (key == "schedule") {
    method.options.schedule = value;
  } else if (key == "tolerance") {
    method.options.tolerance = number<double>(key, value);
  } else if (key == "accuracy") {
    method.options.accuracy = number<double>(key, value);
  } else if (key == "depth") {
    method.mesh.depth = number<int>(key, value);
  } else {
    throw InvalidInput("method option '" + key + "' is none of epsilon, degree, harmonics, solver, schedule, tolerance, accuracy, depth");
  }
}

}  // namespace

Method parse_method(const std::string& text) {
  Method method;
  method.name = text;
  std::istringstream parts(text);
  std::string part;
  std::getline(parts, part, ';');
  if (part == "paper") {
    method.options.preset = Preset::kPaper;
    method.mesh.depth = kPaperDepth;
  } else if (part != "default") {
    throw InvalidInput("method '" + text + "' does not begin with default or paper");
  }
  while (std::getline(parts, part, ';')) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) throw InvalidInput("method '" + text + "': '" + part + "' is not KEY=VALUE");
    set_option(method, part.substr(0, equals), part.substr(equals + 1));
  }
  return method;
}

}  // namespace g3r::bench
