// The layout of LAS files. Source: ASPRS, "LAS Specification 1.4 - R15", 2019.
#pragma once

#include "io/decimal_steps.h"
#include "io/source.h"
#include "io/table.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace g3r::io {

/// One field of a point record.
struct LasField {
  std::string name;
  Type type;           ///< as it is stored
  std::size_t offset;  ///< in the record
  DecimalSteps steps;  ///< of extra bytes: scale and offset, with which they are no longer of this type
  [[nodiscard]] bool is_scaled() const { return steps.scale() != 1 || steps.offset() != 0; }
  /// Of the property that it becomes.
  [[nodiscard]] Type read_type() const { return is_scaled() ? Type::kFloat64 : type; }
};

/// What is needed of a header, checked against the size of the file.
struct LasHeader {
  unsigned minor = 0;         ///< version 1.minor
  unsigned point_format = 0;  ///< 0..10
  bool compressed = false;    ///< LAZ: what follows points_at are not records
  std::size_t header_size = 0;
  std::size_t points_at = 0;  ///< byte offset of the first record
  std::size_t record_bytes = 0;
  std::uint64_t count = 0;
  std::uint32_t vlr_count = 0;
  Vec3 scale{1, 1, 1};
  Vec3 offset{0, 0, 0};
  std::array<DecimalSteps, 3> steps;  ///< the same
  std::vector<LasField> fields;       ///< after X Y Z, described extra bytes included
  std::size_t undescribed_bytes = 0;  ///< extra bytes at the end of a record that no descriptor names
  std::size_t extra_vlr = 0;          ///< byte offset of the Extra Bytes record's header, 0 if there is none
  std::size_t laszip_vlr = 0;         ///< the same of the record that says how a LAZ file is compressed
  bool geographic = false;            ///< x and y are degrees: the coordinate system that the file names, and its bounds, say so
};

/// Byte offsets in the public header block.
namespace las {
inline constexpr std::size_t kMinor = 25, kHeaderSize = 94, kPointsAt = 96, kVlrCount = 100, kPointFormat = 104, kRecordBytes = 105,
                             kLegacyCount = 107, kScale = 131, kOffset = 155, kBounds = 179, kWaveform = 227, kEvlrAt = 235,
                             kEvlrCount = 243, kCount = 247, kVlrHeader = 54, kDescriptor = 192;
inline constexpr std::array<std::size_t, 11> kRecordSize = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
inline constexpr unsigned kExtraBytes = 4;       // record id, user id "LASF_Spec"
inline constexpr unsigned kCompression = 22204;  // record id, user id "laszip encoded"
inline constexpr unsigned kWkt = 2112;           // record ids, user id "LASF_Projection"
inline constexpr unsigned kGeoKeys = 34735;

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}
}  // namespace las

/// Reads and checks a header. Throws InvalidInput; for LAZ, where it cannot be read, with the name of a converter.
/// `file_size`: of a file of which `source` holds what comes before the points; 0: the source is all of it.
LasHeader read_las_header(const Source& source, std::uint64_t file_size = 0);

/// The properties of the points, x, y and z first, then the fields; without data.
Attributes las_table(const LasHeader& header);

/// A record of the file as one of las_table() at `to`; returns its end.
char* copy_las_record(const LasHeader& header, const char* record, char* to);

/// The text in so many bytes, which ends at the first 0.
std::string las_text(std::string_view bytes);

/// The integer that a coordinate is stored as. Throws InvalidInput, with the name of the axis, if there is none.
std::int32_t las_steps(double value, const DecimalSteps& of, const char* axis);

}  // namespace g3r::io
