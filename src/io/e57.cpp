// libE57Format reads the XML and unpacks the points, scan by scan, in blocks. What it does not check is checked in e57_check.cpp before.
// Source: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange", and libE57Format.
#include "io/e57.h"

#include "io/cloud_from_table.h"
#include "io/fixed_records.h"
#include "io/readers.h"
#include "io/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#define E57_INTERNAL_IMPLEMENTATION_ENABLE 1  // for the place of a scan's binary section
#include <E57Format.h>

#include <CompressedVectorNodeImpl.h>

namespace g3r::io {

namespace {

// What unpacks to more than this many times the size of its file is refused: half a byte for a point's three doubles. Scans have at least
// 4 bytes for one. Larger: more memory for hostile files.
constexpr std::uint64_t kMostRatio = 64;
constexpr std::size_t kBlock = 4096;  // records unpacked at a time
constexpr std::size_t kNone = Element::npos;

// One number of a scan's records.
struct Field {
  std::string name;           // in the file
  Type type;                  // that holds all its values
  unsigned bits;              // in the file
  double most = 0;            // of integers
  std::size_t to = kNone;     // property of the table
  std::size_t block = kNone;  // its numbers, where they are unpacked
};

// From a scan's coordinates to those of the file: rotate by a unit quaternion, then shift.
struct Pose {
  std::array<double, 4> q{1, 0, 0, 0};
  Vec3 shift{0, 0, 0};

  [[nodiscard]] bool is_identity() const { return q == Pose().q && shift == Pose().shift; }

  // v + 2 w (u x v) + 2 u x (u x v), q = (w, u)
  [[nodiscard]] Vec3 rotate(const Vec3& v) const {
    if (q[1] == 0 && q[2] == 0 && q[3] == 0) return v;
    const auto cross = [&](const Vec3& a) { return Vec3{q[2] * a[2] - q[3] * a[1], q[3] * a[0] - q[1] * a[2], q[1] * a[1] - q[2] * a[0]}; };
    const Vec3 once = cross(v);
    const Vec3 twice = cross(once);
    return {v[0] + 2 * (q[0] * once[0] + twice[0]), v[1] + 2 * (q[0] * once[1] + twice[1]), v[2] + 2 * (q[0] * once[2] + twice[2])};
  }
};

struct Scan {
  std::size_t number;  // in the file, from 1
  e57::CompressedVectorNode points;
  std::uint64_t count;
  std::vector<Field> fields{};
  Pose pose{};
  bool spherical = false;
  std::array<std::size_t, 3> position{kNone, kNone, kNone};  // fields
  std::array<std::size_t, 3> normal{kNone, kNone, kNone};
  std::array<std::size_t, 3> color{kNone, kNone, kNone};
  std::size_t invalid = kNone;
  double brightest = 255;  // largest value of the colours
};

constexpr std::array<const char*, 3> kCartesian = {"cartesianX", "cartesianY", "cartesianZ"};
constexpr std::array<const char*, 3> kSpherical = {"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
constexpr std::array<const char*, 3> kNormal = {"nor:normalX", "nor:normalY", "nor:normalZ"};
constexpr std::array<const char*, 3> kColor = {"colorRed", "colorGreen", "colorBlue"};
constexpr std::array<const char*, 3> kColorMost = {"colorLimits/colorRedMaximum", "colorLimits/colorGreenMaximum",
                                                   "colorLimits/colorBlueMaximum"};
constexpr std::array<const char*, 9> kNames = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};  // of the table

std::optional<double> number(const e57::StructureNode& parent, const std::string& path) {
  if (!parent.isDefined(path)) return std::nullopt;
  const e57::Node node = parent.get(path);
  switch (node.type()) {
    case e57::TypeInteger:
      return static_cast<double>(e57::IntegerNode(node).value());
    case e57::TypeScaledInteger:
      return e57::ScaledIntegerNode(node).scaledValue();
    case e57::TypeFloat:
      return e57::FloatNode(node).value();
    default:
      return std::nullopt;
  }
}

Type integer_type(std::int64_t low, std::int64_t high) {
  if (low >= 0) return high <= 0xFF ? Type::kUint8 : high <= 0xFFFF ? Type::kUint16 : high <= 0xFFFFFFFF ? Type::kUint32 : Type::kFloat64;
  if (low >= INT8_MIN && high <= INT8_MAX) return Type::kInt8;
  if (low >= INT16_MIN && high <= INT16_MAX) return Type::kInt16;
  return low >= INT32_MIN && high <= INT32_MAX ? Type::kInt32 : Type::kFloat64;
}

// Text in fields is not kept: its type is that of no number.
std::optional<Field> make_field(const e57::Node& node) {
  const auto bits_between = [](std::int64_t low, std::int64_t high) {
    return static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low)));
  };
  switch (node.type()) {
    case e57::TypeInteger: {
      const e57::IntegerNode integer(node);
      const std::int64_t low = integer.minimum();
      const std::int64_t high = integer.maximum();
      return Field{node.elementName(), integer_type(low, high), bits_between(low, high), static_cast<double>(high)};
    }
    case e57::TypeScaledInteger: {
      const e57::ScaledIntegerNode integer(node);
      return Field{node.elementName(), Type::kFloat64, bits_between(integer.minimum(), integer.maximum())};
    }
    case e57::TypeFloat: {
      const bool single = e57::FloatNode(node).precision() == e57::PrecisionSingle;
      return Field{node.elementName(), single ? Type::kFloat32 : Type::kFloat64, single ? 32U : 64U};
    }
    case e57::TypeString:
      return Field{"", Type::kUint8, 8};  // at least its length
    default:
      return std::nullopt;
  }
}

// The points of all scans, one after the other.
class E57Points {
 public:
  explicit E57Points(FileBytes& bytes) : bytes_(bytes), source_(bytes.source()) {}

  // Finds scans and properties. `file` is that of the bytes, which check_e57() has checked.
  void open(e57::ImageFile file) {
    find_scans(file.root());
    plan();
    file_.emplace(std::move(file));
  }

  // Without data.
  [[nodiscard]] const Attributes& table() const { return *table_; }
  // With those that are marked as invalid.
  [[nodiscard]] std::uint64_t declared() const { return declared_; }
  [[nodiscard]] std::size_t scans() const { return scans_.size(); }
  // Of the points that next() has given.
  [[nodiscard]] std::size_t scan() const { return at_; }
  // Points marked as invalid, so far.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  // A scanner stands at the origin of its scan. Where no scan has a pose the points may have been joined and moved before.
  [[nodiscard]] std::vector<Vec3> sensors() const {
    std::vector<Vec3> places;
    if (std::all_of(scans_.begin(), scans_.end(), [](const Scan& scan) { return scan.pose.is_identity() && !scan.spherical; }))
      return places;
    for (const Scan& scan : scans_) places.push_back(scan.pose.shift);
    return places;
  }

  // How many points are not marked as invalid; unpacks the marks.
  [[nodiscard]] std::uint64_t count() {
    std::uint64_t valid = 0;
    for (const Scan& scan : scans_) {
      if (scan.invalid == kNone) {
        valid += scan.count;
        continue;
      }
      scan_ = scan.number;
      std::vector<double> marks(kBlock);
      std::vector<e57::SourceDestBuffer> buffers;
      buffers.emplace_back(*file_, scan.fields[scan.invalid].name, marks.data(), marks.size(), true, true);
      e57::CompressedVectorReader reader = e57::CompressedVectorNode(scan.points).reader(buffers);
      while (const std::size_t read = reader.read()) {
        valid += static_cast<std::uint64_t>(std::count(marks.begin(), marks.begin() + static_cast<std::ptrdiff_t>(read), 0.0));
      }
      reader.close();
      scan_ = 0;
    }
    return valid;
  }

  // Appends the records of the next block, which may all be marked as invalid; false at the end.
  bool next(Element& points) {
    for (; at_ < scans_.size(); ++at_) {
      const Scan& scan = scans_[at_];
      scan_ = scan.number;
      if (!reader_) begin_scan(scans_[at_]);
      const std::size_t read = reader_->read();
      for (std::size_t i = 0; i < read; ++i) append_point(scan, i, points);
      done_ += read;
      if (read != 0) return true;
      end_scan(scan);
    }
    scan_ = 0;
    return false;
  }

  /// Where the reader is, for errors of the library.
  [[nodiscard]] std::string place() const { return scan_ == 0 ? "" : "scan " + std::to_string(scan_) + ": "; }

 private:
  void find_scans(const e57::StructureNode& root) {
    if (!root.isDefined("data3D") || root.get("data3D").type() != e57::TypeVector) fail(source_, "no scans: expected a vector data3D");
    const e57::VectorNode list(root.get("data3D"));
    for (std::int64_t i = 0; i < list.childCount(); ++i) {
      scan_ = static_cast<std::size_t>(i) + 1;
      const e57::Node node = list.get(i);
      if (node.type() != e57::TypeStructure) fail_here("expected a structure");
      const e57::StructureNode structure(node);
      if (!structure.isDefined("points") || structure.get("points").type() != e57::TypeCompressedVector) fail_here("it has no points");
      const e57::CompressedVectorNode points(structure.get("points"));
      if (points.childCount() < 0) fail_here("its number of points is negative");
      if (points.childCount() == 0) continue;
      Scan scan{scan_, points, static_cast<std::uint64_t>(points.childCount())};
      find_fields(scan);
      find_colors(structure, scan);
      scan.pose = find_pose(structure);
      scans_.push_back(std::move(scan));
    }
    scan_ = 0;
    if (scans_.empty()) fail(source_, "no points: no scan has any");
  }

  void find_fields(Scan& scan) {
    if (scan.points.prototype().type() != e57::TypeStructure) fail_here("its prototype is no structure");
    const e57::StructureNode prototype(scan.points.prototype());
    for (std::int64_t i = 0; i < prototype.childCount(); ++i) {
      const std::optional<Field> field = make_field(prototype.get(i));
      if (!field) fail_here("field " + quote(prototype.get(i).elementName()) + " is neither a number nor text; convert the file");
      scan.fields.push_back(*field);
    }
    const auto find = [&](const char* name) {
      const auto found = std::find_if(scan.fields.begin(), scan.fields.end(), [&](const Field& f) { return f.name == name; });
      return found == scan.fields.end() ? kNone : static_cast<std::size_t>(found - scan.fields.begin());
    };
    const auto find_all = [&](const std::array<const char*, 3>& names, std::array<std::size_t, 3>& found) {
      for (std::size_t a = 0; a < 3; ++a) found[a] = find(names[a]);
      if (std::find(found.begin(), found.end(), kNone) == found.end()) return true;
      found.fill(kNone);
      return false;
    };
    scan.spherical = !find_all(kCartesian, scan.position);
    if (scan.spherical && !find_all(kSpherical, scan.position)) {
      fail_here("expected the fields cartesianX, cartesianY, cartesianZ or sphericalRange, sphericalAzimuth, sphericalElevation");
    }
    find_all(kNormal, scan.normal);
    find_all(kColor, scan.color);
    scan.invalid = find(scan.spherical ? "sphericalInvalidState" : "cartesianInvalidState");
    check_count(scan);
  }

  // The library unpacks a field without bits from nothing, as often as the file says.
  void check_count(const Scan& scan) const {
    const std::vector<std::uint64_t> bytes =
        check_e57_packets(bytes_, scan.points.impl()->getBinarySectionLogicalStart(), scan.fields.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (scan.fields[i].bits != 0 && scan.count > 8 * bytes[i] / scan.fields[i].bits) {
        fail_here("truncated or damaged: " + std::to_string(scan.count) + " points declared, but field " + std::to_string(i + 1) +
                  " has bytes for " + std::to_string(8 * bytes[i] / scan.fields[i].bits));
      }
    }
  }

  static void find_colors(const e57::StructureNode& structure, Scan& scan) {
    if (scan.color[0] == kNone) return;
    constexpr double kMost = 65535;
    scan.brightest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double in_field = scan.fields[scan.color[c]].most;
      const double in_scan = number(structure, kColorMost[c]).value_or(in_field);
      scan.brightest = std::max(scan.brightest, in_field > 0 && in_field <= kMost ? in_field : in_scan);
    }
    if (!(scan.brightest > 0)) scan.brightest = 1;
    scan.brightest = std::min(scan.brightest, kMost);
  }

  Pose find_pose(const e57::StructureNode& structure) const {
    Pose pose;
    double length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      pose.q[i] = number(structure, std::string("pose/rotation/") + "wxyz"[i]).value_or(pose.q[i]);
      length += pose.q[i] * pose.q[i];
    }
    if (!(length > 0.5 && length < 2)) fail_here("the rotation of its pose is no unit quaternion");
    for (double& q : pose.q) q /= std::sqrt(length);
    for (std::size_t a = 0; a < 3; ++a) {
      pose.shift[a] = number(structure, std::string("pose/translation/") + "xyz"[a]).value_or(0);
      if (!std::isfinite(pose.shift[a])) fail_here("the translation of its pose is not finite");
    }
    return pose;
  }

  // The properties that the scans have together; a type that holds what is in any of them.
  void plan() {
    Element& points = table_->elements.back();
    const auto add = [&](const std::string& name, Type type) {
      std::size_t at = points.find(name);
      if (at == kNone) {
        at = points.properties.size();
        points.properties.emplace_back();
        points.properties.back().name = name;
        points.properties.back().type = type;
      } else if (points.properties[at].type != type) {
        points.properties[at].type = Type::kFloat64;
      }
      return at;
    };
    for (const char* axis : {"x", "y", "z"}) add(axis, Type::kFloat64);
    const bool words = std::any_of(scans_.begin(), scans_.end(), [](const Scan& s) { return s.color[0] != kNone && s.brightest > 255; });
    for (Scan& scan : scans_) {
      for (std::size_t i = 0; i < scan.fields.size(); ++i) {
        Field& field = scan.fields[i];
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
      declared_ += std::min(scan.count, kMostRatio * bytes_.size());
    }
    if (declared_ > kMostRatio * bytes_.size() / points.stride()) {
      fail(source_, std::to_string(declared_) + " points of " + std::to_string(points.stride()) + " bytes in a file of " +
                        std::to_string(bytes_.size()) + " bytes, more than " + std::to_string(kMostRatio) +
                        " times its size: a count is damaged, or the points are all alike; then convert the file");
    }
    for (const Property& property : points.properties) offsets_.push_back(std::exchange(stride_, stride_ + size_of(property.type)));
  }

  void begin_scan(Scan& scan) {
    const auto block = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, scan.count));
    numbers_.clear();
    numbers_.reserve(scan.fields.size());
    std::vector<e57::SourceDestBuffer> buffers;
    for (std::size_t i = 0; i < scan.fields.size(); ++i) {
      Field& field = scan.fields[i];
      if (field.to == kNone && i != scan.invalid) continue;
      field.block = numbers_.size();
      numbers_.emplace_back(block);
      buffers.emplace_back(*file_, field.name, numbers_.back().data(), block, true, true);
    }
    reader_.emplace(e57::CompressedVectorNode(scan.points).reader(buffers));
    done_ = 0;
  }

  void end_scan(const Scan& scan) {
    if (done_ != scan.count) {
      fail_here("truncated: " + std::to_string(scan.count) + " points declared, but only " + std::to_string(done_) + " could be unpacked");
    }
    reader_->close();
    reader_.reset();
  }

  void append_point(const Scan& scan, std::size_t i, Element& points) {
    const auto value = [&](std::size_t field) { return numbers_[scan.fields[field].block][i]; };
    if (scan.invalid != kNone && value(scan.invalid) != 0) {
      ++dropped_;
      return;
    }
    const auto triple = [&](const std::array<std::size_t, 3>& fields) {
      return Vec3{value(fields[0]), value(fields[1]), value(fields[2])};
    };
    Vec3 p = triple(scan.position);
    if (scan.spherical) {
      const double flat = p[0] * std::cos(p[2]);
      p = {flat * std::cos(p[1]), flat * std::sin(p[1]), p[0] * std::sin(p[2])};
    }
    p = scan.pose.rotate(p);
    for (std::size_t a = 0; a < 3; ++a) p[a] += scan.pose.shift[a];
    Vec3 n{};
    if (scan.normal[0] != kNone) n = scan.pose.rotate(triple(scan.normal));

    points.data.resize(points.data.size() + stride_);
    char* const record = points.data.data() + points.data.size() - stride_;
    const auto put = [&](std::size_t property, double number) {
      store_double(points.properties[property].type, number, record + offsets_[property]);
    };
    for (std::size_t f = 0; f < scan.fields.size(); ++f) {
      const Field& field = scan.fields[f];
      if (field.to != kNone && field.to >= 3) put(field.to, value(f));
    }
    for (std::size_t a = 0; a < 3; ++a) {
      put(a, p[a]);
      if (scan.normal[0] != kNone) put(scan.fields[scan.normal[a]].to, n[a]);
      if (scan.color[0] == kNone) continue;
      const std::size_t to = scan.fields[scan.color[a]].to;
      const double full = points.properties[to].type == Type::kUint16 ? 65535 : 255;
      put(to, value(scan.color[a]) / scan.brightest * full);
    }
    ++points.count;
  }

  [[noreturn]] void fail_here(const std::string& what) const { fail(source_, place() + what); }

  FileBytes& bytes_;
  const Source& source_;
  std::optional<e57::ImageFile> file_;
  std::shared_ptr<Attributes> table_ = Attributes::of_points(Attributes::Dialect::kPly);
  std::uint64_t declared_ = 0;
  std::vector<Scan> scans_;
  std::vector<std::size_t> offsets_;  // of the properties within a record
  std::size_t stride_ = 0;
  std::size_t scan_ = 0;                      // number of the scan that is worked on, 0 for none
  std::size_t at_ = 0;                        // index of the scan that is read
  std::vector<std::vector<double>> numbers_;  // a block of each of its fields
  std::optional<e57::CompressedVectorReader> reader_;
  std::uint64_t done_ = 0;  // of its points
  std::uint64_t dropped_ = 0;
};

// Errors of the library as ours.
template <class Work>
auto checked(const Source& source, const E57Points& points, const Work& work) {
  try {
    return work();
  } catch (const e57::E57Exception& error) {
    fail(source, points.place() + "damaged: libE57Format cannot read it (" + error.errorStr() + "); export the file anew");
  }
}

class E57Records : public FixedRecords {
 public:
  struct Opened {
    explicit Opened(const RandomFile& file) : source{{}, file.path()}, bytes(source, file), points(bytes) {}
    Source source;
    FileBytes bytes;
    E57Points points;
    Attributes table;
  };
  // `opened` is of `file`.
  E57Records(std::unique_ptr<RandomFile> file, std::unique_ptr<Opened> opened)
      : FixedRecords(std::move(file), 0, opened->table), opened_(std::move(opened)), block_(table().points()) {}

 private:
  void fetch(std::size_t count, std::string& records) override {
    const std::size_t wanted = count * block_.stride();
    checked(opened_->source, opened_->points, [&] {
      while (block_.data.size() < wanted && opened_->points.next(block_)) {
      }
    });
    records.assign(block_.data, 0, wanted);
    block_.data.erase(0, records.size());
  }

  std::unique_ptr<Opened> opened_;
  Element block_;  // with the records that have not been handed out
};

}  // namespace

Cloud read_e57(const Source& source) {
  FileBytes bytes(source);
  check_e57(bytes);
  E57Points points(bytes);
  Cloud cloud;
  cloud.format = "e57";
  checked(source, points, [&] {
    points.open({source.bytes.data(), source.bytes.size(), e57::ChecksumNone});
    cloud.sensor_positions = points.sensors();
    auto table = std::make_shared<Attributes>(points.table());
    Element& element = table->elements.back();
    element.data.reserve(static_cast<std::size_t>(points.declared()) * element.stride());
    const bool apart = points.scans() > 1 && !cloud.sensor_positions.empty();
    while (points.next(element)) {
      if (apart) cloud.scan_of_point.resize(static_cast<std::size_t>(element.count), static_cast<std::uint32_t>(points.scan()));
    }
    if (points.dropped() != 0) cloud.warnings.push_back(std::to_string(points.dropped()) + " points marked as invalid are left out");
    fill_cloud(source, std::move(table), cloud);
  });
  return cloud;
}

std::unique_ptr<PointStream> stream_e57(std::unique_ptr<RandomFile> file) {
  auto opened = std::make_unique<E57Records::Opened>(*file);
  check_e57(opened->bytes);
  checked(opened->source, opened->points, [&] {
    opened->points.open({file->path(), "r", e57::ChecksumAll});  // once more: the file may be another one by now
    opened->table = opened->points.table();
    opened->table.elements.back().count = opened->points.count();
  });
  return std::make_unique<E57Records>(std::move(file), std::move(opened));
}

}  // namespace g3r::io
