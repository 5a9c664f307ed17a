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
#include "io/table.h"
#include "temporary_folder.h"

namespace g3r::samples {

struct Sample {
  std::string name;  ///< with the extension
  std::string bytes;
  std::size_t header;  ///< bytes before the first point (at most)
  bool counted;        ///< whether the file says how many points it has
};

/// A folder of its own, removed at the end.
class Folder : public TemporaryFolder {
 public:
  [[nodiscard]] std::string path(const std::string& name) const { return file(name); }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(file("")), std::filesystem::directory_iterator()));
  }
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

/// A header of NPY, not padded.
inline std::string npy_header(const std::string& descr, std::size_t rows, const std::string& columns) {
  const std::string header =
      "{'descr': " + descr + ", 'fortran_order': False, 'shape': (" + std::to_string(rows) + "," + columns + "), }\n";
  return std::string("\x93NUMPY\1\0", 8) + raw(static_cast<std::uint16_t>(header.size())) + header;
}

/// Rows of doubles.
inline std::string npy(const std::vector<std::vector<double>>& rows) {
  std::string bytes = npy_header("'<f8'", rows.size(), " " + std::to_string(rows[0].size()));
  for (const std::vector<double>& row : rows) {
    for (const double value : row) bytes += raw(value);
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

/// A GLB of four points, the corners of tetrahedron(), and `primitive` of them: positions are accessor 0, indices of the triangles accessor
/// 1, as bytes, and 2, of 16 bits. `node`: members of the node beside its mesh.
inline std::string triangles_glb(const std::string& primitive, const std::string& node = "") {
  const Mesh mesh = tetrahedron();
  std::string body, shorts;
  for (const Vec3& v : mesh.vertices) {
    for (const double x : v) body += raw(static_cast<float>(x));
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      body += static_cast<char>(v);
      shorts += raw(static_cast<std::uint16_t>(v));
    }
  }
  body += shorts;
  std::string text =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":84}],"bufferViews":[{"buffer":0,"byteLength":48},)"
      R"({"buffer":0,"byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":24}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},)"
      R"({"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"},{"bufferView":2,"componentType":5123,"count":12,"type":"SCALAR"}],)"
      R"("meshes":[{"primitives":[)" +
      primitive + R"(]}],"nodes":[{"mesh":0)" + node + "}]}";
  text.append((4 - text.size() % 4) % 4, ' ');
  const auto size = [](std::size_t bytes) { return raw(static_cast<std::uint32_t>(bytes)); };
  return "glTF" + size(2) + size(28 + text.size() + body.size()) + size(text.size()) + "JSON" + text + size(body.size()) +
         std::string("BIN\0", 4) + body;
}

/// Two scans that turn the helix by 90 degrees about z and shift it; of the first every third beam met nothing.
inline std::string ptx(std::size_t count) {
  const Cloud cloud = helix(count);
  std::string text;
  for (int scan = 0; scan < 2; ++scan) {
    text +=
        std::to_string(count) + "\n1\n5 6 7\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n5 6 " + std::to_string(7 + scan) + " 1\n";
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& p = cloud.positions[i];
      if (scan == 0) {
        text += i % 3 == 2 ? "0 0 0 0.5\n" : std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + " 0.25\n";
      } else {
        text += "1 2 " + std::to_string(i) + " 0.75 10 20 30\n";
      }
    }
  }
  return text;
}

/// An ASCII grid of two rows of heights of the helix; of the southern one every third has no value.
inline std::string ascii_grid(std::size_t count) {
  const Cloud cloud = helix(count);
  std::string text =
      "ncols " + std::to_string(count) + "\nnrows 2\nxllcorner 500000.25\nyllcorner 4600000\ncellsize 0.5\nNODATA_value -9999\n";
  for (int row = 0; row < 2; ++row) {
    for (std::size_t i = 0; i < count; ++i)
      text += (row == 1 && i % 3 == 2 ? "-9999" : std::to_string(cloud.positions[i][2])) + (i + 1 < count ? " " : "\n");
  }
  return text;
}

/// gzip without compression.
inline std::string gzip(const std::string& bytes) {
  std::string stream("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10);
  constexpr std::size_t kBlock = 65535;
  for (std::size_t at = 0; at == 0 || at < bytes.size(); at += kBlock) {
    const std::string block = bytes.substr(at, kBlock);
    const auto size = static_cast<std::uint16_t>(block.size());
    stream += static_cast<char>(at + kBlock >= bytes.size() ? 1 : 0);
    stream += raw(size) + raw(static_cast<std::uint16_t>(~size)) + block;
  }
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320 : 0);
  }
  return stream + raw(~crc) + raw(static_cast<std::uint32_t>(bytes.size()));
}

/// Splats at (i, -i, i / 4) with harmonics of degree 1, before gzip; the second one may be `faint`.
inline std::string unpacked_spz(std::size_t count, std::uint32_t version, bool faint = false) {
  std::string bytes = "NGSP" + raw(version) + raw(static_cast<std::uint32_t>(count)) + std::string("\1\xc\0\0", 4);
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<std::int32_t>(i);
    for (const std::int32_t fixed : {n * 4096, -n * 4096, n * 1024}) bytes += raw(fixed).substr(0, 3);
  }
  for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>(faint && i == 1 ? 2 : 255);
  for (std::size_t i = 0; i < count; ++i) bytes += "\xa0\x80\x60";
  bytes += std::string(3 * count, '\x70');  // scales: exp(-3)
  for (std::size_t i = 0; i < count; ++i) {
    if (version == 2) bytes += std::string("\xff\x7f\x80", 3);
    if (version == 3) bytes += raw(std::uint32_t{3} << 30 | 0x1FFU << 20 | 0x2FFU);  // w is the largest
  }
  return bytes + std::string(9 * count, '\x80');
}

inline std::vector<std::vector<double>> rows_with_colors(const Cloud& cloud) {
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    std::vector<double>& row = rows.emplace_back(cloud.positions[i].begin(), cloud.positions[i].end());
    row.insert(row.end(), cloud.colors[i].begin(), cloud.colors[i].end());
  }
  return rows;
}

/// One file for every reader and variant.
inline std::vector<Sample> all(std::size_t count = 12) {
  const Cloud cloud = helix(count);
  Cloud bare;
  bare.positions = cloud.positions;
  Cloud oriented = bare;
  oriented.normals = cloud.normals;
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
  samples.push_back(sample("normals.npy", written(oriented, "a.npy"), "}", true));
  samples.push_back(sample("colors.npy", npy(rows_with_colors(cloud)), "}", true));
  Sample las = sample("points.las", written(cloud, "a.las"), "", true);
  las.header = 375;
  samples.push_back(las);
  samples.push_back(sample("points.pts", written(bare, "a.pts"), "\n", true));
  samples.push_back(sample("points.xyz", written(bare, "a.xyz"), "", false));
  samples.push_back(sample("points.csv", written(cloud, "a.csv"), "\n", false));
  samples.push_back(sample("scans.ptx", ptx(count), "5 6 7 1\n", false));
  samples.push_back(sample("heights.asc", ascii_grid(count), "-9999\n", true));
  samples.push_back(sample("splats2.spz", gzip(unpacked_spz(count, 2)), "", true));
  Sample spz = sample("splats3.spz", gzip(unpacked_spz(count, 3)), "", true);
  spz.header = 31;  // of gzip, its block, and SPZ
  samples.push_back(spz);
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

/// What read() says of bytes that it refuses; empty if it reads them.
inline std::string message_of(const std::string& bytes, const std::string& name = "sample") {
  try {
    read(bytes, name);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// A property of a point that only the table has.
inline double value_of(const Cloud& cloud, const std::string& property, std::size_t point) {
  const io::Element& points = cloud.attributes->points();
  const io::RecordLayout layout(points);
  const std::size_t found = points.find(property);
  return io::load_as_double(points.properties[found].type, points.data.data() + point * points.stride() + layout.offset(found));
}

}  // namespace g3r::samples
