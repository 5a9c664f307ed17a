#include "io/las.h"

#include "io/las_extra_bytes.h"
#include "io/laz.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace g3r::io {

namespace {

using namespace las;

// Fields after X Y Z, by point format.
std::vector<LasField> standard_fields(unsigned format) {
  std::vector<LasField> fields;
  std::size_t at = 12;
  const auto add = [&](const char* name, Type type) {
    fields.push_back({name, type, at, DecimalSteps()});
    at += size_of(type);
  };
  add("intensity", Type::kUint16);
  if (format < 6) {
    add("return_flags", Type::kUint8);
    add("classification", Type::kUint8);
    add("scan_angle", Type::kInt8);
    add("user_data", Type::kUint8);
  } else {
    add("return_numbers", Type::kUint8);
    add("return_flags", Type::kUint8);
    add("classification", Type::kUint8);
    add("user_data", Type::kUint8);
    add("scan_angle", Type::kInt16);
  }
  add("point_source_id", Type::kUint16);
  if (format == 1 || format >= 3) add("gps_time", Type::kFloat64);
  if (format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10) {
    add("red", Type::kUint16);
    add("green", Type::kUint16);
    add("blue", Type::kUint16);
  }
  if (format == 8 || format == 10) add("nir", Type::kUint16);
  return fields;
}

// Whether a coordinate system in OGC's Well-Known Text is geographic: it has a geographic one and does not project it.
bool is_geographic_wkt(std::string_view wkt) {
  const auto has = [&](std::string_view a, std::string_view b) {
    return wkt.find(a) != std::string_view::npos || wkt.find(b) != std::string_view::npos;
  };
  return has("GEOGCS[", "GEOGCRS[") && !has("PROJCS[", "PROJCRS[");
}

// The same in GeoTIFF's keys: records of four 16-bit numbers, the first a header, the others key, place, count, value.
bool is_geographic_keys(std::string_view keys) {
  constexpr std::size_t kKey = 8;
  constexpr unsigned kModelType = 1024, kGeographic = 2;
  for (std::size_t at = kKey; at + kKey <= keys.size(); at += kKey) {
    if (load<std::uint16_t>(keys.data() + at) == kModelType) return load<std::uint16_t>(keys.data() + at + 6) == kGeographic;
  }
  return false;
}

// Whether the bounds that the header gives can be degrees: files name systems that their coordinates are not in.
bool can_be_degrees(const Source& source) {
  const auto bound = [&](std::size_t i) { return std::abs(load<double>(source.bytes.data() + kBounds + 8 * i)); };  // x, x, y, y, z, z
  return bound(0) <= 360 && bound(1) <= 360 && bound(2) <= 90 && bound(3) <= 90;
}

void read_vlrs(const Source& source, LasHeader& header) {
  std::size_t at = header.header_size;
  header.undescribed_bytes = header.record_bytes - kRecordSize[header.point_format];
  for (std::uint32_t i = 0; i < header.vlr_count; ++i) {
    if (header.points_at - at < kVlrHeader)
      fail_at_byte(source, at, "truncated: " + std::to_string(header.vlr_count) + " variable length records do not fit before the points");
    const auto length = load<std::uint16_t>(source.bytes.data() + at + 20);
    if (length > header.points_at - at - kVlrHeader)
      fail_at_byte(source, at, "a variable length record of " + std::to_string(length) + " bytes does not fit before the points");
    const std::string user = las_text(source.bytes.substr(at + 2, 16));
    const unsigned record = load<std::uint16_t>(source.bytes.data() + at + 18);
    if (user == "LASF_Spec" && record == kExtraBytes && header.extra_vlr == 0) {
      header.extra_vlr = at;
      read_extra_bytes(source.bytes.substr(at + kVlrHeader, length), header);
    }
    if (user == "laszip encoded" && record == kCompression && header.laszip_vlr == 0) header.laszip_vlr = at;
    if (user == "LASF_Projection") {
      const std::string_view system = source.bytes.substr(at + kVlrHeader, length);
      header.geographic |= (record == kWkt && is_geographic_wkt(system)) || (record == kGeoKeys && is_geographic_keys(system));
    }
    at += kVlrHeader + length;
  }
}

// The count of points, in one place or two, and whether the file has room for them.
void read_count(const Source& source, std::uint64_t file_size, LasHeader& header) {
  header.count = load<std::uint32_t>(source.bytes.data() + kLegacyCount);
  if (header.minor == 4) {
    const auto count = load<std::uint64_t>(source.bytes.data() + kCount);
    if (count != 0 && header.count != 0 && count != header.count) {
      fail_at_byte(source, kCount,
                   "the header has two counts of points, " + std::to_string(header.count) + " and " + std::to_string(count));
    }
    header.count = std::max(count, header.count);
  }
  if (!header.compressed && header.count > (file_size - header.points_at) / header.record_bytes) {
    fail_at_byte(source, header.points_at,
                 "truncated: " + std::to_string(header.count) + " points of " + std::to_string(header.record_bytes) +
                     " bytes declared, but only " + std::to_string(file_size - header.points_at) + " bytes follow (count too large)");
  }
}

void read_steps(const Source& source, LasHeader& header) {
  for (std::size_t a = 0; a < 3; ++a) {
    header.scale[a] = load<double>(source.bytes.data() + kScale + 8 * a);
    header.offset[a] = load<double>(source.bytes.data() + kOffset + 8 * a);
    if (!std::isfinite(header.scale[a]) || header.scale[a] == 0 || !std::isfinite(header.offset[a])) {
      fail_at_byte(source, kScale + 8 * a, "the scale or offset of an axis is zero or not finite");
    }
    header.steps[a] = DecimalSteps(header.scale[a], header.offset[a]);
  }
}

}  // namespace

LasHeader read_las_header(const Source& source, std::uint64_t file_size) {
  constexpr std::size_t kLeastHeader = 227;
  constexpr std::size_t kHeader14 = 375;
  const char* bytes = source.bytes.data();
  const std::uint64_t size = file_size != 0 ? file_size : source.bytes.size();
  if (source.bytes.size() < kLeastHeader) fail_at_byte(source, size, "truncated: a LAS header has at least 227 bytes");
  LasHeader header;
  header.minor = static_cast<unsigned char>(bytes[kMinor]);
  if (bytes[kMinor - 1] != 1 || header.minor > 4) {
    fail_at_byte(source, kMinor - 1,
                 "expected LAS version 1.0 to 1.4, found " + std::to_string(static_cast<unsigned char>(bytes[kMinor - 1])) + "." +
                     std::to_string(header.minor));
  }
  header.header_size = load<std::uint16_t>(bytes + kHeaderSize);
  header.points_at = load<std::uint32_t>(bytes + kPointsAt);
  header.vlr_count = load<std::uint32_t>(bytes + kVlrCount);
  unsigned format = static_cast<unsigned char>(bytes[kPointFormat]);
  if ((format & 0xC0U) != 0) {
    require_laz(source);
    header.compressed = true;
    format &= 0x7FU;
  }
  if (format > 10) fail_at_byte(source, kPointFormat, "expected point format 0 to 10, found " + std::to_string(format));
  header.point_format = format;
  header.record_bytes = load<std::uint16_t>(bytes + kRecordBytes);
  if (header.header_size < (header.minor == 4 ? kHeader14 : kLeastHeader) || header.header_size > header.points_at ||
      header.points_at > source.bytes.size()) {
    fail_at_byte(source, kHeaderSize,
                 "truncated or damaged: header size " + std::to_string(header.header_size) + " and start of points " +
                     std::to_string(header.points_at) + " do not go with a file of " + std::to_string(size) + " bytes");
  }
  if (header.record_bytes < kRecordSize[format]) {
    fail_at_byte(source, kRecordBytes,
                 "expected records of at least " + std::to_string(kRecordSize[format]) + " bytes for point format " +
                     std::to_string(format) + ", found " + std::to_string(header.record_bytes));
  }
  read_count(source, size, header);
  read_steps(source, header);
  header.fields = standard_fields(format);
  read_vlrs(source, header);
  header.geographic = header.geographic && can_be_degrees(source);
  return header;
}

std::string las_text(std::string_view bytes) { return std::string(bytes.substr(0, bytes.find('\0'))); }

std::int32_t las_steps(double value, const DecimalSteps& of, const char* axis) {
  const double steps = of.steps(value);
  if (!(std::abs(steps) <= std::numeric_limits<std::int32_t>::max())) {
    throw InvalidInput(std::string("write_cloud: LAS cannot hold this ") + axis + " coordinate (not finite, or outside scale and offset)");
  }
  return static_cast<std::int32_t>(steps);
}

}  // namespace g3r::io
