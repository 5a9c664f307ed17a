// Vertices of glTF 2.0 under the transforms of their nodes. What is in the file: gltf_file.h.
#include "io/gltf_file.h"
#include "io/readers.h"
#include "io/table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

namespace {

using Matrix = std::array<double, 16>;  // column major, as glTF has it

constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

class GltfReader {
 public:
  explicit GltfReader(const GltfFile& file) : file_(file), source_(file.source()) {}

  Cloud read() {
    Cloud cloud;
    cloud.format = file_.is_binary() ? "glb" : "gltf";
    cloud.scalar = Scalar::kFloat64;
    cloud.property_names = {"x", "y", "z"};
    const std::vector<Json>& nodes = file_.list("nodes");
    visited_.assign(nodes.size(), false);
    measuring_ = true;
    traverse(cloud);
    if (total_ == 0) fail(source_, "no points: no mesh in this glTF file has positions");
    cloud.positions.reserve(static_cast<std::size_t>(total_));
    measuring_ = false;
    visited_.assign(nodes.size(), false);
    traverse(cloud);
    return cloud;
  }

 private:
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
    std::set<std::size_t> added;
    for (const Json& primitive : file_.member(mesh, "primitives").items) {
      const Json* position = file_.member(primitive, "attributes").find("POSITION");
      if (position == nullptr) continue;
      const std::size_t accessor = file_.index(*position, accessors.size(), "accessor");
      if (added.insert(accessor).second) add_positions(accessors[accessor], transform, cloud);
    }
  }

  void add_positions(const Json& accessor, const Matrix& m, Cloud& cloud) {
    constexpr std::uint64_t kFloat = 5126;
    if (file_.member(accessor, "componentType").whole() != kFloat || file_.member(accessor, "type").text != "VEC3") {
      fail(source_, "expected positions of component type float and type VEC3 (quantised or compressed glTF is not read)");
    }
    if (accessor.find("sparse") != nullptr) fail(source_, "positions in a sparse accessor are not read");
    const Json& view = file_.item(file_.list("bufferViews"), file_.member(accessor, "bufferView"), "buffer view");
    const std::string_view buffer = file_.buffer(file_.member(view, "buffer"));
    const std::uint64_t view_at = file_.whole(view, "byteOffset", 0);
    const std::uint64_t view_bytes = file_.whole(view, "byteLength", 0);
    const std::uint64_t stride = file_.whole(view, "byteStride", 12);
    const std::uint64_t at = file_.whole(accessor, "byteOffset", 0);
    const std::uint64_t count = file_.whole(accessor, "count", 0);
    if (view_at > buffer.size() || view_bytes > buffer.size() - view_at || stride < 12 || stride > 255 || at > view_bytes) {
      fail(source_, "truncated: a buffer view does not lie within its buffer");
    }
    const std::uint64_t room = view_bytes - at;
    if (count != 0 && (room < 12 || count - 1 > (room - 12) / stride))
      fail(source_, "truncated: an accessor of " + std::to_string(count) + " points does not fit in its buffer view (count too large)");
    total_ += measuring_ ? count : 0;
    constexpr std::uint64_t kUses = 4;  // So many meshes or nodes may use the same bytes: memory is bounded by the size of the file.
    if (total_ > kUses * source_.bytes.size() / 12) fail(source_, "the meshes refer to the same points too many times (instances)");
    if (measuring_) return;
    const char* bytes = buffer.data() + view_at + at;
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (std::uint64_t i = 0; i < count; ++i, bytes += stride) {
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
};

}  // namespace

Cloud read_gltf(const Source& source) { return GltfReader(GltfFile(source, source.bytes, std::nullopt)).read(); }

Cloud read_glb(const Source& source) { return GltfReader(open_glb(source)).read(); }

}  // namespace g3r::io
