// The words that options are given by, one list for the library, the program, Python and the reports; and the bounds of their numbers.
//
//   g3r::name_of(g3r::Method::kGreen)          // "green"
//   g3r::parse<g3r::Method>("green")           // Method::kGreen; empty for another word
//   g3r::words<g3r::Method>()                  // "auto, green, energy, wnnc, agr, pgr"
//   g3r::parse_length("0.5%")                  // half a percent of the diagonal
#pragma once

#include <g3r/export.h>
#include <g3r/g3r.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace G3R_PUBLIC g3r {

/// The words of an enumeration, in the order in which messages list them.
template <class Value>
struct Names;
template <>
struct Names<Preset> {
  static constexpr std::pair<std::string_view, Preset> kAll[] = {{"default", Preset::kDefault}, {"paper", Preset::kPaper}};
};
template <>
struct Names<Method> {
  static constexpr std::pair<std::string_view, Method> kAll[] = {{"auto", Method::kAuto},     {"green", Method::kGreen},
                                                                 {"energy", Method::kEnergy}, {"wnnc", Method::kWnnc},
                                                                 {"agr", Method::kAgr},       {"pgr", Method::kPgr}};
};
template <>
struct Names<Solver> {
  static constexpr std::pair<std::string_view, Solver> kAll[] = {
      {"auto", Solver::kAuto}, {"dense", Solver::kDense}, {"cg", Solver::kConjugateGradient}};
};
template <>
struct Names<Mesher> {
  static constexpr std::pair<std::string_view, Mesher> kAll[] = {
      {"auto", Mesher::kAuto}, {"field", Mesher::kField}, {"poisson", Mesher::kPoisson}};
};
template <>
struct Names<MeshOptions::Trim> {
  static constexpr std::pair<std::string_view, MeshOptions::Trim> kAll[] = {
      {"off", MeshOptions::Trim::kOff}, {"auto", MeshOptions::Trim::kAuto}, {"distance", MeshOptions::Trim::kDistance}};
};
/// What follows the number of a length.
template <>
struct Names<Length::Unit> {
  static constexpr std::pair<std::string_view, Length::Unit> kAll[] = {
      {"", Length::Unit::kInput}, {"%", Length::Unit::kPercent}, {"h", Length::Unit::kSpacing}, {"n", Length::Unit::kNormalised}};
};

/// The word of a value; empty if it has none.
template <class Value>
[[nodiscard]] constexpr std::string_view name_of(Value value) {
  for (const auto& [word, named] : Names<Value>::kAll) {
    if (named == value) return word;
  }
  return {};
}

/// The value of a word; empty for a word of no value.
template <class Value>
[[nodiscard]] constexpr std::optional<Value> parse(std::string_view text) {
  for (const auto& [word, named] : Names<Value>::kAll) {
    if (word == text) return named;
  }
  return std::nullopt;
}

/// All words, each between `quote`s, for messages.
template <class Value>
[[nodiscard]] std::string words(std::string_view quote = "") {
  std::string out;
  for (const auto& [word, named] : Names<Value>::kAll) {
    out.append(out.empty() ? "" : ", ").append(quote).append(word).append(quote);
  }
  return out;
}

/// The largest Options::degree: it has 81 harmonics, and 16 already have only 8 % less error than 4 (docs/evidence/formulation.md).
inline constexpr int kMostDegree = 8;
/// The bounds of MeshOptions::depth: no leaf is larger than at depth 4, and depth 12 may take tens of gigabytes.
inline constexpr int kLeastMeshDepth = 4, kMostMeshDepth = 12;

/// "auto", or a finite number, 0 or more, and a unit: "0.8h", "0.5%", "2". Empty for anything else.
[[nodiscard]] std::optional<Length> parse_length(std::string_view text);

/// Three finite numbers: "1,-2.5,3e2". Empty for anything else.
[[nodiscard]] std::optional<Vec3> parse_vector(std::string_view text);

/// Three finite numbers that are not all 0, or an axis with an optional sign: "z", "+Z", "-y". Empty for anything else.
[[nodiscard]] std::optional<Vec3> parse_direction(std::string_view text);

}  // namespace g3r
