// Looking at results: one self-contained page (WebGL2, no network, no third-party script), or a picture rendered without a display.
//
//   g3r::Scene scene;
//   scene.points = cloud.positions;  scene.normals = orientation.normals;  scene.mesh = reconstruction.mesh;
//   g3r::write_file("look.html", g3r::view_html(scene));
#pragma once

#include <g3r/error.h>
#include <g3r/export.h>
#include <g3r/mesh.h>
#include <g3r/points.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace G3R_PUBLIC g3r {

/// What there is to see. Everything is optional, but there must be at least one finite point or one triangle.
/// Vectors that belong to the points are empty or have one entry per point.
struct Scene {
  std::string title;                                ///< any text; it is escaped
  std::vector<Vec3> points;                         ///< N positions; non-finite ones are left out
  std::vector<Vec3> normals;                        ///< N outward normals, any length; a zero normal is drawn as "no normal"
  std::vector<float> confidence;                    ///< N values in [0, 1]
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< N RGB triples
  std::vector<Vec3> true_normals;                   ///< N normals of a reference; the error map shows (1 - n . n_true) / 2
  Mesh mesh;
  std::string report;  ///< the JSON report of the run, see report_json(); "" for none
};

/// Which axis of the coordinates points up on the screen.
enum class Up { kY, kZ };

/// Parameters of view_html().
struct PageOptions {
  Up up = Up::kY;
  std::size_t max_points = 1500000;     ///< above this an evenly strided subset is shown, and the page says so
  std::size_t max_triangles = 3000000;  ///< a larger mesh is left out, and the page says so
};

/// One HTML document that shows the scene: before (grey), after (outside blue, inside red), needles, confidence, colours, error map,
/// mesh (shaded, wireframe), section plane, figures of the report. About 9 bytes per point and per vertex, 16 per triangle, times 4/3.
/// Throws InvalidInput: nothing to show, sizes that differ, a triangle that names no vertex, a report that is not
/// one of report_json().
[[nodiscard]] std::string view_html(const Scene& scene, const PageOptions& options = {});

/// What a picture shows of the scene.
enum class Layer {
  kPoints,      ///< the points as given, grey
  kNormals,     ///< discs: blue where the outside faces the viewer, red where the inside does
  kConfidence,  ///< discs coloured by confidence: violet 0, yellow 1
  kColors,      ///< discs in the colours of the points
  kError,       ///< discs coloured by the error of the normal: grey 0, red 1
  kMesh         ///< the mesh, its outside bluish grey (or in its colours), its inside red
};

/// Parameters of view_png().
struct PictureOptions {
  Up up = Up::kY;
  int tile = 600;             ///< width and height of one view in pixels, 16..2048
  std::vector<Layer> layers;  ///< empty: the mesh, else the points with the best that is known about them
  bool dark = false;          ///< dark background
  int threads = 0;            ///< 0: all cores
  int views = 4;              ///< 1..4: the first so many of three-quarter, front, side, top
};

/// A PNG file: 2 x 2 tiles for four views of one layer, else a row of views per layer; with one view the layers stand side by side.
/// 2 x 2 samples per pixel, ambient occlusion; the same bytes for any number of threads. O(points + triangles + pixels) time per
/// tile, and 150 bytes per pixel of a tile for each thread.
/// Throws InvalidInput like view_html(), and if a layer asks for data that the scene lacks.
[[nodiscard]] std::vector<std::uint8_t> view_png(const Scene& scene, const PictureOptions& options = {});

}  // namespace g3r
