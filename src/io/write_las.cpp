// LAS out, or LAZ. A cloud read from LAS keeps its header, variable length records and every byte of every record; normals and confidence
// are added as extra bytes (NormalX, NormalY, NormalZ, confidence). Other clouds become LAS 1.4, point format 0 or 2, all other properties
// as extra bytes.
#include "io/las.h"
#include "io/las_output.h"
#include "io/text.h"
#include "io/writers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace g3r::io {

namespace {

using namespace las;

constexpr const char* kNormalNames[] = {"NormalX", "NormalY", "NormalZ"};
constexpr std::size_t kNameBytes = 32;  // of an extra-bytes descriptor

// Fields of points, under the names that LAS and its readers have for them: extra bytes of the same name make readers stumble.
constexpr const char* kFieldNames[] = {"x",
                                       "y",
                                       "z",
                                       "intensity",
                                       "return_number",
                                       "return_numbers",
                                       "number_of_returns",
                                       "return_flags",
                                       "bit_fields",
                                       "scan_direction_flag",
                                       "edge_of_flight_line",
                                       "classification",
                                       "raw_classification",
                                       "classification_flags",
                                       "synthetic",
                                       "key_point",
                                       "withheld",
                                       "overlap",
                                       "scanner_channel",
                                       "scan_angle",
                                       "scan_angle_rank",
                                       "user_data",
                                       "point_source_id",
                                       "gps_time",
                                       "red",
                                       "green",
                                       "blue",
                                       "nir"};

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// An extra-bytes descriptor; type 0 with `options` bytes stands for bytes without meaning.
std::string descriptor(const std::string& name, unsigned type, std::size_t options) {
  std::string bytes(kDescriptor, '\0');
  bytes[2] = static_cast<char>(type);
  bytes[3] = static_cast<char>(options);
  bytes.replace(4, std::min(name.size(), kNameBytes), name, 0, kNameBytes);
  return bytes;
}

std::string vlr_header(std::size_t length) {
  std::string bytes(kVlrHeader, '\0');
  bytes.replace(2, 9, "LASF_Spec");
  put(bytes, 18, static_cast<std::uint16_t>(kExtraBytes));
  put(bytes, 20, static_cast<std::uint16_t>(length));
  bytes.replace(22, 11, "Extra Bytes");
  return bytes;
}

// A number appended to every record, or stored over a field that the record has.
struct Added {
  Type type;
  std::size_t offset;
  std::size_t axis;  // 0..2: normal; 3: confidence
};

double added_value(const PointData& data, const Added& added, std::size_t i) {
  return added.axis < 3 ? (*data.normals)[i][added.axis] : static_cast<double>((*data.confidence)[i]);
}

// The integer that a coordinate is stored as.
std::int32_t quantise(double value, double scale, double offset, const char* axis) {
  const double steps = std::nearbyint((value - offset) / scale);
  if (!(std::abs(steps) <= std::numeric_limits<std::int32_t>::max())) {
    throw InvalidInput(std::string("write_cloud: LAS cannot hold this ") + axis + " coordinate (not finite, or outside scale and offset)");
  }
  return static_cast<std::int32_t>(steps);
}

void store_position(const PointData& data, std::size_t i, const Vec3& scale, const Vec3& offset, char* record) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    const double value = data.cloud.positions[i][a];
    if (load<std::int32_t>(record + 4 * a) * scale[a] + offset[a] == value) continue;  // as it was in the file, to the bit
    const std::int32_t steps = quantise(value, scale[a], offset[a], kAxes[a]);
    std::memcpy(record + 4 * a, &steps, sizeof steps);
  }
}

// Chooses where normals and confidence go in records of `header`; descriptors of new ones are appended to `descriptors`.
std::vector<Added> place_added(const PointData& data, const LasHeader& header, std::size_t& record_bytes, std::string& descriptors) {
  std::vector<Added> added;
  const auto place = [&](const char* name, std::size_t axis) {
    for (const LasField& field : header.fields) {
      if (field.name == name && is_float(field.type)) {
        added.push_back({field.type, field.offset, axis});
        return;
      }
    }
    if (added.empty() || record_bytes == header.record_bytes) {
      for (std::size_t left = header.undescribed_bytes; left > 0; left -= std::min<std::size_t>(left, 255)) {
        descriptors += descriptor("undescribed", 0, std::min<std::size_t>(left, 255));
      }
    }
    descriptors += descriptor(name, las_type_number(Type::kFloat32), 0);
    added.push_back({Type::kFloat32, record_bytes, axis});
    record_bytes += size_of(Type::kFloat32);
  };
  if (data.normals != nullptr) {
    for (std::size_t a = 0; a < 3; ++a) place(kNormalNames[a], a);
  }
  if (data.confidence != nullptr) place("confidence", 3);
  if (record_bytes > std::numeric_limits<std::uint16_t>::max()) throw InvalidInput("write_cloud: LAS records cannot hold more extra bytes");
  return added;
}

// The header and variable length records of the source with room for the descriptors.
std::string extended_header(std::string_view raw, const LasHeader& header, std::size_t record_bytes, const std::string& descriptors) {
  std::string text(raw.substr(0, header.points_at));
  if (!descriptors.empty()) {
    if (header.extra_vlr != 0) {
      const std::size_t length = load<std::uint16_t>(text.data() + header.extra_vlr + 20);
      if (length + descriptors.size() > std::numeric_limits<std::uint16_t>::max())
        throw InvalidInput("write_cloud: too many extra bytes for LAS");
      put(text, header.extra_vlr + 20, static_cast<std::uint16_t>(length + descriptors.size()));
      text.insert(header.extra_vlr + kVlrHeader + length, descriptors);
    } else {
      text.insert(header.header_size, vlr_header(descriptors.size()) + descriptors);
      put(text, kVlrCount, header.vlr_count + 1);
    }
  }
  put(text, kPointsAt, static_cast<std::uint32_t>(text.size()));
  put(text, kRecordBytes, static_cast<std::uint16_t>(record_bytes));
  // What follows the points moves by as much as header and points have grown.
  const std::uint64_t grown = (text.size() - header.points_at) + header.count * (record_bytes - header.record_bytes);
  const auto shift = [&](std::size_t at) {
    const auto position = load<std::uint64_t>(text.data() + at);
    if (position >= header.points_at) put(text, at, position + grown);
  };
  if (header.minor >= 3 && header.header_size >= kWaveform + 8) shift(kWaveform);
  if (header.minor == 4) shift(kEvlrAt);
  return text;
}

void write_from_las(const PointData& data, LasOutput& out) {
  const Source source{data.table->raw, "write_cloud"};
  const LasHeader header = read_las_header(source);
  std::size_t record_bytes = header.record_bytes;
  std::string descriptors;
  const std::vector<Added> added = place_added(data, header, record_bytes, descriptors);
  out.header(extended_header(source.bytes, header, record_bytes, descriptors));
  const char* from = source.bytes.data() + header.points_at;
  std::string record;
  for (std::size_t i = 0; i < data.size(); ++i, from += header.record_bytes) {
    record.assign(from, header.record_bytes);
    record.resize(record_bytes);
    store_position(data, i, header.scale, header.offset, record.data());
    for (const Added& a : added) store_double(a.type, added_value(data, a, i), record.data() + a.offset);
    out.record(record);
  }
  out.finish(source.bytes.substr(header.points_at + data.size() * header.record_bytes));
}

// Steps of a power of ten, so small that the extent takes about 30 bits; the offset is a whole number of them.
void choose_scale(const PointData& data, std::size_t a, double& scale, double& offset, double& low, double& high) {
  low = std::numeric_limits<double>::infinity();
  high = -low;
  for (const Vec3& p : data.cloud.positions) {
    if (!std::isfinite(p[a])) throw InvalidInput("write_cloud: LAS cannot hold coordinates that are not finite");
    low = std::min(low, p[a]);
    high = std::max(high, p[a]);
  }
  if (data.size() == 0) low = high = 0;
  constexpr double kSteps = 2e9;
  const double extent = std::max(high - low, 1e-6 * std::max(std::abs(low), std::abs(high)));
  scale = extent > 0 && std::isfinite(extent) ? std::pow(10.0, std::ceil(std::log10(extent / kSteps))) : 1e-9;
  if (!(scale > 0)) scale = std::numeric_limits<double>::min();
  offset = std::floor((low / 2 + high / 2) / (scale * 1e6)) * (scale * 1e6);
  if (!std::isfinite(offset)) offset = low / 2 + high / 2;
}

std::string new_header(const PointData& data, bool colored, const std::string& descriptors, std::size_t record_bytes, Vec3& scale,
                       Vec3& offset) {
  constexpr std::size_t kSize = 375;
  std::string text(kSize, '\0');
  text.replace(0, 4, "LASF");
  text[24] = 1;
  text[kMinor] = 4;
  text.replace(26, 5, "OTHER");
  text.replace(58, 3, "g3r");
  put(text, kHeaderSize, static_cast<std::uint16_t>(kSize));
  text[kPointFormat] = colored ? 2 : 0;
  put(text, kRecordBytes, static_cast<std::uint16_t>(record_bytes));
  put(text, kLegacyCount, static_cast<std::uint32_t>(data.size()));
  put(text, kLegacyCount + 4, static_cast<std::uint32_t>(data.size()));  // all are first returns
  put(text, kCount, std::uint64_t{data.size()});
  put(text, kCount + 8, std::uint64_t{data.size()});
  for (std::size_t a = 0; a < 3; ++a) {
    double low = 0;
    double high = 0;
    choose_scale(data, a, scale[a], offset[a], low, high);
    put(text, kScale + 8 * a, scale[a]);
    put(text, kOffset + 8 * a, offset[a]);
    put(text, kBounds + 16 * a, high);
    put(text, kBounds + 16 * a + 8, low);
  }
  if (!descriptors.empty()) {
    put(text, kVlrCount, std::uint32_t{1});
    text += vlr_header(descriptors.size()) + descriptors;
  }
  put(text, kPointsAt, static_cast<std::uint32_t>(text.size()));
  return text;
}

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

// Names for extra bytes that are neither those of fields nor twice the same, where needed with a number at the end.
std::vector<std::string> extra_names(const std::vector<Column>& columns) {
  std::set<std::string> taken(std::begin(kFieldNames), std::end(kFieldNames));
  std::vector<std::string> names;
  for (const Column& column : columns) {
    std::string name = column.property.name.substr(0, kNameBytes);
    for (int number = 2; !taken.insert(lower(name)).second; ++number) {
      const std::string digits = std::to_string(number);
      name = column.property.name.substr(0, kNameBytes - 1 - digits.size());
      (name += '_') += digits;
    }
    names.push_back(name);
  }
  return names;
}

void write_new(const PointData& data, LasOutput& out) {
  if (data.size() > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput("write_cloud: more than 2^32 - 1 points do not fit in LAS point format 0");
  std::vector<Column> columns = plan_columns(data, Attributes::Dialect::kLas, false);
  const bool colored = !data.cloud.colors.empty();
  std::erase_if(columns, [&](const Column& column) {
    return column.from == Column::From::kPosition || column.from == Column::From::kColor || column.property.count != 1;
  });
  std::size_t record_bytes = kRecordSize[colored ? 2 : 0];
  std::string descriptors;
  const std::vector<std::string> names = extra_names(columns);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Type type = columns[c].property.type;
    descriptors += descriptor(names[c], las_type_number(type), 0);
    record_bytes += size_of(type);
  }
  if (descriptors.size() > std::numeric_limits<std::uint16_t>::max())
    throw InvalidInput("write_cloud: LAS holds at most 341 extra properties");
  Vec3 scale{};
  Vec3 offset{};
  out.header(new_header(data, colored, descriptors, record_bytes, scale, offset));
  Rows rows(data, columns);
  std::string record;
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < data.size(); ++i) {
    rows.next();
    record.assign(kRecordSize[colored ? 2 : 0], '\0');
    for (std::size_t a = 0; a < 3; ++a) put(record, 4 * a, quantise(data.cloud.positions[i][a], scale[a], offset[a], kAxes[a]));
    record[14] = 9;  // return 1 of 1
    if (colored) {
      for (std::size_t c = 0; c < 3; ++c) put(record, 20 + 2 * c, static_cast<std::uint16_t>(data.cloud.colors[i][c] * 257));
    }
    for (std::size_t c = 0; c < columns.size(); ++c) rows.append_bytes(c, record);
    out.record(record);
  }
  out.finish({});
}

class PlainLas : public LasOutput {
 public:
  explicit PlainLas(OutputFile& file) : file_(file) {}
  void header(const std::string& text) override { file_.write(text); }
  void record(const std::string& bytes) override { file_.write(bytes); }
  void finish(std::string_view rest) override { file_.write(rest); }

 private:
  OutputFile& file_;
};

}  // namespace

std::unique_ptr<LasOutput> plain_las(OutputFile& file) { return std::make_unique<PlainLas>(file); }

void write_las(const PointData& data, LasOutput& out) {
  const bool from_las = data.table != nullptr && data.table->dialect == Attributes::Dialect::kLas;
  from_las ? write_from_las(data, out) : write_new(data, out);
}

}  // namespace g3r::io
