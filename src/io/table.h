// What a file holds, as typed records: elements of properties, in the order of the file. The model is PLY's, because it is the richest;
// the other formats fill one element called "vertex". Records are stored back to back, little-endian, without padding.
#pragma once

#include "io/number_type.h"

#include <g3r/io.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace g3r {

namespace io {

/// One property of an element: `count` numbers, or a list whose length each record gives first.
struct Property {
  std::string name;
  Type type = Type::kFloat32;
  bool list = false;
  Type count_type = Type::kUint8;  ///< of a list's length
  std::uint32_t count = 1;         ///< numbers in a record, 1 unless the format has arrays
};

/// Records of one kind.
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
  std::string data;  ///< the records; empty if the element has no properties

  /// Bytes of every record, 0 if lists make them differ.
  [[nodiscard]] std::size_t stride() const;
  /// Index of a property, npos if there is none.
  [[nodiscard]] std::size_t find(std::string_view property_name) const;
  /// Adds a property of one number; returns its index.
  std::size_t add(std::string property_name, Type type);
  static constexpr std::size_t npos = static_cast<std::size_t>(-1);
};

/// The element of the points, called "vertex", empty.
[[nodiscard]] Element make_vertex_element();

/// Turns the numbers of the records from big-endian to little-endian, the lengths of lists included, which say where the next one is.
void swap_records(Element& element);

/// Byte offset of every property within one record.
class RecordLayout {
 public:
  explicit RecordLayout(const Element& element);
  /// Lays out the record at `record`, whose lists lie within the element's data.
  void seek(const char* record);
  /// Offset of a property; for a list, of its length.
  [[nodiscard]] std::size_t offset(std::size_t property) const { return offsets_[property]; }
  /// Bytes of a property, the length of a list included.
  [[nodiscard]] std::size_t bytes(std::size_t property) const { return offsets_[property + 1] - offsets_[property]; }
  /// Bytes of the whole record.
  [[nodiscard]] std::size_t size() const { return offsets_.back(); }

 private:
  const Element& element_;
  bool fixed_;
  std::vector<std::size_t> offsets_;
};

}  // namespace io

class Attributes {
 public:
  enum class Dialect { kPly, kPcd, kLas, kText, kNone };
  Dialect dialect = Dialect::kPly;    ///< whose names and kinds of colours the properties follow; kNone: of no format that is written
  std::vector<std::string> comments;  ///< PLY: whole lines, "comment ..." or "obj_info ..."
  std::vector<io::Element> elements;  ///< in the order of the file
  std::size_t vertex = 0;             ///< index of the element that holds the points
  std::string raw;                    ///< LAS: the file, for what the table does not show
  [[nodiscard]] const io::Element& points() const { return elements[vertex]; }
  /// With an element of points, empty unless one is given, and no other.
  [[nodiscard]] static std::shared_ptr<Attributes> of_points(Dialect dialect, io::Element points = io::make_vertex_element());
};

}  // namespace g3r
