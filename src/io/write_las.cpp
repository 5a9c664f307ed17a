// LAS out, or LAZ, of clouds read from LAS: header, variable length records and every byte of every record stay; normals and confidence are
// added as extra bytes (NormalX, NormalY, NormalZ, confidence), or replace those that are floats; what else has such a name gets another.
// Other clouds: write_las_new.cpp.
#include "io/las_extra_bytes.h"
#include "io/las_output.h"
#include "io/las_plan.h"
#include "io/writers.h"

#include <algorithm>
#include <limits>
#include <set>

namespace g3r::io {

namespace {

using namespace las;

constexpr const char* kNormalNames[] = {"NormalX", "NormalY", "NormalZ"};

// A number appended to every record, or stored over a field that the record has.
struct Added {
  Type type;
  std::size_t offset;
  std::size_t axis;  // 0..2: normal; 3: confidence
};

double added_value(const PointData& data, const Added& added, std::size_t i) {
  return added.axis < 3 ? (*data.normals)[i][added.axis] : static_cast<double>((*data.confidence)[i]);
}

void store_position(const PointData& data, std::size_t i, const LasHeader& header, char* record) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    const double value = data.cloud.positions[i][a];
    if (header.steps[a].value(load<std::int32_t>(record + 4 * a)) == value) continue;  // as it was in the file, to the bit
    const std::int32_t steps = las_steps(value, header.steps[a], kAxes[a]);
    std::memcpy(record + 4 * a, &steps, sizeof steps);
  }
}

// Chooses where normals and confidence go in records of `header`; descriptors of new ones are appended to `descriptors`.
std::vector<Added> place_added(bool normals, bool confidence, const LasHeader& header, std::size_t& record_bytes,
                               std::string& descriptors) {
  std::vector<Added> added;
  const auto place = [&](const char* name, std::size_t axis) {
    for (const LasField& field : header.fields) {
      if (field.name == name && is_float(field.type) && !field.is_scaled()) {
        added.push_back({field.type, field.offset, axis});
        return;
      }
    }
    if (added.empty() || record_bytes == header.record_bytes) {
      for (std::size_t left = header.undescribed_bytes; left > 0; left -= std::min<std::size_t>(left, 255)) {
        descriptors += las_descriptor("undescribed", 0, std::min<std::size_t>(left, 255));
      }
    }
    descriptors += las_descriptor(name, las_type_number(Type::kFloat32), 0);
    added.push_back({Type::kFloat32, record_bytes, axis});
    record_bytes += size_of(Type::kFloat32);
  };
  if (normals) {
    for (std::size_t a = 0; a < 3; ++a) place(kNormalNames[a], a);
  }
  if (confidence) place("confidence", 3);
  if (record_bytes > std::numeric_limits<std::uint16_t>::max()) throw InvalidInput("write_cloud: LAS records cannot hold more extra bytes");
  return added;
}

// Renames the extra bytes in `described` that have a name of those in `descriptors`: readers stumble over two.
void rename_twins(std::string& described, const std::string& descriptors) {
  const auto name_of = [](const std::string& record, std::size_t at) {
    return las_text(std::string_view(record).substr(at + kLasNameAt, kLasNameBytes));
  };
  const auto names = [&](const std::string& record) {
    std::set<std::string> all;
    for (std::size_t at = 0; at + kDescriptor <= record.size(); at += kDescriptor) all.insert(name_of(record, at));
    return all;
  };
  const std::set<std::string> added = names(descriptors);
  std::set<std::string> taken = names(described);
  taken.insert(added.begin(), added.end());
  for (std::size_t at = 0; at + kDescriptor <= described.size(); at += kDescriptor) {
    const std::string name = name_of(described, at);
    if (described[at + 2] == 0 || added.count(name) == 0) continue;
    std::string free = name;
    for (int number = 2; !taken.insert(free).second; ++number) free = name + "_" + std::to_string(number);
    described.replace(at + kLasNameAt, free.size(), free);
  }
}

// The header and variable length records of the source with room for the descriptors.
std::string extended_header(std::string_view raw, const LasHeader& header, std::size_t record_bytes, const std::string& descriptors) {
  std::string text(raw.substr(0, header.points_at));
  if (!descriptors.empty()) {
    if (header.extra_vlr != 0) {
      const std::size_t length = load<std::uint16_t>(text.data() + header.extra_vlr + 20);
      if (length + descriptors.size() > std::numeric_limits<std::uint16_t>::max())
        throw InvalidInput("write_cloud: too many extra bytes for LAS");
      std::string described = text.substr(header.extra_vlr + kVlrHeader, length);
      rename_twins(described, descriptors);
      put(text, header.extra_vlr + 20, static_cast<std::uint16_t>(length + descriptors.size()));
      text.replace(header.extra_vlr + kVlrHeader, length, described + descriptors);
    } else {
      text.insert(header.header_size, las_extra_vlr(descriptors.size()) + descriptors);
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

class FromLas : public LasWriter {
 public:
  FromLas(const Source& head, bool normals, bool confidence, LasOutput& out)
      : header_(read_las_header(head, std::numeric_limits<std::uint64_t>::max())), record_bytes_(header_.record_bytes), out_(out) {
    std::string descriptors;
    added_ = place_added(normals, confidence, header_, record_bytes_, descriptors);
    out_.header(extended_header(head.bytes, header_, record_bytes_, descriptors));
  }

  void write(const PointData& data, const char* stored) override {
    for (std::size_t i = 0; i < data.size(); ++i, stored += header_.record_bytes) {
      record_.assign(stored, header_.record_bytes);
      record_.resize(record_bytes_);
      store_position(data, i, header_, record_.data());
      for (const Added& a : added_) store_double(a.type, added_value(data, a, i), record_.data() + a.offset);
      out_.record(record_);
    }
  }

 private:
  LasHeader header_;
  std::size_t record_bytes_;
  std::vector<Added> added_;
  LasOutput& out_;
  std::string record_;
};

void write_from_las(const PointData& data, LasOutput& out) {
  const Source source{data.table->raw, "write_cloud"};
  const LasHeader header = read_las_header(source);
  las_from_las(source, data.normals != nullptr, data.confidence != nullptr, out)->write(data, source.bytes.data() + header.points_at);
  const std::string_view rest = source.bytes.substr(header.points_at + data.size() * header.record_bytes);
  out.finish(rest.size());
  out.rest(rest);
}

class PlainLas : public LasOutput {
 public:
  explicit PlainLas(OutputFile& file) : file_(file) {}
  void header(const std::string& text) override { file_.write(text); }
  void record(const std::string& bytes) override { file_.write(bytes); }
  void finish(std::uint64_t /*rest*/) override {}
  void rest(std::string_view bytes) override { file_.write(bytes); }

 private:
  OutputFile& file_;
};

}  // namespace

std::unique_ptr<LasOutput> plain_las(OutputFile& file) { return std::make_unique<PlainLas>(file); }

std::unique_ptr<LasWriter> las_from_las(const Source& head, bool normals, bool confidence, LasOutput& out) {
  return std::make_unique<FromLas>(head, normals, confidence, out);
}

void write_las(const PointData& data, LasOutput& out) {
  if (data.table != nullptr && data.table->dialect == Attributes::Dialect::kLas) return write_from_las(data, out);
  LasPlan plan(data);
  plan.add(data);
  plan.finish();
  new_las(plan, out)->write(data, nullptr);
  out.finish(0);
  if (data.options.warnings != nullptr)
    data.options.warnings->insert(data.options.warnings->end(), plan.warnings().begin(), plan.warnings().end());
}

}  // namespace g3r::io
