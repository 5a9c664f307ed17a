// Vertices of glTF 2.0, binary (GLB) or text with embedded buffers, under the transforms of their nodes. No other file is opened.
#include "io/json.h"
#include "io/readers.h"
#include "io/table.h"

#include <cmath>
#include <limits>
#include <optional>

namespace g3r::io {

namespace {

using Matrix = std::array<double, 16>;  // column major, as glTF has it

constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

std::optional<std::string> decode_base64(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int held = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>(bits >> held & 255U);
  }
  return bytes;
}

class GltfReader {
 public:
  GltfReader(const Source& source, std::string_view text, std::optional<std::string_view> binary) : source_(source), binary_(binary) {
    std::optional<Json> root = parse_json(text, affordable_values(source.bytes.size()));
    if (!root) fail(source, "damaged: the JSON of this glTF file is not well formed (truncated?), or has too many values for its size");
    root_ = std::move(*root);
    if (!root_.is_object()) fail(source, "expected a JSON object at the root of a glTF file");
  }

  Cloud read() {
    load_buffers();
    Cloud cloud;
    cloud.format = binary_ ? "glb" : "gltf";
    cloud.scalar = Scalar::kFloat64;
    cloud.property_names = {"x", "y", "z"};
    const std::vector<Json>& nodes = list("nodes");
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
    const std::vector<Json>& nodes = list("nodes");
    if (nodes.empty()) {
      for (const Json& mesh : list("meshes")) add_mesh(mesh, kIdentity, cloud);
      return;
    }
    const std::vector<Json>& scenes = list("scenes");
    if (scenes.empty()) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!visited_[i]) visit(i, kIdentity, 0, cloud);
      }
      return;
    }
    const Json* chosen = root_.find("scene");
    const Json& scene = chosen != nullptr ? item(scenes, *chosen, "scene") : scenes[0];
    const Json* roots = scene.find("nodes");
    if (roots == nullptr) return;
    for (const Json& node : roots->items) visit(index(node, nodes.size(), "node"), kIdentity, 0, cloud);
  }

  void visit(std::size_t i, const Matrix& parent, int depth, Cloud& cloud) {
    constexpr int kDeepest = 1000;  // Deeper trees would use up the stack.
    if (visited_[i] || depth > kDeepest) fail(source_, "the nodes of this glTF file are no tree");
    visited_[i] = true;
    const Json& node = list("nodes")[i];
    const Matrix transform = product(parent, local(node));
    if (const Json* mesh = node.find("mesh")) add_mesh(item(list("meshes"), *mesh, "mesh"), transform, cloud);
    const Json* children = node.find("children");
    if (children == nullptr) return;
    for (const Json& child : children->items) visit(index(child, visited_.size(), "node"), transform, depth + 1, cloud);
  }

  void add_mesh(const Json& mesh, const Matrix& transform, Cloud& cloud) {
    for (const Json& primitive : member(mesh, "primitives").items) {
      const Json* position = member(primitive, "attributes").find("POSITION");
      if (position != nullptr) add_positions(item(list("accessors"), *position, "accessor"), transform, cloud);
    }
  }

  void add_positions(const Json& accessor, const Matrix& m, Cloud& cloud) {
    constexpr std::uint64_t kFloat = 5126;
    if (member(accessor, "componentType").whole() != kFloat || member(accessor, "type").text != "VEC3") {
      fail(source_, "expected positions of component type float and type VEC3 (quantised or compressed glTF is not read)");
    }
    if (accessor.find("sparse") != nullptr) fail(source_, "positions in a sparse accessor are not read");
    const Json& view = item(list("bufferViews"), member(accessor, "bufferView"), "buffer view");
    const std::string_view buffer = buffers_[index(member(view, "buffer"), buffers_.size(), "buffer")];
    const std::uint64_t view_at = whole(view, "byteOffset", 0);
    const std::uint64_t view_bytes = whole(view, "byteLength", 0);
    const std::uint64_t stride = whole(view, "byteStride", 12);
    const std::uint64_t at = whole(accessor, "byteOffset", 0);
    const std::uint64_t count = whole(accessor, "count", 0);
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
    if (numbers(node, "matrix", m.data(), 16)) return m;
    double t[3] = {0, 0, 0};
    double q[4] = {0, 0, 0, 1};
    double s[3] = {1, 1, 1};
    numbers(node, "translation", t, 3);
    numbers(node, "rotation", q, 4);
    numbers(node, "scale", s, 3);
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

  void load_buffers() {
    const std::vector<Json>& buffers = list("buffers");
    buffers_.reserve(buffers.size());
    decoded_.reserve(buffers.size());
    for (const Json& buffer : buffers) {
      const Json* address = buffer.find("uri");
      if (address == nullptr) {
        if (!binary_) fail(source_, "a buffer without data");
        buffers_.push_back(*binary_);
        continue;
      }
      const std::string_view uri = address->text;
      const std::size_t comma = uri.find(";base64,");
      if (!uri.starts_with("data:") || comma == std::string_view::npos)
        fail(source_, "the points are in another file, which is not opened: convert to GLB");
      std::optional<std::string> bytes = decode_base64(uri.substr(comma + 8));
      if (!bytes) fail(source_, "damaged base64 data in a buffer");
      decoded_.push_back(std::move(*bytes));
      buffers_.push_back(decoded_.back());
    }
  }

  // A top-level array, empty if absent.
  const std::vector<Json>& list(std::string_view key) const {
    static const std::vector<Json> nothing;
    const Json* found = root_.find(key);
    if (found == nullptr) return nothing;
    if (!found->is_array()) fail(source_, "expected an array of " + std::string(key));
    return found->items;
  }

  const Json& member(const Json& object, std::string_view key) const {
    const Json* found = object.find(key);
    if (found == nullptr) fail(source_, "expected the key " + quote(key) + " in this glTF file");
    return *found;
  }

  std::size_t index(const Json& value, std::size_t size, const char* what) const {
    const std::optional<std::uint64_t> whole = value.whole();
    if (!whole || *whole >= size) fail(source_, std::string("the index of a ") + what + " is out of range");
    return static_cast<std::size_t>(*whole);
  }
  const Json& item(const std::vector<Json>& array, const Json& value, const char* what) const {
    return array[index(value, array.size(), what)];
  }

  std::uint64_t whole(const Json& object, std::string_view key, std::uint64_t otherwise) const {
    const Json* found = object.find(key);
    if (found == nullptr) return otherwise;
    const std::optional<std::uint64_t> value = found->whole();
    if (!value) fail(source_, "expected a whole number for " + quote(key));
    return *value;
  }

  // Reads an array of numbers into `out`; false if there is none.
  bool numbers(const Json& object, std::string_view key, double* out, std::size_t count) const {
    const Json* found = object.find(key);
    if (found == nullptr) return false;
    if (found->items.size() != count) fail(source_, "expected " + std::to_string(count) + " numbers in a node's transform");
    for (std::size_t i = 0; i < count; ++i) {
      if (!found->items[i].is_number()) fail(source_, "expected a number in a node's transform");
      out[i] = found->items[i].number;
    }
    return true;
  }

  const Source& source_;
  std::optional<std::string_view> binary_;
  Json root_;
  std::vector<std::string> decoded_;
  std::vector<std::string_view> buffers_;
  std::vector<bool> visited_;
  bool measuring_ = false;
  std::uint64_t total_ = 0;
};

}  // namespace

Cloud read_gltf(const Source& source) { return GltfReader(source, source.bytes, std::nullopt).read(); }

Cloud read_glb(const Source& source) {
  const std::string_view bytes = source.bytes;
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunk = 8;
  if (bytes.size() < kHeader + kChunk) fail(source, "truncated: a GLB file has at least 20 bytes");
  if (load<std::uint32_t>(bytes.data() + 4) != 2)
    fail_at_byte(source, 4, "expected GLB version 2, found " + std::to_string(load<std::uint32_t>(bytes.data() + 4)));
  const auto length = load<std::uint32_t>(bytes.data() + 8);
  if (length != bytes.size())
    fail_at_byte(source, 8,
                 "truncated or damaged: the header gives a size of " + std::to_string(length) + " bytes, the file has " +
                     std::to_string(bytes.size()));
  const auto chunk = [&](std::size_t at, std::string_view type) {
    if (bytes.size() - at < kChunk) fail_at_byte(source, at, "truncated: expected a chunk");
    const auto size = load<std::uint32_t>(bytes.data() + at);
    if (bytes.substr(at + 4, 4) != type)
      fail_at_byte(source, at + 4, "expected a chunk of type " + quote(type) + ", found " + quote(bytes.substr(at + 4, 4)));
    if (size > bytes.size() - at - kChunk)
      fail_at_byte(source, at, "truncated: a chunk of " + std::to_string(size) + " bytes does not fit in the file");
    return bytes.substr(at + kChunk, size);
  };
  const std::string_view text = chunk(kHeader, "JSON");
  const std::size_t next = kHeader + kChunk + (text.size() + 3) / 4 * 4;
  std::string_view binary;
  if (next < bytes.size()) binary = chunk(next, std::string_view("BIN\0", 4));
  return GltfReader(source, text, binary).read();
}

}  // namespace g3r::io
