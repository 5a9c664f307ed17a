// LAS of clouds that come from other formats: LAS 1.4, point format 0 or 2, all other properties as extra bytes.
#include "io/las.h"
#include "io/las_output.h"
#include "io/rows.h"
#include "io/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace g3r::io {

namespace {

using namespace las;

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

// Steps of a power of ten, so small that the extent takes about 30 bits; the offset is a whole number of them.
void choose_scale(double low, double high, double& scale, double& offset) {
  constexpr double kSteps = 2e9;  // The extent has so many steps at most: the numbers of LAS have 32 bits, half of them negative.
  const double extent = std::max(high - low, 1e-6 * std::max(std::abs(low), std::abs(high)));
  scale = extent > 0 && std::isfinite(extent) ? std::pow(10.0, std::ceil(std::log10(extent / kSteps))) : 1e-9;
  if (!(scale > 0)) scale = std::numeric_limits<double>::min();
  offset = std::floor((low / 2 + high / 2) / (scale * 1e6)) * (scale * 1e6);
  if (!std::isfinite(offset)) offset = low / 2 + high / 2;
}

std::string new_header(std::uint64_t count, const Box& bounds, bool colored, const std::string& descriptors, std::size_t record_bytes,
                       Vec3& scale, Vec3& offset) {
  constexpr std::size_t kSize = 375;  // Bytes of the header of LAS 1.4.
  std::string text(kSize, '\0');
  text.replace(0, 4, "LASF");
  text[24] = 1;
  text[kMinor] = 4;
  text.replace(26, 5, "OTHER");
  text.replace(58, 3, "g3r");
  put(text, kHeaderSize, static_cast<std::uint16_t>(kSize));
  text[kPointFormat] = colored ? 2 : 0;
  put(text, kRecordBytes, static_cast<std::uint16_t>(record_bytes));
  put(text, kLegacyCount, static_cast<std::uint32_t>(count));
  put(text, kLegacyCount + 4, static_cast<std::uint32_t>(count));  // all are first returns
  put(text, kCount, count);
  put(text, kCount + 8, count);
  for (std::size_t a = 0; a < 3; ++a) {
    choose_scale(bounds.low[a], bounds.high[a], scale[a], offset[a]);
    put(text, kScale + 8 * a, scale[a]);
    put(text, kOffset + 8 * a, offset[a]);
    put(text, kBounds + 16 * a, bounds.high[a]);
    put(text, kBounds + 16 * a + 8, bounds.low[a]);
  }
  if (!descriptors.empty()) {
    put(text, kVlrCount, std::uint32_t{1});
    text += las_extra_vlr(descriptors.size()) + descriptors;
  }
  put(text, kPointsAt, static_cast<std::uint32_t>(text.size()));
  return text;
}

// Names for extra bytes that are neither those of fields nor twice the same, where needed with a number at the end.
std::vector<std::string> extra_names(const std::vector<Column>& columns) {
  std::set<std::string> taken(std::begin(kFieldNames), std::end(kFieldNames));
  std::vector<std::string> names;
  for (const Column& column : columns) {
    std::string name = column.property.name.substr(0, kLasNameBytes);
    for (int number = 2; !taken.insert(lower_case(name)).second; ++number) {
      const std::string digits = std::to_string(number);
      name = column.property.name.substr(0, kLasNameBytes - 1 - digits.size());
      (name += '_') += digits;
    }
    names.push_back(name);
  }
  return names;
}

class NewLas : public LasWriter {
 public:
  NewLas(const PointData& like, std::uint64_t count, const Box& bounds, LasOutput& out)
      : columns_(plan_columns(like, Attributes::Dialect::kLas, false)), colored_(!like.cloud.colors.empty()), out_(out) {
    if (count > std::numeric_limits<std::uint32_t>::max())
      throw InvalidInput("write_cloud: more than 2^32 - 1 points do not fit in LAS point format 0");
    std::erase_if(columns_, [&](const Column& column) {
      return column.from == Column::From::kPosition || column.from == Column::From::kColor || column.property.count != 1;
    });
    std::size_t record_bytes = kRecordSize[colored_ ? 2 : 0];
    std::string descriptors;
    const std::vector<std::string> names = extra_names(columns_);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const Type type = columns_[c].property.type;
      descriptors += las_descriptor(names[c], las_type_number(type), 0);
      record_bytes += size_of(type);
    }
    if (descriptors.size() > std::numeric_limits<std::uint16_t>::max())
      throw InvalidInput("write_cloud: LAS holds at most 341 extra properties");
    out_.header(new_header(count, bounds, colored_, descriptors, record_bytes, scale_, offset_));
  }

  void write(const PointData& data, const char* /*stored*/) override {
    constexpr const char* kAxes[] = {"x", "y", "z"};
    Rows rows(data, columns_);
    for (std::size_t i = 0; i < data.size(); ++i) {
      rows.next();
      record_.assign(kRecordSize[colored_ ? 2 : 0], '\0');
      for (std::size_t a = 0; a < 3; ++a) put(record_, 4 * a, las_steps(data.cloud.positions[i][a], scale_[a], offset_[a], kAxes[a]));
      record_[14] = 9;  // return 1 of 1
      if (colored_) {
        for (std::size_t c = 0; c < 3; ++c) put(record_, 20 + 2 * c, static_cast<std::uint16_t>(data.cloud.colors[i][c] * 257));
      }
      for (std::size_t c = 0; c < columns_.size(); ++c) rows.append_bytes(c, record_);
      out_.record(record_);
    }
  }

 private:
  std::vector<Column> columns_;
  bool colored_;
  LasOutput& out_;
  Vec3 scale_{};
  Vec3 offset_{};
  std::string record_;
};

}  // namespace

std::unique_ptr<LasWriter> new_las(const PointData& like, std::uint64_t count, const Box& bounds, LasOutput& out) {
  return std::make_unique<NewLas>(like, count, bounds, out);
}

}  // namespace g3r::io
