// Small E57 files, written by libE57Format.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <E57Format.h>

#include "io_samples.h"

namespace g3r::samples {

/// How a field is stored.
struct E57Field {
  enum Kind { kFloat, kDouble, kInteger, kScaled };
  std::string name;
  Kind kind = kDouble;
  std::vector<double> values;  ///< kScaled: multiples of kE57Scale
  std::int64_t low = 0;        ///< of the integers in the file
  std::int64_t high = 0;
};

inline constexpr double kE57Scale = 0.001;
inline constexpr double kE57Offset = 1000;

struct E57Scan {
  std::vector<E57Field> fields;
  std::vector<double> rotation;     ///< w, x, y, z; or none
  std::vector<double> translation;  ///< x, y, z; or none
};

inline e57::Node e57_node(const e57::ImageFile& file, const E57Field& field) {
  switch (field.kind) {
    case E57Field::kFloat:
      return e57::FloatNode(file, 0, e57::PrecisionSingle);
    case E57Field::kInteger:
      return e57::IntegerNode(file, field.low, field.low, field.high);
    case E57Field::kScaled:
      return e57::ScaledIntegerNode(file, field.low, field.low, field.high, kE57Scale, kE57Offset);
    default:
      return e57::FloatNode(file, 0, e57::PrecisionDouble);
  }
}

inline void set_numbers(const e57::ImageFile& file, e57::StructureNode& parent, const std::string& names,
                        const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) parent.set(std::string(1, names[i]), e57::FloatNode(file, values[i]));
}

/// An E57 file of these scans.
inline std::string e57_file(std::vector<E57Scan> scans) {
  const Folder folder;
  const std::string path = folder.path("a.e57");
  e57::ImageFile file(path, "w");
  e57::StructureNode root = file.root();
  file.extensionsAdd("", "http://www.astm.org/COMMIT/E57/2010-e57-v1.0");
  file.extensionsAdd("nor", "http://www.libe57.org/E57_NOR_surface_normals.txt");
  root.set("formatName", e57::StringNode(file, "ASTM E57 3D Imaging Data File"));
  root.set("guid", e57::StringNode(file, "a"));
  e57::VectorNode list(file, true);
  root.set("data3D", list);
  for (E57Scan& scan : scans) {
    e57::StructureNode structure(file);
    list.append(structure);
    if (!scan.rotation.empty() || !scan.translation.empty()) {
      e57::StructureNode pose(file);
      structure.set("pose", pose);
      e57::StructureNode rotation(file);
      set_numbers(file, rotation, "wxyz", scan.rotation);
      if (!scan.rotation.empty()) pose.set("rotation", rotation);
      e57::StructureNode translation(file);
      set_numbers(file, translation, "xyz", scan.translation);
      if (!scan.translation.empty()) pose.set("translation", translation);
    }
    e57::StructureNode prototype(file);
    std::vector<e57::SourceDestBuffer> buffers;
    const std::size_t count = scan.fields[0].values.size();
    for (E57Field& field : scan.fields) {
      field.values.resize(std::max<std::size_t>(count, 1));  // no buffer may be empty
      prototype.set(field.name, e57_node(file, field));
      buffers.emplace_back(file, field.name, field.values.data(), field.values.size(), true, true);
    }
    e57::CompressedVectorNode points(file, prototype, e57::VectorNode(file, true));
    structure.set("points", points);
    e57::CompressedVectorWriter writer = points.writer(buffers);
    if (count != 0) writer.write(count);
    writer.close();
  }
  file.close();
  return slurp(path);
}

/// A scan with a field of every kind: coordinates of `kind`, colours, intensity, a state that says which points are none.
inline E57Scan e57_scan(std::size_t count, E57Field::Kind kind) {
  const Cloud cloud = helix(count);
  E57Scan scan;
  for (std::size_t a = 0; a < 3; ++a) {
    scan.fields.push_back({std::string("cartesian") + "XYZ" [a], kind, {}, -2'000'000, 2'000'000});
    for (const Vec3& p : cloud.positions) {
      const double steps = std::nearbyint((p[a] - kE57Offset) / kE57Scale);  // of what all kinds can hold, nearly
      scan.fields.back().values.push_back(kind == E57Field::kDouble ? p[a] : static_cast<float>(steps * kE57Scale + kE57Offset));
    }
  }
  const std::array<std::string, 3> colors = {"colorRed", "colorGreen", "colorBlue"};
  for (std::size_t c = 0; c < 3; ++c) {
    scan.fields.push_back({colors[c], E57Field::kInteger, {}, 0, 255});
    for (const auto& color : cloud.colors) scan.fields.back().values.push_back(color[c]);
  }
  scan.fields.push_back({"intensity", E57Field::kFloat, {}});
  for (std::size_t i = 0; i < count; ++i) scan.fields.back().values.push_back(static_cast<double>(i) / 4);
  scan.fields.push_back({"rowIndex", E57Field::kInteger, std::vector<double>(count, 7), 7, 7});
  scan.fields.push_back({"cartesianInvalidState", E57Field::kInteger, std::vector<double>(count, 0), 0, 2});
  return scan;
}

inline constexpr std::size_t kE57Page = 1024;
inline constexpr std::size_t kE57Payload = 1020;  ///< of it all but the checksum

inline std::string without_checksums(const std::string& bytes) {
  std::string logical;
  for (std::size_t page = 0; page < bytes.size(); page += kE57Page) logical += bytes.substr(page, kE57Payload);
  return logical;
}

/// Whole pages with their checksums, and the length of the file in the header, as if the bytes had been written so.
inline std::string with_checksums(std::string logical) {
  logical.resize(std::max<std::size_t>(1, (logical.size() + kE57Payload - 1) / kE57Payload) * kE57Payload);
  const std::uint64_t size = logical.size() / kE57Payload * kE57Page;
  std::memcpy(logical.data() + 16, &size, sizeof size);
  std::string bytes;
  for (std::size_t at = 0; at < logical.size(); at += kE57Payload) {
    const std::string page = logical.substr(at, kE57Payload);
    std::uint32_t crc = 0xFFFFFFFF;
    for (const char byte : page) {
      crc ^= static_cast<unsigned char>(byte);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0x82F63B78 : 0);
    }
    bytes += page;
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(~crc >> shift);
  }
  return bytes;
}

}  // namespace g3r::samples
