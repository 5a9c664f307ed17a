#include "mesh/exact_orientation.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace g3r {
namespace {

constexpr double kHalfUlp = std::numeric_limits<double>::epsilon() / 2;
constexpr double kErrorBound3 = (7 + 56 * kHalfUlp) * kHalfUlp;  // Shewchuk, section 4.3, of the rounded 3 x 3 determinant
constexpr double kErrorBound2 = (3 + 16 * kHalfUlp) * kHalfUlp;

// A sum of doubles, smallest first, whose bits do not overlap; no zeros, so that the sign is that of the last.
using Expansion = std::vector<double>;

// Shewchuk, Grow-Expansion.
void add(Expansion& e, double x) {
  std::size_t kept = 0;
  for (const double part : e) {
    const double sum = x + part;
    const double virtual_part = sum - x;
    const double error = (x - (sum - virtual_part)) + (part - virtual_part);
    if (error != 0) e[kept++] = error;
    x = sum;
  }
  e.resize(kept);
  if (x != 0) e.push_back(x);
}

Expansion difference(double a, double b) {
  Expansion e;
  add(e, a);
  add(e, -b);
  return e;
}

// Every product of two doubles is the sum of two.
Expansion product(const Expansion& a, const Expansion& b) {
  Expansion e;
  for (const double x : a) {
    for (const double y : b) {
      const double high = x * y;
      add(e, std::fma(x, y, -high));
      add(e, high);
    }
  }
  return e;
}

void add(Expansion& e, const Expansion& other, double sign) {
  for (const double x : other) add(e, sign * x);
}

int sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

Expansion minor(const Expansion& a, const Expansion& b, const Expansion& c, const Expansion& d) {
  Expansion e = product(a, d);
  add(e, product(b, c), -1);
  return e;
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  const double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
  const double determinant = wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);
  const double size = std::fabs(wx) * (std::fabs(uy * vz) + std::fabs(uz * vy)) +
                      std::fabs(wy) * (std::fabs(uz * vx) + std::fabs(ux * vz)) + std::fabs(wz) * (std::fabs(ux * vy) + std::fabs(uy * vx));
  if (std::fabs(determinant) > kErrorBound3 * size) return sign(determinant);
  const Expansion u0 = difference(b[0], a[0]), u1 = difference(b[1], a[1]), u2 = difference(b[2], a[2]);
  const Expansion v0 = difference(c[0], a[0]), v1 = difference(c[1], a[1]), v2 = difference(c[2], a[2]);
  Expansion sum = product(minor(u1, u2, v1, v2), difference(d[0], a[0]));
  add(sum, product(minor(u2, u0, v2, v0), difference(d[1], a[1])), 1);
  add(sum, product(minor(u0, u1, v0, v1), difference(d[2], a[2])), 1);
  return sum.empty() ? 0 : sign(sum.back());
}

int orientation_along(std::size_t axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::size_t x = (axis + 1) % 3, y = (axis + 2) % 3;
  const double left = (b[x] - a[x]) * (c[y] - a[y]), right = (b[y] - a[y]) * (c[x] - a[x]);
  if (std::fabs(left - right) > kErrorBound2 * (std::fabs(left) + std::fabs(right))) return sign(left - right);
  const Expansion area = minor(difference(b[x], a[x]), difference(b[y], a[y]), difference(c[x], a[x]), difference(c[y], a[y]));
  return area.empty() ? 0 : sign(area.back());
}

}  // namespace g3r
