#include "io/e57_points.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace g3r::io {

namespace {

// What unpacks to more than this many times the size of its file is refused: half a byte for a point's three doubles. Scans have at least
// 4 bytes for one. Larger: more memory for hostile files.
constexpr std::uint64_t kMostRatio = 64;
constexpr std::size_t kBlock = 4096;  // Records are unpacked so many at a time, which bounds the memory beside the cloud.

constexpr std::array<const char*, 9> kNames = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};  // of the table

}  // namespace

// Finds or adds the property of each of its fields. `words`: colours take 16 bits.
void E57Points::place_fields(E57Scan& scan, bool words) {
  Element& points = table_->elements.back();
  const auto add = [&](const std::string& name, Type type) {
    const std::size_t at = points.find(name);
    if (at == Element::npos) return points.add(name, type);
    if (points.properties[at].type != type) points.properties[at].type = Type::kFloat64;
    return at;
  };
  for (std::size_t i = 0; i < scan.fields.size(); ++i) {
    E57Field& field = scan.fields[i];
    const auto axis = [&](const std::array<std::size_t, 3>& triple) {
      return static_cast<std::size_t>(std::find(triple.begin(), triple.end(), i) - triple.begin());
    };
    if (axis(scan.position) < 3) {
      field.to = axis(scan.position);
    } else if (axis(scan.normal) < 3) {
      field.to = add(kNames[3 + axis(scan.normal)], field.type == Type::kFloat32 ? Type::kFloat32 : Type::kFloat64);
    } else if (axis(scan.color) < 3) {
      field.to = add(kNames[6 + axis(scan.color)], words ? Type::kUint16 : Type::kUint8);
    } else if (i != scan.invalid && !field.name.empty()) {
      std::string name = field.name;
      while (std::find(kNames.begin(), kNames.end(), name) != kNames.end()) name += "_2";
      field.to = add(name, field.type);
    }
  }
}

// The properties that the scans have together; a type that holds what is in any of them.
void E57Points::plan() {
  Element& points = table_->elements.back();
  for (const char* axis : {"x", "y", "z"}) points.add(axis, Type::kFloat64);
  const bool words =
      std::any_of(scans_.begin(), scans_.end(), [](const E57Scan& s) { return s.color[0] != Element::npos && s.brightest > 255; });
  for (E57Scan& scan : scans_) {
    place_fields(scan, words);
    declared_ += std::min(scan.count, kMostRatio * bytes_.size());
  }
  if (declared_ > kMostRatio * bytes_.size() / points.stride()) {
    place_.fail(std::to_string(declared_) + " points of " + std::to_string(points.stride()) + " bytes in a file of " +
                std::to_string(bytes_.size()) + " bytes, more than " + std::to_string(kMostRatio) +
                " times its size: a count is damaged, or the points are all alike; then convert the file");
  }
  for (const Property& property : points.properties) offsets_.push_back(std::exchange(stride_, stride_ + size_of(property.type)));
}

void E57Points::open(e57::ImageFile file) {
  scans_ = find_e57_scans(bytes_, file.root(), place_);
  plan();
  file_.emplace(std::move(file));
}

std::vector<Vec3> E57Points::sensors() const {
  std::vector<Vec3> places;
  if (std::all_of(scans_.begin(), scans_.end(), [](const E57Scan& scan) { return scan.pose.is_identity() && !scan.spherical; }))
    return places;
  for (const E57Scan& scan : scans_) places.push_back(scan.pose.shift);
  return places;
}

std::uint64_t E57Points::count() {
  std::uint64_t valid = 0;
  for (const E57Scan& scan : scans_) {
    if (scan.invalid == Element::npos) {
      valid += scan.count;
      continue;
    }
    place_.scan = scan.number;
    std::vector<double> marks(kBlock);
    std::vector<e57::SourceDestBuffer> buffers;
    buffers.emplace_back(*file_, scan.fields[scan.invalid].name, marks.data(), marks.size(), true, true);
    e57::CompressedVectorReader reader = e57::CompressedVectorNode(scan.points).reader(buffers);
    while (const std::size_t read = reader.read()) {
      valid += static_cast<std::uint64_t>(std::count(marks.begin(), marks.begin() + static_cast<std::ptrdiff_t>(read), 0.0));
    }
    reader.close();
    place_.scan = 0;
  }
  return valid;
}

void E57Points::begin_scan(E57Scan& scan) {
  const auto block = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, scan.count));
  numbers_.clear();
  numbers_.reserve(scan.fields.size());
  std::vector<e57::SourceDestBuffer> buffers;
  for (std::size_t i = 0; i < scan.fields.size(); ++i) {
    E57Field& field = scan.fields[i];
    if (field.to == Element::npos && i != scan.invalid) continue;
    field.block = numbers_.size();
    numbers_.emplace_back(block);
    buffers.emplace_back(*file_, field.name, numbers_.back().data(), block, true, true);
  }
  reader_.emplace(e57::CompressedVectorNode(scan.points).reader(buffers));
  done_ = 0;
}

void E57Points::end_scan(const E57Scan& scan) {
  if (done_ != scan.count) {
    place_.fail("truncated: " + std::to_string(scan.count) + " points declared, but only " + std::to_string(done_) + " could be unpacked");
  }
  reader_->close();
  reader_.reset();
}

void E57Points::append_point(const E57Scan& scan, std::size_t i, Element& points) {
  const auto value = [&](std::size_t field) { return numbers_[scan.fields[field].block][i]; };
  if (scan.invalid != Element::npos && value(scan.invalid) != 0) {
    ++dropped_;
    return;
  }
  const auto triple = [&](const std::array<std::size_t, 3>& fields) { return Vec3{value(fields[0]), value(fields[1]), value(fields[2])}; };
  Vec3 p = triple(scan.position);
  if (scan.spherical) {
    const double flat = p[0] * std::cos(p[2]);
    p = {flat * std::cos(p[1]), flat * std::sin(p[1]), p[0] * std::sin(p[2])};
  }
  p = scan.pose.rotate(p);
  for (std::size_t a = 0; a < 3; ++a) p[a] += scan.pose.shift[a];
  Vec3 n{};
  if (scan.normal[0] != Element::npos) n = scan.pose.rotate(triple(scan.normal));

  points.data.resize(points.data.size() + stride_);
  char* const record = points.data.data() + points.data.size() - stride_;
  const auto put = [&](std::size_t property, double number) {
    store_double(points.properties[property].type, number, record + offsets_[property]);
  };
  for (std::size_t f = 0; f < scan.fields.size(); ++f) {
    const E57Field& field = scan.fields[f];
    if (field.to != Element::npos && field.to >= 3) put(field.to, value(f));
  }
  for (std::size_t a = 0; a < 3; ++a) {
    put(a, p[a]);
    if (scan.normal[0] != Element::npos) put(scan.fields[scan.normal[a]].to, n[a]);
    if (scan.color[0] == Element::npos) continue;
    const std::size_t to = scan.fields[scan.color[a]].to;
    const double full = points.properties[to].type == Type::kUint16 ? 65535 : 255;
    put(to, value(scan.color[a]) / scan.brightest * full);
  }
  ++points.count;
}

bool E57Points::next(Element& points) {
  for (; at_ < scans_.size(); ++at_) {
    const E57Scan& scan = scans_[at_];
    place_.scan = scan.number;
    if (!reader_) begin_scan(scans_[at_]);
    const std::size_t read = reader_->read();
    for (std::size_t i = 0; i < read; ++i) append_point(scan, i, points);
    done_ += read;
    if (read != 0) return true;
    end_scan(scan);
  }
  place_.scan = 0;
  return false;
}

}  // namespace g3r::io
