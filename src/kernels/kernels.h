// The mollified Laplace and Stokes kernels, in double, straight from their definitions: the ground truth of every faster version.
//
// r = y - x, rho = |r|, t = rho / (sqrt2 e), s = (rho/e)^2; e is the width of the Gaussian mollifier. docs/math.md, "Kernels".
//   Phi_e = erf(t) / (4 pi rho)                                      single layer
//   g_e   = [erf(t) - sqrt(2/pi) (rho/e) exp(-t^2)] / (4 pi rho^3)   double layer: grad_y Phi_e = -g_e r
//   b_e   = -g_e'(rho) / rho                                         its derivative, for gradients of the winding field
//   h_e   = (Phi_e - 3 e^2 g_e) / rho^2                              Stokeslet S_e = (Phi_e + e^2 g_e) I + h_e r r^T
#pragma once

#include <cmath>
#include <numbers>

namespace g3r {

inline constexpr double kInv4Pi = 0.25 * std::numbers::inv_pi;

/// Beyond this many widths, or SumPlan::reach if that is less, the near field in precision T uses the plain kernels: Phi differs by
/// erfc(5/sqrt2) = 6e-7 (float) and erfc(7/sqrt2) = 3e-12 (double), g by 2e-5 and 1e-10, b by 1e-4 and 2e-9, relative.
template <class T>
inline constexpr double kMollifierReach = sizeof(T) == 4 ? 5 : 7;

/// Kernel values at one distance.
struct KernelValues {
  double single_layer;  ///< Phi_e
  double double_layer;  ///< g_e
  double gradient;      ///< b_e
  double stokeslet;     ///< h_e
};

/// All four at squared distance r2 >= 0 for width e > 0; exact limits at 0. Relative error below 1e-12.
inline KernelValues mollified_kernels(double r2, double e) {
  const double root = std::sqrt(2 * std::numbers::inv_pi);  // sqrt(2/pi)
  const double s = r2 / (e * e);
  double phi;
  double g;
  double b;
  double h;
  if (s < 0.25) {  // Taylor series of erf: erf(sqrt(s/2)) / sqrt(s) = sqrt(2/pi) sum_n (-s/2)^n / (n! (2n+1))
    phi = g = b = h = 0;
    double term = root;  // sqrt(2/pi) (-1/2)^n s^n / n!
    for (int n = 0; n < 16; ++n) {
      phi += term / (2 * n + 1);
      g += term / (2 * n + 3);
      b += term / (2 * n + 5);
      h += term / ((2 * n + 3) * (2 * n + 5));
      term *= -0.5 * s / (n + 1);
    }
    h *= 2;
  } else {
    const double rho = std::sqrt(s);
    const double gauss = root * std::exp(-0.5 * s);
    phi = std::erf(rho * std::numbers::sqrt2 / 2) / rho;
    g = (phi - gauss) / s;
    b = (3 * g - gauss) / s;
    h = (phi - 3 * g) / s;
  }
  const double scale = kInv4Pi / e;
  return {scale * phi, scale / (e * e) * g, scale / (e * e * e * e) * b, scale / (e * e) * h};
}

/// Width of the pair of points with widths ei and ej: symmetric, and e when both are e. Returned squared.
inline double pair_width_squared(double ei, double ej) { return 0.5 * (ei * ei + ej * ej); }

}  // namespace g3r
