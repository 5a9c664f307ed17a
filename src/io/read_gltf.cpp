// Vertices of glTF 2.0, binary (GLB) or text with embedded buffers, under the transforms of their nodes. No other file is opened.
#include "io/readers.h"
#include "io/table.h"

#include <cmath>
#include <limits>
#include <optional>

#include <nlohmann/json.hpp>

namespace g3r::io {

namespace {

using nlohmann::json;
using Matrix = std::array<double, 16>;  // column major, as glTF has it

constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// Counts the values of a JSON text without keeping any, so that its tree can be refused before it is built.
struct Counter : json::json_sax_t {
  static constexpr int kDeepest = 64;
  std::size_t values = 0;
  int depth = 0;
  bool count() {
    ++values;
    return true;
  }
  bool null() override { return count(); }
  bool boolean(bool) override { return count(); }
  bool number_integer(number_integer_t) override { return count(); }
  bool number_unsigned(number_unsigned_t) override { return count(); }
  bool number_float(number_float_t, const string_t&) override { return count(); }
  bool string(string_t&) override { return count(); }
  bool binary(binary_t&) override { return count(); }
  bool start_object(std::size_t) override { return count() && ++depth <= kDeepest; }
  bool key(string_t&) override { return count(); }
  bool end_object() override { return --depth, true; }
  bool start_array(std::size_t) override { return count() && ++depth <= kDeepest; }
  bool end_array() override { return --depth, true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }
};

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
    Counter counter;
    if (!json::sax_parse(text, &counter)) fail(source, "damaged: the JSON of this glTF file is not well formed (truncated?)");
    constexpr std::size_t kBytesPerValue = 64;  // of the tree
    constexpr std::size_t kAllowance = std::size_t{1} << 19;
    if (counter.values * kBytesPerValue > 6 * source.bytes.size() + kAllowance)
      fail(source, "the JSON of this glTF file holds too many values for its size");
    root_ = json::parse(text);
    if (!root_.is_object()) fail(source, "expected a JSON object at the root of a glTF file");
  }

  Cloud read() {
    load_buffers();
    Cloud cloud;
    cloud.format = binary_ ? "glb" : "gltf";
    cloud.scalar = Scalar::kFloat64;
    cloud.property_names = {"x", "y", "z"};
    const json& nodes = list("nodes");
    visited_.assign(nodes.size(), false);
    measuring_ = true;
    traverse(cloud);
    cloud.positions.reserve(static_cast<std::size_t>(total_));
    measuring_ = false;
    visited_.assign(nodes.size(), false);
    traverse(cloud);
    return cloud;
  }

 private:
  void traverse(Cloud& cloud) {
    const json& nodes = list("nodes");
    if (nodes.empty()) {
      for (const json& mesh : list("meshes")) add_mesh(mesh, kIdentity, cloud);
      return;
    }
    const json& scenes = list("scenes");
    if (scenes.empty()) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!visited_[i]) visit(i, kIdentity, 0, cloud);
      }
      return;
    }
    const json& scene = item(scenes, root_.value("scene", json(0U)), "scene");
    if (!scene.contains("nodes")) return;
    if (!scene["nodes"].is_array()) fail(source_, "expected an array of nodes in the scene");
    for (const json& node : scene["nodes"]) visit(index(node, nodes.size(), "node"), kIdentity, 0, cloud);
  }

  void visit(std::size_t i, const Matrix& parent, int depth, Cloud& cloud) {
    constexpr int kDeepest = 1000;
    if (visited_[i] || depth > kDeepest) fail(source_, "the nodes of this glTF file are no tree");
    visited_[i] = true;
    const json& node = list("nodes")[i];
    if (!node.is_object()) fail(source_, "expected an object for a node");
    const Matrix transform = product(parent, local(node));
    if (node.contains("mesh")) add_mesh(item(list("meshes"), node["mesh"], "mesh"), transform, cloud);
    if (!node.contains("children")) return;
    for (const json& child : node["children"]) visit(index(child, visited_.size(), "node"), transform, depth + 1, cloud);
  }

  void add_mesh(const json& mesh, const Matrix& transform, Cloud& cloud) {
    if (!mesh.is_object() || !mesh.contains("primitives") || !mesh["primitives"].is_array()) fail(source_, "expected primitives in a mesh");
    for (const json& primitive : mesh["primitives"]) {
      if (!primitive.is_object() || !primitive.contains("attributes") || !primitive["attributes"].is_object())
        fail(source_, "expected attributes in a primitive");
      const json& attributes = primitive["attributes"];
      if (attributes.contains("POSITION")) add_positions(item(list("accessors"), attributes["POSITION"], "accessor"), transform, cloud);
    }
  }

  void add_positions(const json& accessor, const Matrix& m, Cloud& cloud) {
    constexpr int kFloat = 5126;
    if (!accessor.is_object() || accessor.value("componentType", json()) != kFloat || accessor.value("type", json()) != "VEC3") {
      fail(source_, "expected positions of component type float and type VEC3 (quantised or compressed glTF is not read)");
    }
    if (accessor.contains("sparse") || !accessor.contains("bufferView"))
      fail(source_, "positions in a sparse or compressed accessor are not read");
    const json& view = item(list("bufferViews"), accessor["bufferView"], "buffer view");
    if (!view.is_object()) fail(source_, "expected an object for a buffer view");
    const std::string_view buffer = buffers_[index(view.value("buffer", json()), buffers_.size(), "buffer")];
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
    constexpr std::uint64_t kUses = 4;  // of the same bytes by several meshes or nodes
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
  void check_bounds(const json& accessor, const double* low, const double* high, Cloud& cloud) const {
    const auto differs = [&](const char* key, const double* found) {
      const json bounds = accessor.value(key, json());
      for (std::size_t a = 0; a < 3; ++a) {
        if (!bounds.is_array() || bounds.size() != 3 || !bounds[a].is_number()) return true;
        if (!(std::abs(bounds[a].get<double>() - found[a]) <= 1e-5 * (std::abs(low[a]) + std::abs(high[a])))) return true;
      }
      return false;
    };
    if ((differs("min", low) || differs("max", high)) && cloud.warnings.empty()) {
      cloud.warnings.emplace_back("the positions do not have the bounds (min, max) that the file gives: it may be damaged");
    }
  }

  Matrix local(const json& node) {
    Matrix m = kIdentity;
    if (node.contains("matrix")) {
      numbers(node["matrix"], m.data(), 16);
      return m;
    }
    double t[3] = {0, 0, 0};
    double q[4] = {0, 0, 0, 1};
    double s[3] = {1, 1, 1};
    if (node.contains("translation")) numbers(node["translation"], t, 3);
    if (node.contains("rotation")) numbers(node["rotation"], q, 4);
    if (node.contains("scale")) numbers(node["scale"], s, 3);
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
    const json& buffers = list("buffers");
    buffers_.reserve(buffers.size());
    decoded_.reserve(buffers.size());
    for (const json& buffer : buffers) {
      if (!buffer.is_object()) fail(source_, "expected an object for a buffer");
      if (!buffer.contains("uri")) {
        if (!binary_) fail(source_, "a buffer without data");
        buffers_.push_back(*binary_);
        continue;
      }
      if (!buffer["uri"].is_string()) fail(source_, "expected text for the uri of a buffer");
      const std::string_view uri = buffer["uri"].get_ref<const std::string&>();
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
  const json& list(const char* key) const {
    static const json kEmpty = json::array();
    const auto found = root_.find(key);
    if (found == root_.end()) return kEmpty;
    if (!found->is_array()) fail(source_, std::string("expected an array of ") + key);
    return *found;
  }

  std::size_t index(const json& value, std::size_t size, const char* what) const {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= size)
      fail(source_, std::string("the index of a ") + what + " is out of range");
    return value.get<std::size_t>();
  }
  const json& item(const json& array, const json& value, const char* what) const { return array[index(value, array.size(), what)]; }

  std::uint64_t whole(const json& object, const char* key, std::uint64_t otherwise) const {
    const auto found = object.find(key);
    if (found == object.end()) return otherwise;
    if (!found->is_number_unsigned()) fail(source_, std::string("expected a whole number for ") + key);
    return found->get<std::uint64_t>();
  }

  void numbers(const json& array, double* out, std::size_t count) const {
    if (!array.is_array() || array.size() != count) fail(source_, "expected " + std::to_string(count) + " numbers in a node's transform");
    for (std::size_t i = 0; i < count; ++i) {
      if (!array[i].is_number()) fail(source_, "expected a number in a node's transform");
      out[i] = array[i].get<double>();
    }
  }

  const Source& source_;
  std::optional<std::string_view> binary_;
  json root_;
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
