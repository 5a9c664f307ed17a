// Sources: Pineda, "A parallel algorithm for polygon rasterization", 1988; McGuire et al., "The Alchemy screen-space ambient
// obscurance algorithm", 2011; Zwicker et al., "Surface splatting", 2001 (discs at right angles to the normal).
#include "view/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

namespace g3r::view {
namespace {

using Eigen::Vector3f;

constexpr int kSupersampling = 2;  // Samples per pixel and axis: 4 samples a pixel leave no visible steps.
// Ambient occlusion: places looked at (fewer show as grain), how far away in radii of the scene (farther, all becomes grey), how much it
// darkens, and the sine of the slope below which a neighbour does not occlude (with less, flat discs shade each other).
constexpr int kTaps = 24;
constexpr float kReach = 0.12F;
constexpr float kStrength = 1.1F;
constexpr float kBias = 0.06F;
constexpr float kGrazing = 0.2F;   // The least cosine that a disc is drawn with: without it discs seen from the edge would vanish.
constexpr float kNearest = 1e-6F;  // Nothing closer to the eye than this is drawn, where the perspective has no place for it.

float srgb_from_linear(float c) { return c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1 / 2.4F) - 0.055F; }
float linear_from_srgb(float c) { return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F); }

std::uint8_t to_byte(float linear) {
  return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(std::clamp(linear, 0.0F, 1.0F))));
}

// Key light from the upper left, fill from the right, sky above, and a small highlight.
Vector3f lit(const Vector3f& color, const Vector3f& n, float occlusion) {
  static const Vector3f key = Vector3f(-0.45F, 0.65F, 0.75F).normalized();
  static const Vector3f fill = Vector3f(0.8F, 0.1F, 0.45F).normalized();
  static const Vector3f half = (key + Vector3f(0, 0, 1)).normalized();
  const float open = 1 - occlusion;
  const float diffuse = 0.72F * std::max(0.0F, n.dot(key)) * (0.4F + 0.6F * open) + 0.20F * std::max(0.0F, n.dot(fill)) * open +
                        (0.30F + 0.10F * n.y()) * open;
  const float highlight = 0.12F * std::pow(std::max(0.0F, n.dot(half)), 24.0F) * open;
  return color * diffuse + Vector3f::Constant(highlight);
}

Vector3f background(float height, bool dark) {
  const Vector3f top = linear_rgb(dark ? 0x23272e : 0xffffff);
  const Vector3f bottom = linear_rgb(dark ? 0x15181c : 0xe4e8ee);
  return top + (bottom - top) * height;
}

}  // namespace

Vector3f linear_rgb(unsigned srgb) {
  const auto part = [srgb](unsigned shift) { return linear_from_srgb(static_cast<float>((srgb >> shift) & 255U) / 255); };
  return {part(16), part(8), part(0)};
}

Canvas::Canvas(const Camera& camera, int pixels)
    : side_(pixels * kSupersampling),
      focal_(static_cast<float>(side_ / 2.0 / std::tan(camera.half_angle))),
      distance_(static_cast<float>(camera.distance)),
      samples_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_)) {}

// (x, y) in samples, y down, and the nearness 1 / depth; nearness 0 means behind the eye.
Vector3f Canvas::to_screen(const Vector3f& p) const {
  const float depth = distance_ - p.z();
  if (!(depth > kNearest * distance_)) return Vector3f::Zero();
  const float half = static_cast<float>(side_) / 2;
  return {half + focal_ * p.x() / depth, half - focal_ * p.y() / depth, 1 / depth};
}

Vector3f Canvas::position(int x, int y, float nearness) const {
  const float half = static_cast<float>(side_) / 2;
  const float depth = 1 / nearness;
  return {(static_cast<float>(x) + 0.5F - half) * depth / focal_, (half - static_cast<float>(y) - 0.5F) * depth / focal_,
          distance_ - depth};
}

void Canvas::draw_triangle(const Corner& a, const Corner& b, const Corner& c, const Vector3f& inside_color) {
  const Vector3f p = to_screen(a.position), q = to_screen(b.position), r = to_screen(c.position);
  if (p.z() <= 0 || q.z() <= 0 || r.z() <= 0) return;
  const auto edge = [](const Vector3f& u, const Vector3f& v, float x, float y) {
    return (v.x() - u.x()) * (y - u.y()) - (v.y() - u.y()) * (x - u.x());
  };
  const float area = edge(p, q, r.x(), r.y());
  if (area == 0 || !std::isfinite(area)) return;
  const bool outside = area < 0;  // y runs down on the screen

  const auto last = static_cast<float>(side_ - 1);
  const int x0 = static_cast<int>(std::clamp(std::floor(std::min({p.x(), q.x(), r.x()}) - 0.5F), 0.0F, last));
  const int x1 = static_cast<int>(std::clamp(std::ceil(std::max({p.x(), q.x(), r.x()}) - 0.5F), 0.0F, last));
  const int y0 = static_cast<int>(std::clamp(std::floor(std::min({p.y(), q.y(), r.y()}) - 0.5F), 0.0F, last));
  const int y1 = static_cast<int>(std::clamp(std::ceil(std::max({p.y(), q.y(), r.y()}) - 0.5F), 0.0F, last));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const float sx = static_cast<float>(x) + 0.5F;
      const float sy = static_cast<float>(y) + 0.5F;
      const float u = edge(q, r, sx, sy) / area;
      const float v = edge(r, p, sx, sy) / area;
      const float w = 1 - u - v;
      if (u < 0 || v < 0 || w < 0) continue;
      const float nearness = u * p.z() + v * q.z() + w * r.z();
      Sample& sample = at(x, y);
      if (nearness <= sample.nearness) continue;
      const float wu = u * p.z() / nearness, wv = v * q.z() / nearness, ww = w * r.z() / nearness;
      Vector3f normal = wu * a.normal + wv * b.normal + ww * c.normal;
      if (!outside) normal = -normal;
      sample = {nearness, normal.normalized(), outside ? Vector3f(wu * a.color + wv * b.color + ww * c.color) : inside_color};
    }
  }
}

void Canvas::draw_disc(const Vector3f& centre, const Vector3f& normal, float radius, const Vector3f& color) {
  const Vector3f s = to_screen(centre);
  if (s.z() <= 0) return;
  const Vector3f to_eye = (Vector3f(0, 0, distance_) - centre).normalized();
  Vector3f n = normal.squaredNorm() > 0 ? Vector3f(normal.normalized()) : to_eye;
  if (n.dot(to_eye) < 0) n = -n;
  // The slope of the disc against the screen; discs seen from the edge are tilted towards the viewer.
  const float nz = std::max(n.z(), kGrazing);
  const float size = std::max(radius * focal_ * s.z(), 0.71F);  // at least one sample
  const auto last = static_cast<float>(side_ - 1);
  const int x0 = static_cast<int>(std::clamp(std::floor(s.x() - size), 0.0F, last));
  const int x1 = static_cast<int>(std::clamp(std::ceil(s.x() + size), 0.0F, last));
  const int y0 = static_cast<int>(std::clamp(std::floor(s.y() - size), 0.0F, last));
  const int y1 = static_cast<int>(std::clamp(std::ceil(s.y() + size), 0.0F, last));
  const float scale = 1 / (focal_ * s.z());
  const float least = size * scale;  // radius in view units
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const float dx = (static_cast<float>(x) + 0.5F - s.x()) * scale;
      const float dy = (s.y() - static_cast<float>(y) - 0.5F) * scale;
      const float dz = -(n.x() * dx + n.y() * dy) / nz;
      if (dx * dx + dy * dy + dz * dz > least * least) continue;
      const float depth = 1 / s.z() - dz;
      if (depth <= 0) continue;
      const float nearness = 1 / depth;
      Sample& sample = at(x, y);
      if (nearness > sample.nearness) sample = {nearness, n, color};
    }
  }
}

// Share of the half space above the sample that its neighbours on the screen block, 0..1.
float Canvas::occlusion(int x, int y) const {
  const Sample& sample = at(x, y);
  const Vector3f p = position(x, y, sample.nearness);
  const float reach = kReach * focal_ * sample.nearness;  // in samples
  // A rotation that differs between neighbours, so that the blur averages many directions (interleaved gradient noise).
  const float noise =
      std::fmod(52.9829189F * std::fmod(0.06711056F * static_cast<float>(x) + 0.00583715F * static_cast<float>(y), 1.0F), 1.0F);
  float blocked = 0;
  for (int tap = 0; tap < kTaps; ++tap) {
    const float t = (static_cast<float>(tap) + 0.5F) / kTaps;
    const float angle = 6.2831853F * (noise + 7 * t);
    const int tx = x + static_cast<int>(std::lround(reach * t * std::cos(angle)));
    const int ty = y + static_cast<int>(std::lround(reach * t * std::sin(angle)));
    if (tx < 0 || ty < 0 || tx >= side_ || ty >= side_ || (tx == x && ty == y)) continue;
    const float nearness = at(tx, ty).nearness;
    if (nearness <= 0) continue;
    const Vector3f d = position(tx, ty, nearness) - p;
    const float length = d.norm();
    if (length <= 0) continue;
    const float fade = std::max(0.0F, 1 - length / (2 * kReach));  // far layers do not darken near ones
    blocked += std::max(0.0F, sample.normal.dot(d) / length - kBias) * fade;
  }
  return std::min(0.85F, kStrength * 2 * blocked / kTaps);
}

std::vector<float> Canvas::occlusion_map() const {
  std::vector<float> raw(samples_.size(), 0);
  for (int y = 0; y < side_; ++y) {
    for (int x = 0; x < side_; ++x) {
      if (at(x, y).nearness > 0) raw[index(x, y)] = occlusion(x, y);
    }
  }
  // Blur over samples of the same surface.
  constexpr int kBlur = 3;  // Samples to either side: the grain of kTaps places goes, edges of shadows stay.
  std::vector<float> smooth(samples_.size(), 0);
  for (int y = 0; y < side_; ++y) {
    for (int x = 0; x < side_; ++x) {
      const float nearness = at(x, y).nearness;
      if (nearness <= 0) continue;
      float total = 0, weight = 0;
      for (int v = std::max(0, y - kBlur); v <= std::min(side_ - 1, y + kBlur); ++v) {
        for (int u = std::max(0, x - kBlur); u <= std::min(side_ - 1, x + kBlur); ++u) {
          const float other = at(u, v).nearness;
          if (other <= 0 || std::abs(1 / other - 1 / nearness) > kReach / 2) continue;
          total += raw[index(u, v)];
          weight += 1;
        }
      }
      smooth[index(x, y)] = total / weight;
    }
  }
  return smooth;
}

void Canvas::resolve(Image& image, int left, int top, bool dark) const {
  const std::vector<float> blocked = occlusion_map();
  const int pixels = side_ / kSupersampling;
  for (int y = 0; y < pixels; ++y) {
    for (int x = 0; x < pixels; ++x) {
      const Vector3f behind = background(static_cast<float>(y) / static_cast<float>(pixels), dark);
      Vector3f sum = Vector3f::Zero();
      for (int v = 0; v < kSupersampling; ++v) {
        for (int u = 0; u < kSupersampling; ++u) {
          const int sx = x * kSupersampling + u;
          const int sy = y * kSupersampling + v;
          const Sample& sample = at(sx, sy);
          sum += sample.nearness > 0 ? lit(sample.color, sample.normal, blocked[index(sx, sy)]) : behind;
        }
      }
      sum /= kSupersampling * kSupersampling;
      auto* out =
          &image.rgb[3 * (static_cast<std::size_t>(top + y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(left + x))];
      for (int k = 0; k < 3; ++k) out[k] = to_byte(sum[k]);
    }
  }
}

}  // namespace g3r::view
