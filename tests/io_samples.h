// Small valid files of every format, made in memory.
#pragma once

#include <g3r/io.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "io/lzf.h"

namespace g3r::samples {

struct Sample {
  std::string name;  ///< with the extension
  std::string bytes;
  std::size_t header;  ///< bytes before the first point (at most)
  bool counted;        ///< whether the file says how many points it has
};

/// A folder of its own, removed at the end.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "g3r-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string path(const std::string& name) const { return path_ + "/" + name; }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

 private:
  std::string path_;
};

inline std::string slurp(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void spill(const std::string& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary);
  out << bytes;
}

/// Points of a helix with normals and colours.
inline Cloud helix(std::size_t count, Scalar scalar = Scalar::kFloat64) {
  Cloud cloud;
  cloud.scalar = scalar;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 0.37 * static_cast<double>(i);
    Vec3 p{std::cos(t), std::sin(t), 0.1 * t};
    if (scalar == Scalar::kFloat32) {
      for (double& c : p) c = static_cast<double>(static_cast<float>(c));
    }
    cloud.positions.push_back(p);
    cloud.normals.push_back({std::cos(t), std::sin(t), 0});
    cloud.colors.push_back({static_cast<std::uint8_t>(i), 128, static_cast<std::uint8_t>(255 - i)});
  }
  return cloud;
}

/// The bytes that write_cloud() makes of a cloud under this name.
inline std::string written(const Cloud& cloud, const std::string& name, const WriteOptions& options = {}) {
  const Folder folder;
  write_cloud(folder.path(name), cloud, nullptr, nullptr, options);
  return slurp(folder.path(name));
}

inline std::string written(const Mesh& mesh, const std::string& name, const WriteOptions& options = {}) {
  const Folder folder;
  write_mesh(folder.path(name), mesh, options);
  return slurp(folder.path(name));
}

inline Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

template <class T>
std::string raw(T value, bool big = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return big ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

/// A big-endian PLY with a list in the vertex and an element before it.
inline std::string big_endian_ply(std::size_t count) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\ncomment by hand\nobj_info kept too\nelement camera 1\nproperty uchar id\nelement vertex " +
      std::to_string(count) + "\nproperty float x\nproperty list uchar short seen\nproperty float y\nproperty double z\nend_header\n";
  bytes += '\7';
  for (std::size_t i = 0; i < count; ++i) {
    const auto v = static_cast<float>(i);
    bytes += raw(v, true) + static_cast<char>(i % 3);
    for (std::size_t k = 0; k < i % 3; ++k) bytes += raw(static_cast<std::int16_t>(258 + k), true);
    bytes += raw(2 * v, true) + raw(0.1 * static_cast<double>(i), true);
  }
  return bytes;
}

inline std::string compressed_pcd(std::size_t count) {
  std::string columns;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) columns += raw(static_cast<float>(i % 4) + static_cast<float>(axis));
  }
  const std::string stream = io::lzf_compress(columns);
  const std::string n = std::to_string(count);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + n +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA binary_compressed\n" +
         raw(static_cast<std::uint32_t>(stream.size())) + raw(static_cast<std::uint32_t>(columns.size())) + stream;
}

inline std::string text_gltf() {
  // Two points, (0,0,0) and (1,2,3), as base64 of six floats.
  return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":24,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAEAAAEBA"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":24}],"accessors":[{"bufferView":0,"componentType":5126,"count":2,"type":"VEC3","min":[0,0,0],"max":[1,2,3]}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0,"translation":[10,0,0],"scale":[1,1,2]}],"scenes":[{"nodes":[0]}],"scene":0})";
}

/// One file for every reader and variant.
inline std::vector<Sample> all(std::size_t count = 12) {
  const Cloud cloud = helix(count);
  Cloud bare;
  bare.positions = cloud.positions;
  const Mesh mesh = tetrahedron();
  const auto sample = [](std::string name, std::string bytes, std::string_view end_of_header, bool counted) {
    const std::size_t end = end_of_header.empty() ? 0 : bytes.find(end_of_header);
    const std::size_t header = end == std::string::npos ? bytes.size() : end + end_of_header.size();
    return Sample{std::move(name), std::move(bytes), header, counted};
  };
  std::vector<Sample> samples;
  samples.push_back(sample("binary.ply", written(cloud, "a.ply"), "end_header\n", true));
  samples.push_back(sample("ascii.ply", written(cloud, "a.ply", {.ascii = true}), "end_header\n", true));
  samples.push_back(sample("big_endian.ply", big_endian_ply(count), "end_header\n", true));
  samples.push_back(sample("mesh.ply", written(mesh, "a.ply"), "end_header\n", true));
  samples.push_back(sample("binary.pcd", written(cloud, "a.pcd"), "DATA binary\n", true));
  samples.push_back(sample("ascii.pcd", written(cloud, "a.pcd", {.ascii = true}), "DATA ascii\n", true));
  samples.push_back(sample("compressed.pcd", compressed_pcd(count), "compressed\n", true));
  samples.push_back(sample("array.npy", written(bare, "a.npy"), "}", true));
  Sample las = sample("points.las", written(cloud, "a.las"), "", true);
  las.header = 375;
  samples.push_back(las);
  samples.push_back(sample("points.pts", written(bare, "a.pts"), "\n", true));
  samples.push_back(sample("points.xyz", written(bare, "a.xyz"), "", false));
  samples.push_back(sample("points.csv", written(cloud, "a.csv"), "\n", false));
  samples.push_back(sample("points.obj", written(cloud, "a.obj"), "", false));
  samples.push_back(sample("mesh.obj", written(mesh, "a.obj"), "", false));
  samples.push_back(sample("mesh.off", written(mesh, "a.off"), "\n4 4 0\n", true));
  Sample stl = sample("binary.stl", written(mesh, "a.stl"), "", true);
  stl.header = 84;
  samples.push_back(stl);
  samples.push_back(sample("ascii.stl", written(mesh, "a.stl", {.ascii = true}), "", false));
  samples.push_back(sample("mesh.glb", written(mesh, "a.glb"), "BIN", true));
  samples.push_back(sample("points.gltf", text_gltf(), "}]}", true));
  return samples;
}

inline Cloud read(const std::string& bytes, const std::string& name = "sample") {
  return read_cloud_bytes(bytes.data(), bytes.size(), name);
}

}  // namespace g3r::samples
