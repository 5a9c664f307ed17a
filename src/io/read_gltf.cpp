// Vertices and triangles of glTF 2.0 under the transforms of their nodes. What is in the file: gltf_file.h.
#include "io/gltf_file.h"
#include "io/readers.h"
#include "io/table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

namespace {

using Matrix = std::array<double, 16>;  // column major, as glTF has it

constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// The items of an accessor: where the first is, how many there are, and bytes from one to the next.
struct Items {
  const char* first;
  std::uint64_t count;
  std::size_t stride;
};

// Positions of one node's mesh: the first of them in the cloud, and how many there are.
struct Positions {
  std::uint64_t first;
  std::uint64_t count;
};

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

class GltfReader {
 public:
  // `triangles`: gets those of the meshes, if not null.
  explicit GltfReader(const GltfFile& file, Triangles* triangles = nullptr) : file_(file), source_(file.source()), triangles_(triangles) {}

  Cloud read() {
    Cloud cloud;
    cloud.format = file_.is_binary() ? "glb" : "gltf";
    cloud.scalar = Scalar::kFloat64;
    cloud.property_names = {"x", "y", "z"};
    const std::vector<Json>& nodes = file_.list("nodes");
    visited_.assign(nodes.size(), false);
    measuring_ = true;
    traverse(cloud);
    if (total_ == 0) {
      fail_without_points(file_.root().find("asset") != nullptr ? "no points: no mesh in this glTF file has positions"
                                                                : "no points: a JSON file that is no glTF, as it has no key \"asset\"");
    }
    cloud.positions.reserve(static_cast<std::size_t>(total_));
    if (triangles_ != nullptr) triangles_->reserve(static_cast<std::size_t>(total_triangles_));
    measuring_ = false;
    visited_.assign(nodes.size(), false);
    traverse(cloud);
    return cloud;
  }

 private:
  [[noreturn]] void fail_without_points(const std::string& what) const {
    if (triangles_ != nullptr) fail_without_faces(source_, what);
    fail(source_, what);
  }

  void traverse(Cloud& cloud) {
    const std::vector<Json>& nodes = file_.list("nodes");
    if (nodes.empty()) {
      for (const Json& mesh : file_.list("meshes")) add_mesh(mesh, kIdentity, cloud);
      return;
    }
    const std::vector<Json>& scenes = file_.list("scenes");
    if (scenes.empty()) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!visited_[i]) visit(i, kIdentity, 0, cloud);
      }
      return;
    }
    const Json* chosen = file_.root().find("scene");
    const Json& scene = chosen != nullptr ? file_.item(scenes, *chosen, "scene") : scenes[0];
    const Json* roots = scene.find("nodes");
    if (roots == nullptr) return;
    for (const Json& node : roots->items) visit(file_.index(node, nodes.size(), "node"), kIdentity, 0, cloud);
  }

  void visit(std::size_t i, const Matrix& parent, int depth, Cloud& cloud) {
    constexpr int kDeepest = 1000;  // Deeper trees would use up the stack.
    if (visited_[i] || depth > kDeepest) fail(source_, "the nodes of this glTF file are no tree");
    visited_[i] = true;
    const Json& node = file_.list("nodes")[i];
    const Matrix transform = product(parent, local(node));
    if (const Json* mesh = node.find("mesh")) add_mesh(file_.item(file_.list("meshes"), *mesh, "mesh"), transform, cloud);
    const Json* children = node.find("children");
    if (children == nullptr) return;
    for (const Json& child : children->items) visit(file_.index(child, visited_.size(), "node"), transform, depth + 1, cloud);
  }

  // Primitives of a mesh may share their positions.
  void add_mesh(const Json& mesh, const Matrix& transform, Cloud& cloud) {
    const std::vector<Json>& accessors = file_.list("accessors");
    std::map<std::size_t, Positions> added;
    for (const Json& primitive : file_.member(mesh, "primitives").items) {
      const Json* position = file_.member(primitive, "attributes").find("POSITION");
      if (position == nullptr) continue;
      const std::size_t accessor = file_.index(*position, accessors.size(), "accessor");
      auto known = added.find(accessor);
      if (known == added.end()) known = added.emplace(accessor, add_positions(accessors[accessor], transform, cloud)).first;
      if (triangles_ != nullptr) add_triangles(primitive, known->second, is_mirror(transform));
    }
  }

  // The items of an accessor within its buffer view; `size` bytes each, `what` they are, for messages.
  [[nodiscard]] Items items_of(const Json& accessor, std::size_t size, const char* what) const {
    if (accessor.find("sparse") != nullptr) fail(source_, std::string(what) + " in a sparse accessor are not read");
    const Json& view = file_.item(file_.list("bufferViews"), file_.member(accessor, "bufferView"), "buffer view");
    const std::string_view buffer = file_.buffer(file_.member(view, "buffer"));
    const std::uint64_t view_at = file_.whole(view, "byteOffset", 0);
    const std::uint64_t view_bytes = file_.whole(view, "byteLength", 0);
    const std::uint64_t stride = file_.whole(view, "byteStride", size);
    const std::uint64_t at = file_.whole(accessor, "byteOffset", 0);
    const std::uint64_t count = file_.whole(accessor, "count", 0);
    if (view_at > buffer.size() || view_bytes > buffer.size() - view_at || stride < size || stride > 255 || at > view_bytes) {
      fail(source_, "truncated: a buffer view does not lie within its buffer");
    }
    const std::uint64_t room = view_bytes - at;
    if (count != 0 && (room < size || count - 1 > (room - size) / stride)) {
      fail(source_,
           "truncated: an accessor of " + std::to_string(count) + " " + what + " does not fit in its buffer view (count too large)");
    }
    return {buffer.data() + view_at + at, count, static_cast<std::size_t>(stride)};
  }

  // Meshes and nodes may use the same bytes several times: memory is bounded by the size of the file.
  void check_memory() const {
    constexpr std::uint64_t kTimes = 8;  // positions as double are twice the size of those in the file, so each may be used four times
    if (total_ * sizeof(Vec3) + total_triangles_ * sizeof(Triangles::value_type) > kTimes * source_.bytes.size())
      fail(source_, "the meshes refer to the same points too many times (instances)");
  }

  Positions add_positions(const Json& accessor, const Matrix& m, Cloud& cloud) {
    constexpr std::uint64_t kFloat = 5126;
    if (file_.member(accessor, "componentType").whole() != kFloat || file_.member(accessor, "type").text != "VEC3") {
      fail(source_, "expected positions of component type float and type VEC3 (quantised or compressed glTF is not read)");
    }
    const Items items = items_of(accessor, 3 * sizeof(float), "points");
    const Positions positions{measuring_ ? total_ : cloud.positions.size(), items.count};
    if (measuring_) {
      total_ += items.count;
      check_memory();
      return positions;
    }
    const char* bytes = items.first;
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (std::uint64_t i = 0; i < items.count; ++i, bytes += items.stride) {
      const double p[3] = {load<float>(bytes), load<float>(bytes + 4), load<float>(bytes + 8)};
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
      Vec3 q{};
      for (std::size_t a = 0; a < 3; ++a) q[a] = m[a] * p[0] + m[4 + a] * p[1] + m[8 + a] * p[2] + m[12 + a];
      cloud.positions.push_back(q);
    }
    check_bounds(accessor, low, high, cloud);
    return positions;
  }

  // `turned`: the transform is a mirror, which turns the corners of triangles the other way round.
  void add_triangles(const Json& primitive, const Positions& positions, bool turned) {
    constexpr std::uint64_t kTriangles = 4;  // below are points and lines
    const std::uint64_t mode = file_.whole(primitive, "mode", kTriangles);
    if (mode < kTriangles) return;
    if (mode > kTriangles) fail(source_, "triangles in strips or fans are not read: convert to single triangles");
    const Json* accessor = primitive.find("indices");
    Type type = Type::kUint32;
    Items items{nullptr, positions.count, 0};  // without indices the positions are corners, one after the other
    if (accessor != nullptr) {
      const Json& indices = file_.item(file_.list("accessors"), *accessor, "accessor");
      type = index_type(indices);
      items = items_of(indices, size_of(type), "indices");
    }
    if (items.count % 3 != 0)
      fail(source_, "truncated: " + std::to_string(items.count) + " corners of triangles are not three for each of them");
    total_triangles_ += measuring_ ? items.count / 3 : 0;
    check_memory();
    if (measuring_) return;
    const auto corner = [&](std::uint64_t i) {
      const std::uint64_t index =
          accessor == nullptr ? i : static_cast<std::uint64_t>(load_as_double(type, items.first + i * items.stride));
      if (index >= positions.count) {
        fail(source_,
             "face index out of range: expected 0.." + std::to_string(positions.count) + " (exclusive), found " + std::to_string(index));
      }
      if (positions.first + index > std::numeric_limits<std::uint32_t>::max())
        fail(source_, "too many vertices: they are counted in 32 bits");
      return static_cast<std::uint32_t>(positions.first + index);
    };
    for (std::uint64_t i = 0; i < items.count; i += 3) {
      const std::uint32_t first = corner(i), second = corner(i + 1), third = corner(i + 2);
      triangles_->push_back(turned ? Triangles::value_type{first, third, second} : Triangles::value_type{first, second, third});
    }
  }

  [[nodiscard]] Type index_type(const Json& accessor) const {
    const std::optional<std::uint64_t> type = file_.member(accessor, "componentType").whole();
    if (file_.member(accessor, "type").text == "SCALAR" && type) {
      if (*type == 5121) return Type::kUint8;
      if (*type == 5123) return Type::kUint16;
      if (*type == 5125) return Type::kUint32;
    }
    fail(source_, "expected indices of an unsigned component type and type SCALAR");
  }

  static bool is_mirror(const Matrix& m) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) + m[8] * (m[1] * m[6] - m[2] * m[5]) < 0;
  }

  // glTF demands the bounds of positions; where they do not hold, count or offset may be damaged.
  void check_bounds(const Json& accessor, const double* low, const double* high, Cloud& cloud) const {
    const auto differs = [&](const char* key, const double* found) {
      const Json* bounds = accessor.find(key);
      if (bounds == nullptr || bounds->items.size() != 3) return true;
      for (std::size_t a = 0; a < 3; ++a) {
        if (!(std::abs(bounds->items[a].number - found[a]) <= 1e-5 * (std::abs(low[a]) + std::abs(high[a])))) return true;
      }
      return false;
    };
    if ((differs("min", low) || differs("max", high)) && cloud.warnings.empty()) {
      cloud.warnings.emplace_back("the positions do not have the bounds (min, max) that the file gives: it may be damaged");
    }
  }

  Matrix local(const Json& node) const {
    Matrix m = kIdentity;
    if (file_.numbers(node, "matrix", m.data(), 16)) return m;
    double t[3] = {0, 0, 0};
    double q[4] = {0, 0, 0, 1};
    double s[3] = {1, 1, 1};
    file_.numbers(node, "translation", t, 3);
    file_.numbers(node, "rotation", q, 4);
    file_.numbers(node, "scale", s, 3);
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    return {(1 - 2 * (y * y + z * z)) * s[0],
            2 * (x * y + z * w) * s[0],
            2 * (x * z - y * w) * s[0],
            0,
            2 * (x * y - z * w) * s[1],
            (1 - 2 * (x * x + z * z)) * s[1],
            2 * (y * z + x * w) * s[1],
            0,
            2 * (x * z + y * w) * s[2],
            2 * (y * z - x * w) * s[2],
            (1 - 2 * (x * x + y * y)) * s[2],
            0,
            t[0],
            t[1],
            t[2],
            1};
  }

  static Matrix product(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t column = 0; column < 4; ++column) {
      for (std::size_t row = 0; row < 4; ++row) {
        for (std::size_t k = 0; k < 4; ++k) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
      }
    }
    return c;
  }

  const GltfFile& file_;
  const Source& source_;
  std::vector<bool> visited_;
  bool measuring_ = false;
  std::uint64_t total_ = 0;
  std::uint64_t total_triangles_ = 0;
  Triangles* triangles_;
};

Mesh mesh_of(const GltfFile& file) {
  Mesh mesh;
  mesh.vertices = GltfReader(file, &mesh.triangles).read().positions;
  return mesh;
}

}  // namespace

Cloud read_gltf(const Source& source) { return GltfReader(GltfFile(source, source.bytes, std::nullopt)).read(); }

Cloud read_glb(const Source& source) { return GltfReader(open_glb(source)).read(); }

Mesh read_gltf_mesh(const Source& source) { return mesh_of(GltfFile(source, source.bytes, std::nullopt)); }

Mesh read_glb_mesh(const Source& source) { return mesh_of(open_glb(source)); }

}  // namespace g3r::io
