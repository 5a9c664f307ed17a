// A small rasteriser: triangles and discs into a z-buffer, then light, ambient occlusion and 2 x 2 samples per pixel.
//
// View space: x right, y up, z towards the viewer, origin at the centre of the scene; the eye is at (0, 0, distance).
#pragma once

#include "view/png.h"

#include <vector>

#include <Eigen/Core>

namespace g3r::view {

/// A pinhole camera that looks along -z of its axes at `centre`.
struct Camera {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< rows: right, up, towards the viewer
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double scale = 1;         ///< view units per input unit: the scene has radius 1 in view space
  double distance = 1;      ///< from the eye to the centre, view units
  double half_angle = 0.2;  ///< half of the opening angle of the square image, radians

  [[nodiscard]] Eigen::Vector3f to_view(const Eigen::Vector3d& p) const { return (axes * (p - centre) * scale).cast<float>(); }
};

/// A point of a mesh as the rasteriser wants it, in view space; the colour is linear RGB.
struct Corner {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  Eigen::Vector3f color;
};

/// Linear RGB from the 8 bit sRGB value 0xRRGGBB.
Eigen::Vector3f linear_rgb(unsigned srgb);

/// Samples of one square view, kept until resolve().
class Canvas {
 public:
  /// `pixels` per side.
  Canvas(const Camera& camera, int pixels);

  /// One triangle; its side is told by its winding on the screen, and the inside gets `inside_color`.
  void draw_triangle(const Corner& a, const Corner& b, const Corner& c, const Eigen::Vector3f& inside_color);

  /// A disc of a radius in view units, at right angles to `normal` (need not be unit); a zero normal faces the viewer.
  void draw_disc(const Eigen::Vector3f& centre, const Eigen::Vector3f& normal, float radius, const Eigen::Vector3f& color);

  /// Copies the finished view to the square at (left, top) of the image.
  void resolve(Image& image, int left, int top, bool dark) const;

 private:
  struct Sample {
    float nearness = 0;  ///< 1 / depth; 0: background
    Eigen::Vector3f normal;
    Eigen::Vector3f color;
  };
  [[nodiscard]] Eigen::Vector3f to_screen(const Eigen::Vector3f& p) const;
  [[nodiscard]] Eigen::Vector3f position(int x, int y, float nearness) const;
  [[nodiscard]] float occlusion(int x, int y) const;
  [[nodiscard]] std::vector<float> occlusion_map() const;
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] const Sample& at(int x, int y) const { return samples_[index(x, y)]; }
  Sample& at(int x, int y) { return samples_[index(x, y)]; }

  int side_;     ///< samples per side
  float focal_;  ///< in samples
  float distance_;
  std::vector<Sample> samples_;
};

}  // namespace g3r::view
