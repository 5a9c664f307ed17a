// PLY as points or as a mesh. What is in the file: ply_header.h, ply_body.h.
#include "io/cloud_from_table.h"
#include "io/ply_body.h"
#include "io/polygons.h"
#include "io/readers.h"
#include "io/splats.h"

#include <algorithm>
#include <utility>

namespace g3r::io {

namespace {

const char* encoding_name(PlyEncoding encoding) {
  return encoding == PlyEncoding::kText           ? "ply ascii"
         : encoding == PlyEncoding::kLittleEndian ? "ply binary_little_endian"
                                                  : "ply binary_big_endian";
}

std::shared_ptr<Attributes> read_table(const Source& source, Cloud& cloud) {
  PlyHeader header = read_ply_header(source);
  cloud.format = encoding_name(header.encoding);
  read_ply_body(source, header, cloud.warnings);
  auto table = std::make_shared<Attributes>();
  table->comments = std::move(header.comments);
  table->elements = std::move(header.elements);
  table->vertex = header.vertex;
  return table;
}

// The lists of corners of the element "face".
class Faces {
 public:
  explicit Faces(const Attributes& table) {
    const auto face = std::find_if(table.elements.begin(), table.elements.end(), [](const Element& e) { return e.name == "face"; });
    if (face == table.elements.end()) return;
    element_ = &*face;
    indices_ = std::min(face->find("vertex_indices"), face->find("vertex_index"));
  }
  [[nodiscard]] bool exist() const { return element_ != nullptr && indices_ != Element::npos; }
  [[nodiscard]] const Property& list() const { return element_->properties[indices_]; }
  [[nodiscard]] bool are_integer_lists() const { return exist() && list().list && !is_float(list().type); }
  // visit(face, number of corners, address of the first)
  template <class Visit>
  void for_each(const Visit& visit) const {
    RecordLayout layout(*element_);
    const char* record = element_->data.data();
    for (std::uint64_t i = 0; i < element_->count; ++i, record += layout.size()) {
      layout.seek(record);
      const char* field = record + layout.offset(indices_);
      visit(i, static_cast<std::size_t>(load_as_double(list().count_type, field)), field + size_of(list().count_type));
    }
  }

 private:
  const Element* element_ = nullptr;
  std::size_t indices_ = Element::npos;
};

// Faces that cannot be are a sign that the counts of the header are wrong, even if points alone are wanted.
void check_faces(const Attributes& table, std::vector<std::string>& warnings) {
  const Faces faces(table);
  if (!faces.are_integer_lists()) return;
  const auto vertices = static_cast<double>(table.points().count);
  const Type type = faces.list().type;
  std::size_t damaged = 0;
  faces.for_each([&](std::uint64_t, std::size_t corners, const char* corner) {
    bool sound = corners >= 3;
    for (std::size_t k = 0; sound && k < corners; ++k) {
      const double index = load_as_double(type, corner + k * size_of(type));
      sound = index >= 0 && index < vertices;
    }
    damaged += sound ? 0 : 1;
  });
  if (damaged != 0) {
    warnings.push_back(std::to_string(damaged) +
                       " faces have fewer than three corners or name vertices that do not exist: the file may be damaged");
  }
}

}  // namespace

Cloud read_ply(const Source& source, const ReadOptions& options) {
  Cloud cloud;
  std::shared_ptr<Attributes> table = read_table(source, cloud);
  check_faces(*table, cloud.warnings);
  if (is_splat(table->points())) {
    fill_splat_cloud(source, std::move(table), options, cloud);
  } else {
    fill_cloud(source, std::move(table), cloud);
  }
  return cloud;
}

Mesh read_ply_mesh(const Source& source) {
  Cloud cloud;
  const std::shared_ptr<Attributes> table = read_table(source, cloud);
  fill_cloud(source, table, cloud);
  const Faces faces(*table);
  if (!faces.exist()) fail_without_faces(source, "no faces: a mesh needs an element \"face\" with a list \"vertex_indices\"");
  if (!faces.are_integer_lists()) fail(source, "the property \"vertex_indices\" must be a list of integers");

  Mesh mesh;
  mesh.vertices = std::move(cloud.positions);
  mesh.colors = std::move(cloud.colors);
  mesh.confidence = std::move(cloud.confidence);
  Fans fans(source, mesh);
  faces.for_each([&](std::uint64_t, std::size_t corners, const char*) { fans.count(corners); });
  fans.reserve();
  const Type type = faces.list().type;
  faces.for_each([&](std::uint64_t i, std::size_t corners, const char* corner) {
    fans.begin(i, "face");
    for (std::size_t k = 0; k < corners; ++k, corner += size_of(type)) fans.corner(load_as_double(type, corner));
  });
  return mesh;
}

std::optional<StoredTable> find_ply_records(const Source& head, std::uint64_t file_size) {
  if (head.bytes.find("\nend_header") == std::string_view::npos) return std::nullopt;  // a line of its own, and not in a comment
  PlyHeader header = read_ply_header(head);
  if (header.encoding != PlyEncoding::kLittleEndian || header.vertex != 0) return std::nullopt;
  if (is_splat(header.elements[0])) return std::nullopt;
  return stored_table(Attributes::Dialect::kPly, std::move(header.comments), std::move(header.elements[0]), header.body, file_size);
}

}  // namespace g3r::io
