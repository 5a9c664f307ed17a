// libE57Format reads the XML and unpacks the points, scan by scan, in blocks. What it does not check is checked in e57_check.cpp before.
// Source: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange", and libE57Format.
#include "io/e57.h"

#include "io/cloud_from_table.h"
#include "io/readers.h"
#include "io/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
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

class E57Reader {
 public:
  E57Reader(const Source& source, Cloud& cloud) : source_(source), cloud_(cloud) {}

  void read() {
    const e57::ImageFile file(source_.bytes.data(), source_.bytes.size(), e57::ChecksumNone);  // check_e57() has checked them
    find_scans(file.root());
    const std::shared_ptr<Attributes> table = Attributes::of_points(Attributes::Dialect::kPly);
    Element& points = table->elements.back();
    plan(points);
    find_sensors();
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      read_points(file, scans_[i], points);
      if (scans_.size() > 1 && !cloud_.sensor_positions.empty()) {
        cloud_.scan_of_point.resize(static_cast<std::size_t>(points.count), static_cast<std::uint32_t>(i));
      }
    }
    if (dropped_ != 0) cloud_.warnings.push_back(std::to_string(dropped_) + " points marked as invalid are left out");
    fill_cloud(source_, table, cloud_);
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
        check_e57_packets(source_, scan.points.impl()->getBinarySectionLogicalStart(), scan.fields.size());
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

  // A scanner stands at the origin of its scan. Where no scan has a pose the points may have been joined and moved before.
  void find_sensors() {
    if (std::all_of(scans_.begin(), scans_.end(), [](const Scan& scan) { return scan.pose.is_identity() && !scan.spherical; })) return;
    for (const Scan& scan : scans_) cloud_.sensor_positions.push_back(scan.pose.shift);
  }

  // The properties that the scans have together; a type that holds what is in any of them.
  void plan(Element& points) {
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
    std::uint64_t count = 0;
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
      count += std::min(scan.count, kMostRatio * source_.bytes.size());
    }
    if (count > kMostRatio * source_.bytes.size() / points.stride()) {
      fail(source_, std::to_string(count) + " points of " + std::to_string(points.stride()) + " bytes in a file of " +
                        std::to_string(source_.bytes.size()) + " bytes, more than " + std::to_string(kMostRatio) +
                        " times its size: a count is damaged, or the points are all alike; then convert the file");
    }
    points.data.reserve(static_cast<std::size_t>(count) * points.stride());
    for (const Property& property : points.properties) offsets_.push_back(std::exchange(stride_, stride_ + size_of(property.type)));
  }

  void read_points(const e57::ImageFile& file, Scan& scan, Element& points) {
    scan_ = scan.number;
    const auto block = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, scan.count));
    std::vector<std::vector<double>> numbers;
    std::vector<e57::SourceDestBuffer> buffers;
    numbers.reserve(scan.fields.size());
    for (std::size_t i = 0; i < scan.fields.size(); ++i) {
      Field& field = scan.fields[i];
      if (field.to == kNone && i != scan.invalid) continue;
      field.block = numbers.size();
      numbers.emplace_back(block);
      buffers.emplace_back(file, field.name, numbers.back().data(), block, true, true);
    }
    e57::CompressedVectorReader reader = e57::CompressedVectorNode(scan.points).reader(buffers);
    std::uint64_t done = 0;
    while (const std::size_t read = reader.read()) {
      for (std::size_t i = 0; i < read; ++i) append_point(scan, numbers, i, points);
      done += read;
    }
    if (done != scan.count) {
      fail_here("truncated: " + std::to_string(scan.count) + " points declared, but only " + std::to_string(done) + " could be unpacked");
    }
    reader.close();
    scan_ = 0;
  }

  void append_point(const Scan& scan, const std::vector<std::vector<double>>& numbers, std::size_t i, Element& points) {
    const auto value = [&](std::size_t field) { return numbers[scan.fields[field].block][i]; };
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

  const Source& source_;
  Cloud& cloud_;
  std::vector<Scan> scans_;
  std::vector<std::size_t> offsets_;  // of the properties within a record
  std::size_t stride_ = 0;
  std::size_t scan_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace

Cloud read_e57(const Source& source) {
  check_e57(source);
  Cloud cloud;
  cloud.format = "e57";
  E57Reader reader(source, cloud);
  try {
    reader.read();
    return cloud;
  } catch (const e57::E57Exception& error) {
    fail(source, reader.place() + "damaged: libE57Format cannot read it (" + error.errorStr() + "); export the file anew");
  }
}

}  // namespace g3r::io
