#include "baselines/wnnc.h"

#include "base/vector.h"
#include "baselines/hard_cutoff.h"
#include "solve/refine.h"

#include <g3r/error.h>

#include <array>
#include <cmath>
#include <utility>

namespace g3r {
namespace {

// The first and the last width in spacings: near 50,000 points they are those of the authors' clean preset, which fits that density alone.
constexpr WnncWidths kRelativeWidths{2.8, 0.35};
constexpr std::array<std::pair<const char*, WnncWidths>, 6> kPublishedWidths{{{"clean", {0.016, 0.002}},
                                                                              {"scan", {0.04, 0.01}},
                                                                              {"noise-0.25", {0.08, 0.02}},
                                                                              {"noise-0.5", {0.12, 0.03}},
                                                                              {"noise-1", {0.16, 0.04}},
                                                                              {"sparse", {0.2, 0.05}}}};

double squared_norm(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return sum;
}

double squared_norm(const std::vector<Vec3>& values) {
  double sum = 0;
  for (const Vec3& v : values) sum += vector::dot(v, v);
  return sum;
}

// eta += |r|^2/|W r|^2 r with r = W^T (1/2 - W eta). Returns |1/2 - W eta| / |1/2|.
double descend(HardCutoffSum& sum, std::vector<Vec3>& eta) {
  std::vector<double> missing = sum.winding(eta);
  for (double& v : missing) v = 0.5 - v;
  const std::vector<Vec3> r = sum.winding_adjoint(missing);
  const double curvature = squared_norm(sum.winding(r));
  const double step = curvature > 0 ? squared_norm(r) / curvature : 0;
  for (std::size_t i = 0; i < eta.size(); ++i) eta[i] = vector::add(eta[i], vector::scale(r[i], step));
  return std::sqrt(squared_norm(missing) / (0.25 * static_cast<double>(eta.size())));
}

}  // namespace

WnncWidths wnnc_widths(const std::string& name, double spacing) {
  if (name.empty() || name == "density") return {kRelativeWidths.widest * spacing, kRelativeWidths.narrowest * spacing};
  std::string known = "density";
  for (const auto& [text, widths] : kPublishedWidths) {
    if (name == text) return widths;
    known.append(", ").append(text);
  }
  throw InvalidInput("widths of wnnc: '" + name + "' is none of " + known);
}

WnncResult solve_wnnc(const std::vector<Vec3>& points, const WnncWidths& widths, const SumPlan& plan, Stages& stages) {
  WnncResult result;
  std::vector<Vec3> eta(points.size(), Vec3{0, 0, 0});
  for (int i = 0; i < kWnncIterations; ++i) {
    const double left = static_cast<double>(kWnncIterations - 1 - i) / (kWnncIterations - 1);
    HardCutoffSum sum(points, widths.narrowest + left * (widths.widest - widths.narrowest), plan, stages.cancel());
    result.residuals.push_back(descend(sum, eta));
    result.eta = eta;
    result.normals = normalised(eta);
    const std::vector<Vec3> gradient = sum.winding_gradient(eta);
    result.strength.resize(points.size());
    for (std::size_t k = 0; k < eta.size(); ++k) {
      result.strength[k] = std::sqrt(vector::dot(gradient[k], gradient[k]));
      if (result.strength[k] > 0) result.normals[k] = vector::scale(gradient[k], 1 / result.strength[k]);
      eta[k] = vector::scale(result.normals[k], std::sqrt(vector::dot(eta[k], eta[k])));
    }
    stages.progress(static_cast<double>(i + 1) / kWnncIterations);
  }
  return result;
}

}  // namespace g3r
