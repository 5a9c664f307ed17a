// LAS 1.0 to 1.4, all point formats (LAZ through unpack_laz()): coordinates as X scale + offset in double (decimal_steps.h), every other
// field and described extra byte as a property, with the scale and offset of its descriptor.
#include "io/cloud_from_table.h"
#include "io/copc.h"
#include "io/las.h"
#include "io/laz.h"
#include "io/readers.h"

#include <algorithm>
#include <cmath>

namespace g3r::io {

namespace {

// Two fields of one name: the later get a number.
void make_unique(std::vector<Property>& properties) {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    const auto end = properties.begin() + static_cast<std::ptrdiff_t>(i);
    const auto twin = [&](const Property& other) { return other.name == properties[i].name; };
    for (int number = 2; std::any_of(properties.begin(), end, twin); ++number) (properties[i].name += '_') += std::to_string(number);
  }
}

// What follows the points where nothing should, and points outside the bounds that the header gives: signs of a damaged header.
void check_against_header(const Source& source, const LasHeader& header, Cloud& cloud) {
  const char* bytes = source.bytes.data();
  const std::uint64_t end = header.points_at + header.count * header.record_bytes;
  std::uint64_t next = source.bytes.size();
  if (header.minor >= 3 && header.header_size >= las::kWaveform + 8 && load<std::uint64_t>(bytes + las::kWaveform) >= end)
    next = std::min(next, load<std::uint64_t>(bytes + las::kWaveform));
  if (header.minor == 4 && load<std::uint32_t>(bytes + las::kEvlrCount) != 0 && load<std::uint64_t>(bytes + las::kEvlrAt) >= end) {
    next = std::min(next, load<std::uint64_t>(bytes + las::kEvlrAt));
  }
  if (next > end) cloud.warnings.push_back(std::to_string(next - end) + " trailing (extra) bytes after the last point are not used");
  for (std::size_t a = 0; a < 3; ++a) {
    const auto high = load<double>(bytes + las::kBounds + 16 * a);
    const auto low = load<double>(bytes + las::kBounds + 16 * a + 8);
    const double slack = std::abs(header.scale[a]) + 1e-9 * std::max(std::abs(high), std::abs(low));
    double found[2] = {INFINITY, -INFINITY};
    for (const Vec3& p : cloud.positions) {
      found[0] = std::min(found[0], p[a]);
      found[1] = std::max(found[1], p[a]);
    }
    if (!cloud.positions.empty() && !(std::abs(found[0] - low) <= slack && std::abs(found[1] - high) <= slack)) {
      cloud.warnings.emplace_back("the points do not have the bounds that the header gives: the header may be damaged");
      return;
    }
  }
}

}  // namespace

Attributes las_table(const LasHeader& header) {
  Attributes table;
  table.dialect = Attributes::Dialect::kLas;
  table.elements.push_back(make_vertex_element());
  Element& points = table.elements.back();
  points.count = header.count;
  points.properties.reserve(3 + header.fields.size());
  for (const char* axis : {"x", "y", "z"}) points.add(axis, Type::kFloat64);
  for (const LasField& field : header.fields) points.add(field.name, field.read_type());
  make_unique(points.properties);
  return table;
}

char* copy_las_record(const LasHeader& header, const char* record, char* to) {
  for (std::size_t a = 0; a < 3; ++a, to += sizeof(double)) {
    const double value = header.steps[a].value(load<std::int32_t>(record + 4 * a));
    std::memcpy(to, &value, sizeof value);
  }
  for (const LasField& field : header.fields) {
    if (!field.is_scaled()) {
      to = std::copy_n(record + field.offset, size_of(field.type), to);
      continue;
    }
    const double value = field.steps.value(load_as_double(field.type, record + field.offset));
    std::memcpy(to, &value, sizeof value);
    to += sizeof value;
  }
  return to;
}

Cloud read_las(const Source& source, const ReadOptions& options) {
  const LasHeader header = read_las_header(source);
  if (header.compressed) {
    const std::string unpacked = unpack_laz(source, header, options);
    Cloud cloud = read_las({unpacked, source.name}, options);
    cloud.format.replace(0, 3, "laz");
    if (is_copc(source, header)) cloud.format += ", COPC";
    return cloud;
  }
  auto table = std::make_shared<Attributes>(las_table(header));
  Element& points = table->elements.back();
  const auto count = static_cast<std::size_t>(header.count);
  points.data.resize(bytes_of(count, points.stride()));
  char* to = points.data.data();
  const char* record = source.bytes.data() + header.points_at;
  for (std::size_t i = 0; i < count; ++i, record += header.record_bytes) to = copy_las_record(header, record, to);
  table->raw = std::string(source.bytes);
  Cloud cloud;
  cloud.format = std::string("las 1.") += std::to_string(header.minor) + ", point format " + std::to_string(header.point_format);
  fill_cloud(source, table, cloud);
  check_against_header(source, header, cloud);
  if (header.geographic) cloud.warnings.emplace_back(kDegrees);
  return cloud;
}

}  // namespace g3r::io
