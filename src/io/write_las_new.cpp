// LAS of clouds that come from other formats: LAS 1.4, the point format that holds the fields which the points have, all other properties
// as extra bytes.
#include "io/las_extra_bytes.h"
#include "io/las_output.h"
#include "io/las_plan.h"
#include "io/rows.h"

#include <limits>

namespace g3r::io {

namespace {

using namespace las;

std::string new_header(const LasPlan& plan, const std::string& descriptors, std::size_t record_bytes) {
  constexpr std::size_t kSize = 375;     // Bytes of the header of LAS 1.4.
  constexpr std::size_t kEncoding = 6;   // Byte offset of the global encoding.
  constexpr unsigned kAbsoluteTime = 1;  // GPS times are not seconds of the week.
  constexpr unsigned kWellKnown = 16;    // Coordinate systems are WKT: demanded of new point formats.
  std::string text(kSize, '\0');
  text.replace(0, 4, "LASF");
  text[24] = 1;
  text[kMinor] = 4;
  text.replace(26, 5, "OTHER");
  text.replace(58, 3, "g3r");
  put(text, kHeaderSize, static_cast<std::uint16_t>(kSize));
  text[kPointFormat] = static_cast<char>(plan.point_format());
  put(text, kRecordBytes, static_cast<std::uint16_t>(record_bytes));
  const bool is_old = plan.family() == LasFamily::kOld;
  const bool is_absolute = plan.has(LasPart::kGpsTime) && plan.absolute_time();
  put(text, kEncoding, static_cast<std::uint16_t>((is_absolute ? kAbsoluteTime : 0) + (is_old ? 0 : kWellKnown)));
  const std::array<std::uint64_t, 16> returns = plan.returns();
  if (is_old) put(text, kLegacyCount, static_cast<std::uint32_t>(plan.count()));
  put(text, kCount, plan.count());
  for (std::size_t r = 1; r < returns.size(); ++r) {
    if (is_old && r <= 5) put(text, kLegacyCount + 4 * r, static_cast<std::uint32_t>(returns[r]));
    put(text, kCount + 8 * r, returns[r]);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    put(text, kScale + 8 * a, plan.steps(a).scale());
    put(text, kOffset + 8 * a, plan.steps(a).offset());
    put(text, kBounds + 16 * a, plan.bounds().high[a]);
    put(text, kBounds + 16 * a + 8, plan.bounds().low[a]);
  }
  if (!descriptors.empty()) {
    put(text, kVlrCount, std::uint32_t{1});
    text += las_extra_vlr(descriptors.size()) + descriptors;
  }
  put(text, kPointsAt, static_cast<std::uint32_t>(text.size()));
  return text;
}

class NewLas : public LasWriter {
 public:
  NewLas(const LasPlan& plan, LasOutput& out) : plan_(plan), out_(out) {
    std::size_t record_bytes = kRecordSize[plan.point_format()];
    std::string descriptors;
    for (const LasPlan::Extra& extra : plan.extras()) {
      const Type type = plan.columns()[extra.column].property.type;
      descriptors += las_descriptor(extra.name, las_type_number(type), 0);
      record_bytes += size_of(type);
    }
    if (descriptors.size() > std::numeric_limits<std::uint16_t>::max())
      throw InvalidInput("write_cloud: LAS holds at most 341 extra properties");
    out_.header(new_header(plan, descriptors, record_bytes));
  }

  void write(const PointData& data, const char* /*stored*/) override {
    Rows rows(data, plan_.columns());
    for (std::size_t i = 0; i < data.size(); ++i) {
      rows.next();
      record_.assign(kRecordSize[plan_.point_format()], '\0');
      put_position(data.cloud.positions[i]);
      for (const LasPlan::Field& field : plan_.fields()) put_las_part(field.place, rows.number(field.column), record_);
      put_returns();
      if (plan_.colored()) put_color(data.cloud.colors[i], rows);
      for (const LasPlan::Extra& extra : plan_.extras()) rows.append_bytes(extra.column, record_);
      out_.record(record_);
    }
  }

 private:
  void put_position(const Vec3& position) {
    constexpr const char* kAxes[] = {"x", "y", "z"};
    for (std::size_t a = 0; a < 3; ++a) {
      put(record_, 4 * a, las_steps(position[a], plan_.steps(a), kAxes[a]));
    }
  }

  // Where the points do not say, it is return 1, and there are no more.
  void put_returns() {
    const LasPlace number = las_place(LasPart::kReturnNumber, plan_.family(), false);
    const LasPlace count = las_place(LasPart::kNumberOfReturns, plan_.family(), false);
    if (!plan_.has_return_numbers()) put_las_part(number, 1, record_);
    const int returned = record_[number.offset] & static_cast<int>(number.high);
    if (!plan_.has_counts_of_returns()) put_las_part(count, std::max(1, returned), record_);
  }

  void put_color(const std::array<std::uint8_t, 3>& color, Rows& rows) {
    constexpr unsigned kTo16Bits = 257;  // times 255 it is 65535: white stays white
    const std::size_t at = las_color_offset(plan_.point_format());
    const std::vector<std::size_t>& deep = plan_.deep_colors();
    for (std::size_t c = 0; c < 3; ++c) {
      put(record_, at + 2 * c, static_cast<std::uint16_t>(deep.empty() ? color[c] * kTo16Bits : rows.number(deep[c])));
    }
  }

  const LasPlan& plan_;
  LasOutput& out_;
  std::string record_;
};

}  // namespace

std::unique_ptr<LasWriter> new_las(const LasPlan& plan, LasOutput& out) { return std::make_unique<NewLas>(plan, out); }

}  // namespace g3r::io
