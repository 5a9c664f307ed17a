// What a file holds, as typed records: elements of properties, in the order of the file. The model is PLY's, because it is the richest;
// the other formats fill one element called "vertex". Records are stored back to back, little-endian, without padding.
#pragma once

#include <g3r/io.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace g3r {

static_assert(std::endian::native == std::endian::little, "records are kept in memory as little-endian bytes");

namespace io {

/// Type of one stored number.
enum class Type : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

/// Bytes of one number.
constexpr std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

constexpr bool is_float(Type type) { return type == Type::kFloat32 || type == Type::kFloat64; }

/// How a number is stored, apart from its size.
enum class NumberKind : std::uint8_t { kSigned, kUnsigned, kFloat };

/// The type of numbers of so many bytes; nothing if there is none.
std::optional<Type> type_of(NumberKind kind, std::uint64_t bytes);

template <class T>
T load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Bytes of so many items of `each` bytes: std::bad_alloc where a size does not hold them, as one of 32 bits does not hold all of what a
/// sound file may say.
inline std::size_t bytes_of(std::uint64_t count, std::uint64_t each) {
  if (each != 0 && count > std::numeric_limits<std::size_t>::max() / each) throw std::bad_alloc();
  return static_cast<std::size_t>(count * each);
}

/// What has the bytes of `from`: std::bit_cast, which standard libraries of C++20 did not have from the start.
template <class To, class From>
To bits_as(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To value;
  std::memcpy(&value, &from, sizeof value);
  return value;
}

/// The number at `bytes` as a double (64-bit integers beyond 2^53 are rounded).
double load_as_double(Type type, const char* bytes);

/// Stores `value` at `bytes`: rounded to nearest and kept within range for integers (0 for NaN), to nearest for float.
void store_double(Type type, double value, char* bytes);

/// The same after the last of `bytes`.
void append_double(Type type, double value, std::string& bytes);

/// Turns the number at `bytes` from big-endian to little-endian or back.
void swap_bytes(Type type, char* bytes);

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
  enum class Dialect { kPly, kPcd, kLas, kText };
  Dialect dialect = Dialect::kPly;    ///< whose names the properties follow
  std::vector<std::string> comments;  ///< PLY: whole lines, "comment ..." or "obj_info ..."
  std::vector<io::Element> elements;  ///< in the order of the file
  std::size_t vertex = 0;             ///< index of the element that holds the points
  std::string raw;                    ///< LAS: the file, for what the table does not show
  [[nodiscard]] const io::Element& points() const { return elements[vertex]; }
  /// With an element of points, empty unless one is given, and no other.
  [[nodiscard]] static std::shared_ptr<Attributes> of_points(Dialect dialect, io::Element points = io::make_vertex_element());
};

}  // namespace g3r
