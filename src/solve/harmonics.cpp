// Sources: Caola 1978 and Hobson 1931 for the Cartesian recurrences of r^l P_l^m(cos theta) {cos, sin}(m phi).
#include "solve/harmonics.h"

#include <g3r/error.h>
#include <g3r/names.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

namespace g3r {
namespace {

static_assert(kMaxHarmonicDegree == kMostDegree);
constexpr int kStride = kMaxHarmonicDegree + 1;

struct NamedHarmonic {
  std::string_view name;
  Harmonic harmonic;
};
constexpr std::array<NamedHarmonic, 9> kNames{{{"1", {0, 0}},
                                               {"y", {1, -1}},
                                               {"z", {1, 0}},
                                               {"x", {1, 1}},
                                               {"xy", {2, -2}},
                                               {"yz", {2, -1}},
                                               {"z2", {2, 0}},
                                               {"xz", {2, 1}},
                                               {"x2-y2", {2, 2}}}};

// A polynomial's value and gradient at one point; products follow the product rule.
struct Jet {
  double value = 0;
  Vec3 gradient{0, 0, 0};
};
Jet operator*(double s, const Jet& a) { return {s * a.value, {s * a.gradient[0], s * a.gradient[1], s * a.gradient[2]}}; }
Jet operator+(const Jet& a, const Jet& b) {
  return {a.value + b.value, {a.gradient[0] + b.gradient[0], a.gradient[1] + b.gradient[1], a.gradient[2] + b.gradient[2]}};
}
Jet operator-(const Jet& a, const Jet& b) { return a + (-1.0) * b; }
Jet operator*(const Jet& a, const Jet& b) {
  Jet c{a.value * b.value, {}};
  for (std::size_t k = 0; k < 3; ++k) c.gradient[k] = a.gradient[k] * b.value + a.value * b.gradient[k];
  return c;
}

// cos_part[l * kStride + m] = r^l P_l^m cos(m phi) / (2m-1)!!-type normalisation folded into norm(); likewise sin_part.
struct SolidHarmonics {
  std::array<Jet, static_cast<std::size_t>(kStride) * kStride> cos_part;
  std::array<Jet, static_cast<std::size_t>(kStride) * kStride> sin_part;
};

std::size_t at(int l, int m) { return static_cast<std::size_t>(l * kStride + m); }

SolidHarmonics solid_harmonics(const Vec3& p, int max_degree) {
  const Jet x{p[0], {1, 0, 0}};
  const Jet y{p[1], {0, 1, 0}};
  const Jet z{p[2], {0, 0, 1}};
  const Jet r2 = x * x + y * y + z * z;
  SolidHarmonics h;
  h.cos_part[0] = {1, {0, 0, 0}};
  for (int m = 0; m <= max_degree; ++m) {
    if (m > 0) {  // (x + iy)^m
      const Jet& c = h.cos_part[at(m - 1, m - 1)];
      const Jet& s = h.sin_part[at(m - 1, m - 1)];
      h.cos_part[at(m, m)] = x * c - y * s;
      h.sin_part[at(m, m)] = x * s + y * c;
    }
    for (int l = m + 1; l <= max_degree; ++l) {  // (l - m) Q_l = (2l - 1) z Q_{l-1} - (l + m - 1) r^2 Q_{l-2}
      const double a = (2.0 * l - 1) / (l - m);
      const double b = (l + m - 1.0) / (l - m);
      const auto raise = [&](auto& part) {
        part[at(l, m)] = (a * z) * part[at(l - 1, m)];
        if (l - 2 >= m) part[at(l, m)] = part[at(l, m)] - (b * r2) * part[at(l - 2, m)];
      };
      raise(h.cos_part);
      raise(h.sin_part);
    }
  }
  return h;
}

// Makes the harmonic orthonormal on the sphere. The recurrence above yields P_l^m / (2m - 1)!!.
double norm(int l, int m) {
  double ratio = (2.0 * l + 1) / (4 * std::numbers::pi);  // (2l+1)/(4 pi) (l-m)!/(l+m)! ((2m-1)!!)^2
  for (int k = l - m + 1; k <= l + m; ++k) ratio /= k;
  for (int k = 1; k <= m; ++k) ratio *= (2.0 * k - 1) * (2.0 * k - 1);
  return std::sqrt(m == 0 ? ratio : 2 * ratio);
}

[[noreturn]] void bad_harmonics(const std::string& text, std::string_view item) {
  throw InvalidInput("harmonics \"" + text + "\": cannot understand \"" + std::string(item) +
                     "\"; use names (1 x y z xy yz z2 xz x2-y2), l:m, degree:L or degree:A-B, separated by commas");
}

int parse_int(std::string_view digits, const std::string& text, std::string_view item) {
  int value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) bad_harmonics(text, item);
  return value;
}

std::vector<Harmonic> parse_item(const std::string& text, std::string_view item) {
  for (const NamedHarmonic& named : kNames) {
    if (item == named.name) return {named.harmonic};
  }
  constexpr std::string_view kDegree = "degree:";
  if (item.substr(0, kDegree.size()) == kDegree) {
    const std::string_view range = item.substr(kDegree.size());
    const std::size_t dash = range.find('-');
    const int first = parse_int(range.substr(0, dash), text, item);
    const int last = dash == std::string_view::npos ? first : parse_int(range.substr(dash + 1), text, item);
    if (first < 0 || last < first || last > kMaxHarmonicDegree) bad_harmonics(text, item);
    return harmonics_of_degrees(first, last);
  }
  const std::size_t colon = item.find(':');
  if (colon == std::string_view::npos) bad_harmonics(text, item);
  const Harmonic h{parse_int(item.substr(0, colon), text, item), parse_int(item.substr(colon + 1), text, item)};
  if (h.degree < 0 || h.degree > kMaxHarmonicDegree || std::abs(h.order) > h.degree) bad_harmonics(text, item);
  return {h};
}

}  // namespace

std::vector<Harmonic> harmonics_of_degrees(int first, int last) {
  std::vector<Harmonic> set;
  for (int l = first; l <= last; ++l) {
    for (int m = -l; m <= l; ++m) set.push_back({l, m});
  }
  return set;
}

std::vector<Harmonic> parse_harmonics(const std::string& text) {
  std::vector<Harmonic> set;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t comma = rest.find(',');
    std::string_view item = rest.substr(0, comma);
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
    while (!item.empty() && item.front() == ' ') item.remove_prefix(1);
    while (!item.empty() && item.back() == ' ') item.remove_suffix(1);
    for (const Harmonic& h : parse_item(text, item)) {
      if (std::find(set.begin(), set.end(), h) != set.end()) {
        throw InvalidInput("harmonics \"" + text + "\": \"" + std::string(item) + "\" is named twice");
      }
      set.push_back(h);
    }
  }
  if (set.empty()) throw InvalidInput("harmonics: the list is empty; the default is degree:0-2");
  return set;
}

std::string format_harmonics(const std::vector<Harmonic>& set) {
  const int first = set.empty() ? 0 : set.front().degree;
  const int last = set.empty() ? 0 : set.back().degree;
  if (set == harmonics_of_degrees(first, last)) {
    std::string range = "degree:";
    range += std::to_string(first);
    if (last > first) range.append("-").append(std::to_string(last));
    return range;
  }
  std::string text;
  for (const Harmonic& h : set) {
    if (!text.empty()) text += ',';
    const auto named = std::find_if(kNames.begin(), kNames.end(), [&](const NamedHarmonic& n) { return n.harmonic == h; });
    text += named != kNames.end() ? std::string(named->name) : std::to_string(h.degree) + ":" + std::to_string(h.order);
  }
  return text;
}

HarmonicValues evaluate_harmonics(const std::vector<Harmonic>& set, const std::vector<Vec3>& points) {
  int max_degree = 0;
  for (const Harmonic& h : set) max_degree = std::max(max_degree, h.degree);
  HarmonicValues out;
  out.count = set.size();
  out.value.reserve(set.size() * points.size());
  out.gradient.reserve(set.size() * points.size());
  for (const Vec3& p : points) {
    const SolidHarmonics h = solid_harmonics(p, max_degree);
    for (const Harmonic& u : set) {
      const int m = std::abs(u.order);
      const Jet jet = norm(u.degree, m) * (u.order < 0 ? h.sin_part : h.cos_part)[at(u.degree, m)];
      out.value.push_back(jet.value);
      out.gradient.push_back(jet.gradient);
    }
  }
  return out;
}

}  // namespace g3r
