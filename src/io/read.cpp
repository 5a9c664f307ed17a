// From bytes to a cloud or a mesh: recognise the format, call its reader, check what holds for all formats.
#include "base/platform.h"
#include "io/ept.h"
#include "io/file_lists.h"
#include "io/readers.h"
#include "io/recognise.h"
#include "io/source.h"
#include "io/subset.h"
#include "io/text_numbers.h"
#include "io/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace g3r {

namespace io {

namespace {

std::string display_name(const std::string& path) { return path == "-" ? "standard input" : path; }

Cloud read_as(Format format, const Source& source, const ReadOptions& options) {
  switch (format) {
    case Format::kPly:
      return read_ply(source, options);
    case Format::kPcd:
      return read_pcd(source);
    case Format::kNpy:
      return read_npy(source);
    case Format::kLas:
      return read_las(source, options);
    case Format::kE57:
      return read_e57(source);
    case Format::kGlb:
      return read_glb(source);
    case Format::kGltf:
      return read_gltf(source);
    case Format::kOff:
      return read_off(source);
    case Format::kObj:
      return read_obj(source);
    case Format::kStlBinary:
      return read_stl(source, true);
    case Format::kStlText:
      return read_stl(source, false);
    case Format::kPtx:
      return read_ptx(source);
    case Format::kAsciiGrid:
      return read_ascii_grid(source);
    case Format::kSpz:
      return read_spz(source, options);
    case Format::kText:
      break;
  }
  return read_xyz(source);
}

// Colours that are all zero were never set: many writers have the field always.
void drop_black(Cloud& cloud) {
  const auto black = [](const std::array<std::uint8_t, 3>& color) { return color == std::array<std::uint8_t, 3>{}; };
  if (std::all_of(cloud.colors.begin(), cloud.colors.end(), black)) cloud.colors = {};
}

// Coordinates in float32 far from the origin have lost their last digits before we see them.
void warn_about_precision(Cloud& cloud) {
  if (cloud.scalar != Scalar::kFloat32) return;
  constexpr double kStepPerExtent = 1e-4;  // From this share of the extent on, steps of the numbers are visible as steps of the surface.
  for (int axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Vec3& p : cloud.positions) {
      const double value = p[static_cast<std::size_t>(axis)];
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const double step = std::max(std::abs(low), std::abs(high)) * static_cast<double>(std::numeric_limits<float>::epsilon());
    if (high > low && step > kStepPerExtent * (high - low)) {
      cloud.warnings.push_back("coordinates in float32 are quantised to steps of " + number_text(static_cast<float>(step)) +
                               " in an extent of " + number_text(static_cast<float>(high - low)) +
                               ": precision is lost; store them as double, or subtract an offset first");
      return;
    }
  }
}

void check_options(const ReadOptions& options) {
  if (options.levels < 0) throw InvalidInput("read_cloud: levels: expected a number from 0, found " + std::to_string(options.levels));
  if (!(options.min_opacity >= 0 && options.min_opacity <= 1))
    throw InvalidInput("read_cloud: min_opacity: expected a number from 0 to 1, found " + number_text(options.min_opacity));
  for (std::size_t a = 0; options.box && a < 3; ++a) {
    if (!(options.box->low[a] <= options.box->high[a]))
      throw InvalidInput("read_cloud: the box has a low corner that is not below its high one");
  }
}

// A whole file, or what the options leave of it, which may be nothing.
Cloud read_part(Source source, const ReadOptions& options) {
  const Format format = recognise(source);
  source.bytes = without_mark(source.bytes);
  Cloud cloud = read_as(format, source, options);
  if (options.levels != 0 && !cloud.format.ends_with("COPC"))
    cloud.warnings.emplace_back("no COPC file: all of its points are read, not levels of them");
  if (options.box) keep_box(cloud, *options.box);
  drop_black(cloud);
  warn_about_precision(cloud);
  return cloud;
}

void require_points(const Cloud& cloud, const std::string& name, const ReadOptions& options) {
  if (options.box && cloud.positions.empty()) throw InvalidInput(escape_text(name) + ": no points within the box");
}

Cloud read_tiles(const std::vector<std::string>& files, const std::string& path, const ReadOptions& options) {
  std::vector<Cloud> clouds;
  std::vector<std::string> names;
  for (const std::string& file : files) {
    const std::string bytes = read_bytes(file);
    Cloud cloud = read_part({bytes, file}, options);
    if (options.box && cloud.positions.empty()) continue;
    if (files.size() > 1) forget_las(cloud);
    clouds.push_back(std::move(cloud));
    names.push_back(file);
  }
  if (clouds.empty())
    throw InvalidInput(escape_text(path) + ": no points within the box in any of " + std::to_string(files.size()) + " files");
  return merge_clouds(clouds, names, path);
}

}  // namespace

}  // namespace io

Cloud read_cloud_bytes(const void* bytes, std::size_t size, const std::string& name, const ReadOptions& options) {
  io::check_options(options);
  const io::Source source{{static_cast<const char*>(bytes), size}, io::display_name(name)};
  Cloud cloud = io::read_part(source, options);
  io::require_points(cloud, source.name, options);
  return cloud;
}

Mesh read_mesh_bytes(const void* bytes, std::size_t size, const std::string& name) {
  io::Source source{{static_cast<const char*>(bytes), size}, io::display_name(name)};
  const io::Format format = io::recognise(source);
  source.bytes = io::without_mark(source.bytes);
  Mesh mesh;
  switch (format) {
    case io::Format::kPly:
      mesh = io::read_ply_mesh(source);
      break;
    case io::Format::kObj:
      mesh = io::read_obj_mesh(source);
      break;
    case io::Format::kOff:
      mesh = io::read_off_mesh(source);
      break;
    case io::Format::kStlBinary:
      mesh = io::read_stl_mesh(source, true);
      break;
    case io::Format::kStlText:
      mesh = io::read_stl_mesh(source, false);
      break;
    case io::Format::kGlb:
      mesh = io::read_glb_mesh(source);
      break;
    case io::Format::kGltf:
      mesh = io::read_gltf_mesh(source);
      break;
    default:
      io::fail_without_faces(source, "not a mesh format: expected PLY, OBJ, OFF, STL or glTF");
  }
  if (mesh.triangles.empty()) io::fail_without_faces(source, "no faces: expected a mesh with at least one triangle");
  return mesh;
}

Cloud read_cloud(const std::string& path, const ReadOptions& options) {
  if (const std::string ept = io::find_ept(path); !ept.empty()) {
    io::check_options(options);
    Cloud cloud = io::read_ept(ept, options);
    io::drop_black(cloud);
    return cloud;
  }
  if (const std::vector<std::string> files = io::find_tiles(path); !files.empty()) {
    io::check_options(options);
    return io::read_tiles(files, path, options);
  }
  const std::string bytes = io::read_bytes(path);
  return read_cloud_bytes(bytes.data(), bytes.size(), path, options);
}

Mesh read_mesh(const std::string& path) {
  if (io::is_file_list(path) && platform::exists(path))
    io::fail_without_faces({{}, io::display_name(path)}, "a list of files of points: expected a mesh, PLY, OBJ, OFF, STL or glTF");
  const std::string bytes = io::read_bytes(path);
  return read_mesh_bytes(bytes.data(), bytes.size(), path);
}

}  // namespace g3r
