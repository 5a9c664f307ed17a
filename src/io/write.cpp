// From a cloud or a mesh to a file: choose the format by the extension, check, write, commit.
#include "base/platform.h"
#include "io/laz.h"
#include "io/source.h"
#include "io/writers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace g3r {

namespace {

constexpr std::array<std::string_view, 10> kPointFormats = {"ply", "xyz", "txt", "csv", "pts", "pcd", "npy", "las", "laz", "obj"};
constexpr std::array<std::string_view, 5> kMeshFormats = {"ply", "obj", "stl", "off", "glb"};

template <class Formats>
bool has(const Formats& formats, const std::string& ext) {
  return std::find(formats.begin(), formats.end(), ext) != formats.end();
}

template <class Formats, class Others>
std::string choose_format(const std::string& path, const char* what, const Formats& formats, const char* other, const Others& others) {
  if (path == "-") return "ply";
  const std::string ext = io::extension(path);
  if (has(formats, ext)) return ext;
  std::string known;
  for (const std::string_view format : formats) known += (known.empty() ? "." : ", .") + std::string(format);
  platform::FileStatus status;
  const bool is_folder = platform::get_status(path, status) && status.kind == platform::FileStatus::Kind::kFolder;
  std::string trouble = is_folder ? "a folder, not a file" : "no extension";
  if (!ext.empty()) trouble = has(others, ext) ? "." + ext + " is for " + other : "unknown extension \"." + escape_text(ext) + "\"";
  throw InvalidInput(escape_text(path) + ": " + trouble + ": expected " + known + " for " + what);
}

std::string point_format(const std::string& path) {
  const std::string format = choose_format(path, "points", kPointFormats, "meshes", kMeshFormats);
  if (format == "laz" && !io::laz_is_compiled()) throw Unavailable(escape_text(path) + ": this build does not write LAZ: write LAS (.las)");
  return format;
}
std::string mesh_format(const std::string& path) { return choose_format(path, "a mesh", kMeshFormats, "points", kPointFormats); }

void check_mesh_data(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw InvalidInput("write_mesh: the mesh is empty");
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max()) throw InvalidInput("write_mesh: more than 2^32 triangles");
  for (const Vec3& v : mesh.vertices) {
    if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2])) throw InvalidInput("write_mesh: a vertex is not finite");
  }
  for (const auto& t : mesh.triangles) {
    if (*std::max_element(t.begin(), t.end()) >= mesh.vertices.size())
      throw InvalidInput("write_mesh: a triangle names a vertex that does not exist");
  }
  if (!mesh.colors.empty() && mesh.colors.size() != mesh.vertices.size())
    throw InvalidInput("write_mesh: colours and vertices differ in number");
  if (!mesh.confidence.empty() && mesh.confidence.size() != mesh.vertices.size()) {
    throw InvalidInput("write_mesh: confidences and vertices differ in number");
  }
}

}  // namespace

void write_cloud(const std::string& path, const Cloud& cloud, const std::vector<Vec3>* normals, const std::vector<float>* confidence,
                 const WriteOptions& options) {
  const std::string format = point_format(path);
  const io::PointData data = io::check_points(cloud, normals, confidence, options);
  io::OutputFile file(path, options.cancel);
  if (format == "ply") {
    io::write_ply(data, file);
  } else if (format == "pcd") {
    io::write_pcd(data, file);
  } else if (format == "npy") {
    io::write_npy(data, file);
  } else if (format == "las") {
    io::write_las(data, *io::plain_las(file));
  } else if (format == "laz") {
    io::write_las(data, *io::packed_las(file));
  } else if (format == "obj") {
    io::write_obj(data, file);
  } else {
    io::write_xyz(data, format == "csv" ? ',' : ' ', format == "pts", file);
  }
  file.commit();
}

void write_mesh(const std::string& path, const Mesh& mesh, const WriteOptions& options) {
  const std::string format = mesh_format(path);
  check_mesh_data(mesh);
  io::OutputFile file(path, options.cancel);
  if (format == "ply") {
    io::write_ply_mesh(mesh, options.ascii, file);
  } else if (format == "obj") {
    io::write_obj_mesh(mesh, file);
  } else if (format == "off") {
    io::write_off_mesh(mesh, file);
  } else if (format == "glb") {
    io::write_glb_mesh(mesh, file);
  } else {
    io::write_stl_mesh(mesh, options.ascii, file);
  }
  file.commit();
}

void check_output(const std::string& path, const std::vector<std::string>& inputs, bool for_mesh) {
  for_mesh ? mesh_format(path) : point_format(path);
  if (path == "-") return;
  using Kind = platform::FileStatus::Kind;
  platform::FileStatus output;
  if (platform::get_status(path, output)) {
    for (const std::string& input : inputs) {
      platform::FileStatus status;
      if (input != "-" && platform::get_status(input, status) && status.kind == Kind::kRegular && status.device == output.device &&
          status.index == output.index) {
        throw IoError(IoError::Kind::kCannotCreate,
                      escape_text(path) + ": the output is the input " + escape_text(input) + ": choose another name");
      }
    }
    // A device or a pipe may wait for its other end, or act, when it is opened: that is left to the write.
    if (output.kind == Kind::kOther) return;
  }
  io::check_creatable(path);
}

void write_file(const std::string& path, const std::string& bytes) {
  io::OutputFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace g3r
