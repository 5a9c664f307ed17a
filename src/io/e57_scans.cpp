// Source: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange", and libE57Format.
#define E57_INTERNAL_IMPLEMENTATION_ENABLE 1  // for the place of a scan's binary section
#include "io/e57_scans.h"

#include "io/e57.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include <CompressedVectorNodeImpl.h>

namespace g3r::io {

namespace {

constexpr std::array<const char*, 3> kCartesian = {"cartesianX", "cartesianY", "cartesianZ"};
constexpr std::array<const char*, 3> kSpherical = {"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
constexpr std::array<const char*, 3> kNormal = {"nor:normalX", "nor:normalY", "nor:normalZ"};
constexpr std::array<const char*, 3> kColor = {"colorRed", "colorGreen", "colorBlue"};
constexpr std::array<const char*, 3> kColorMost = {"colorLimits/colorRedMaximum", "colorLimits/colorGreenMaximum",
                                                   "colorLimits/colorBlueMaximum"};

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
std::optional<E57Field> make_field(const e57::Node& node) {
  const auto bits_between = [](std::int64_t low, std::int64_t high) {
    return static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low)));
  };
  switch (node.type()) {
    case e57::TypeInteger: {
      const e57::IntegerNode integer(node);
      const std::int64_t low = integer.minimum();
      const std::int64_t high = integer.maximum();
      return E57Field{node.elementName(), integer_type(low, high), bits_between(low, high), static_cast<double>(high)};
    }
    case e57::TypeScaledInteger: {
      const e57::ScaledIntegerNode integer(node);
      return E57Field{node.elementName(), Type::kFloat64, bits_between(integer.minimum(), integer.maximum())};
    }
    case e57::TypeFloat: {
      const bool single = e57::FloatNode(node).precision() == e57::PrecisionSingle;
      return E57Field{node.elementName(), single ? Type::kFloat32 : Type::kFloat64, single ? 32U : 64U};
    }
    case e57::TypeString:
      return E57Field{"", Type::kUint8, 8};  // at least its length
    default:
      return std::nullopt;
  }
}

class Finder {
 public:
  Finder(FileBytes& bytes, E57Place& place) : bytes_(bytes), place_(place) {}

  std::vector<E57Scan> find_scans(const e57::StructureNode& root) {
    std::vector<E57Scan> scans;
    if (!root.isDefined("data3D") || root.get("data3D").type() != e57::TypeVector)
      io::fail(place_.source, "no scans: expected a vector data3D");
    const e57::VectorNode list(root.get("data3D"));
    for (std::int64_t i = 0; i < list.childCount(); ++i) {
      place_.scan = static_cast<std::size_t>(i) + 1;
      const e57::Node node = list.get(i);
      if (node.type() != e57::TypeStructure) place_.fail("expected a structure");
      const e57::StructureNode structure(node);
      if (!structure.isDefined("points") || structure.get("points").type() != e57::TypeCompressedVector) place_.fail("it has no points");
      const e57::CompressedVectorNode points(structure.get("points"));
      if (points.childCount() < 0) place_.fail("its number of points is negative");
      if (points.childCount() == 0) continue;
      E57Scan scan{place_.scan, points, static_cast<std::uint64_t>(points.childCount())};
      find_fields(scan);
      find_colors(structure, scan);
      scan.pose = find_pose(structure);
      scans.push_back(std::move(scan));
    }
    place_.scan = 0;
    if (scans.empty()) io::fail(place_.source, "no points: no scan has any");
    return scans;
  }

 private:
  void find_fields(E57Scan& scan) {
    if (scan.points.prototype().type() != e57::TypeStructure) place_.fail("its prototype is no structure");
    const e57::StructureNode prototype(scan.points.prototype());
    for (std::int64_t i = 0; i < prototype.childCount(); ++i) {
      const std::optional<E57Field> field = make_field(prototype.get(i));
      if (!field) place_.fail("field " + quote(prototype.get(i).elementName()) + " is neither a number nor text; convert the file");
      scan.fields.push_back(*field);
    }
    const auto find = [&](const char* name) {
      const auto found = std::find_if(scan.fields.begin(), scan.fields.end(), [&](const E57Field& f) { return f.name == name; });
      return found == scan.fields.end() ? Element::npos : static_cast<std::size_t>(found - scan.fields.begin());
    };
    const auto find_all = [&](const std::array<const char*, 3>& names, std::array<std::size_t, 3>& found) {
      for (std::size_t a = 0; a < 3; ++a) found[a] = find(names[a]);
      if (std::find(found.begin(), found.end(), Element::npos) == found.end()) return true;
      found.fill(Element::npos);
      return false;
    };
    scan.spherical = !find_all(kCartesian, scan.position);
    if (scan.spherical && !find_all(kSpherical, scan.position)) {
      place_.fail("expected the fields cartesianX, cartesianY, cartesianZ or sphericalRange, sphericalAzimuth, sphericalElevation");
    }
    find_all(kNormal, scan.normal);
    find_all(kColor, scan.color);
    scan.invalid = find(scan.spherical ? "sphericalInvalidState" : "cartesianInvalidState");
    check_count(scan);
  }

  // The library unpacks a field without bits from nothing, as often as the file says.
  void check_count(const E57Scan& scan) const {
    const std::vector<std::uint64_t> bytes =
        check_e57_packets(bytes_, scan.points.impl()->getBinarySectionLogicalStart(), scan.fields.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (scan.fields[i].bits != 0 && scan.count > 8 * bytes[i] / scan.fields[i].bits) {
        place_.fail("truncated or damaged: " + std::to_string(scan.count) + " points declared, but field " + std::to_string(i + 1) +
                    " has bytes for " + std::to_string(8 * bytes[i] / scan.fields[i].bits));
      }
    }
  }

  static void find_colors(const e57::StructureNode& structure, E57Scan& scan) {
    if (scan.color[0] == Element::npos) return;
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

  E57Pose find_pose(const e57::StructureNode& structure) const {
    E57Pose pose;
    double length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      pose.q[i] = number(structure, std::string("pose/rotation/") + "wxyz"[i]).value_or(pose.q[i]);
      length += pose.q[i] * pose.q[i];
    }
    if (!(length > 0.5 && length < 2)) place_.fail("the rotation of its pose is no unit quaternion");
    for (double& q : pose.q) q /= std::sqrt(length);
    for (std::size_t a = 0; a < 3; ++a) {
      pose.shift[a] = number(structure, std::string("pose/translation/") + "xyz"[a]).value_or(0);
      if (!std::isfinite(pose.shift[a])) place_.fail("the translation of its pose is not finite");
    }
    return pose;
  }

  FileBytes& bytes_;
  E57Place& place_;
};

}  // namespace

std::vector<E57Scan> find_e57_scans(FileBytes& bytes, const e57::StructureNode& root, E57Place& place) {
  return Finder(bytes, place).find_scans(root);
}

}  // namespace g3r::io
