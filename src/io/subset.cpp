#include "io/subset.h"

#include "io/las.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace g3r::io {

namespace {

using namespace las;

using Kept = std::vector<char>;  // one per point: whether it is kept

constexpr std::size_t kReturns = kCount + 8;  // LAS 1.4: points by return, 15 of 64 bits; before, 5 of 32 after the count

template <class T>
void keep(std::vector<T>& values, const Kept& kept) {
  if (values.empty()) return;
  std::size_t end = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] != 0) values[end++] = values[i];
  }
  values.resize(end);
}

Element keep(const Element& points, const Kept& kept) {
  Element part;
  part.name = points.name;
  part.properties = points.properties;
  RecordLayout layout(points);
  const char* record = points.data.data();
  for (std::size_t i = 0; i < kept.size(); ++i, record += layout.size()) {
    layout.seek(record);
    if (kept[i] == 0) continue;
    part.data.append(record, layout.size());
    ++part.count;
  }
  return part;
}

// The LAS file of these points.
std::string keep_las(std::string_view las, const Kept& kept) {
  const std::size_t points_at = load<std::uint32_t>(las.data() + kPointsAt);
  const std::size_t record = load<std::uint16_t>(las.data() + kRecordBytes);
  const std::size_t end = points_at + kept.size() * record;
  std::string part(las.substr(0, points_at));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] != 0) part += las.substr(points_at + i * record, record);
  }
  const std::uint64_t moved = part.size() - end;  // modulo 2^64
  const auto shift = [&](std::size_t field) {
    const auto at = load<std::uint64_t>(part.data() + field);
    if (at >= end && end < las.size()) put(part, field, at + moved);
  };
  const auto minor = static_cast<unsigned char>(part[kMinor]);
  if (minor >= 3 && load<std::uint16_t>(part.data() + kHeaderSize) >= kWaveform + 8) shift(kWaveform);
  if (minor == 4) shift(kEvlrAt);
  fit_las_header(part, (part.size() - points_at) / record);
  return part += las.substr(end);
}

}  // namespace

void fit_las_header(std::string& las, std::uint64_t count) {
  const auto minor = static_cast<unsigned char>(las[kMinor]);
  const auto format = static_cast<unsigned char>(las[kPointFormat]);
  const std::size_t record_bytes = load<std::uint16_t>(las.data() + kRecordBytes);
  std::array<std::uint64_t, 16> returns{};
  std::array<std::int32_t, 3> low{};
  std::array<std::int32_t, 3> high{};
  const char* record = las.data() + load<std::uint32_t>(las.data() + kPointsAt);
  for (std::uint64_t i = 0; i < count; ++i, record += record_bytes) {
    ++returns[static_cast<unsigned char>(record[14]) & (format < 6 ? 7U : 15U)];
    for (std::size_t a = 0; a < 3; ++a) {
      const auto steps = load<std::int32_t>(record + 4 * a);
      low[a] = i == 0 ? steps : std::min(low[a], steps);
      high[a] = i == 0 ? steps : std::max(high[a], steps);
    }
  }
  const bool legacy = format < 6 && count <= std::numeric_limits<std::uint32_t>::max();
  put(las, kLegacyCount, static_cast<std::uint32_t>(legacy ? count : 0));
  for (std::size_t r = 0; r < 5; ++r) put(las, kLegacyCount + 4 + 4 * r, static_cast<std::uint32_t>(legacy ? returns[r + 1] : 0));
  if (minor == 4) {
    put(las, kCount, count);
    for (std::size_t r = 0; r < 15; ++r) put(las, kReturns + 8 * r, returns[r + 1]);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const auto scale = load<double>(las.data() + kScale + 8 * a);
    const auto offset = load<double>(las.data() + kOffset + 8 * a);
    put(las, kBounds + 16 * a, std::max(low[a] * scale, high[a] * scale) + offset);
    put(las, kBounds + 16 * a + 8, std::min(low[a] * scale, high[a] * scale) + offset);
  }
}

void keep_box(Cloud& cloud, const Box& box) {
  Kept kept(cloud.positions.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) inside = inside && p[a] >= box.low[a] && p[a] <= box.high[a];
    kept[i] = inside ? 1 : 0;
  }
  if (std::find(kept.begin(), kept.end(), 0) == kept.end()) return;
  keep(cloud.positions, kept);
  keep(cloud.normals, kept);
  keep(cloud.colors, kept);
  keep(cloud.confidence, kept);
  keep(cloud.scan_of_point, kept);
  if (cloud.attributes == nullptr) return;
  auto part = std::make_shared<Attributes>();
  part->dialect = cloud.attributes->dialect;
  part->comments = cloud.attributes->comments;
  if (part->dialect == Attributes::Dialect::kPcd) {  // no longer in rows and columns
    std::erase_if(part->comments, [](const std::string& line) { return line.starts_with("WIDTH") || line.starts_with("HEIGHT"); });
  }
  part->elements.push_back(keep(cloud.attributes->points(), kept));
  if (!cloud.attributes->raw.empty()) part->raw = keep_las(cloud.attributes->raw, kept);
  cloud.attributes = std::move(part);
}

}  // namespace g3r::io
