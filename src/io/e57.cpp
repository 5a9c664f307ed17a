// libE57Format reads the XML and unpacks the points, scan by scan, in blocks. What it does not check is checked in e57_check.cpp before.
// Source: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange", and libE57Format.
#include "io/e57.h"

#include "io/cloud_from_table.h"
#include "io/e57_scans.h"
#include "io/fixed_records.h"
#include "io/readers.h"
#include "io/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <E57Format.h>

namespace g3r::io {

namespace {

// What unpacks to more than this many times the size of its file is refused: half a byte for a point's three doubles. Scans have at least
// 4 bytes for one. Larger: more memory for hostile files.
constexpr std::uint64_t kMostRatio = 64;
constexpr std::size_t kBlock = 4096;  // Records are unpacked so many at a time, which bounds the memory beside the cloud.

constexpr std::array<const char*, 9> kNames = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};  // of the table

constexpr const char* kDropped = " points marked as invalid are left out";

// The points of all scans, one after the other.
class E57Points {
 public:
  explicit E57Points(FileBytes& bytes) : bytes_(bytes), place_{bytes.source()} {}

  // Finds scans and properties. `file` is that of the bytes, which check_e57() has checked.
  void open(e57::ImageFile file) {
    scans_ = find_e57_scans(bytes_, file.root(), place_);
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
    if (std::all_of(scans_.begin(), scans_.end(), [](const E57Scan& scan) { return scan.pose.is_identity() && !scan.spherical; }))
      return places;
    for (const E57Scan& scan : scans_) places.push_back(scan.pose.shift);
    return places;
  }

  // How many points are not marked as invalid; unpacks the marks.
  [[nodiscard]] std::uint64_t count() {
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

  // Appends the records of the next block, which may all be marked as invalid; false at the end.
  bool next(Element& points) {
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

  // For errors of the library.
  [[nodiscard]] const E57Place& place() const { return place_; }

 private:
  // The properties that the scans have together; a type that holds what is in any of them.
  void plan() {
    Element& points = table_->elements.back();
    const auto add = [&](const std::string& name, Type type) {
      std::size_t at = points.find(name);
      if (at == Element::npos) {
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
    const bool words =
        std::any_of(scans_.begin(), scans_.end(), [](const E57Scan& s) { return s.color[0] != Element::npos && s.brightest > 255; });
    for (E57Scan& scan : scans_) {
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
      declared_ += std::min(scan.count, kMostRatio * bytes_.size());
    }
    if (declared_ > kMostRatio * bytes_.size() / points.stride()) {
      place_.fail(std::to_string(declared_) + " points of " + std::to_string(points.stride()) + " bytes in a file of " +
                  std::to_string(bytes_.size()) + " bytes, more than " + std::to_string(kMostRatio) +
                  " times its size: a count is damaged, or the points are all alike; then convert the file");
    }
    for (const Property& property : points.properties) offsets_.push_back(std::exchange(stride_, stride_ + size_of(property.type)));
  }

  void begin_scan(E57Scan& scan) {
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

  void end_scan(const E57Scan& scan) {
    if (done_ != scan.count) {
      place_.fail("truncated: " + std::to_string(scan.count) + " points declared, but only " + std::to_string(done_) +
                  " could be unpacked");
    }
    reader_->close();
    reader_.reset();
  }

  void append_point(const E57Scan& scan, std::size_t i, Element& points) {
    const auto value = [&](std::size_t field) { return numbers_[scan.fields[field].block][i]; };
    if (scan.invalid != Element::npos && value(scan.invalid) != 0) {
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

  FileBytes& bytes_;
  E57Place place_;
  std::optional<e57::ImageFile> file_;
  std::shared_ptr<Attributes> table_ = Attributes::of_points(Attributes::Dialect::kPly);
  std::uint64_t declared_ = 0;
  std::vector<E57Scan> scans_;
  std::vector<std::size_t> offsets_;  // of the properties within a record
  std::size_t stride_ = 0;
  std::size_t at_ = 0;                        // index of the scan that is read
  std::vector<std::vector<double>> numbers_;  // a block of each of its fields
  std::optional<e57::CompressedVectorReader> reader_;
  std::uint64_t done_ = 0;  // of its points
  std::uint64_t dropped_ = 0;
};

// Errors of the library as ours.
template <class Work>
auto checked(const E57Points& points, const Work& work) {
  try {
    return work();
  } catch (const e57::E57Exception& error) {
    points.place().fail("damaged: libE57Format cannot read it (" + error.errorStr() + "); export the file anew");
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

  [[nodiscard]] std::vector<std::string> warnings() const override {
    const std::uint64_t dropped = opened_->points.declared() - opened_->table.points().count;
    if (dropped == 0) return {};
    return {std::to_string(dropped) + kDropped};
  }

 private:
  void fetch(std::size_t count, std::string& records) override {
    const std::size_t wanted = count * block_.stride();
    checked(opened_->points, [&] {
      while (block_.data.size() < wanted && opened_->points.next(block_)) {
      }
    });
    records.assign(block_.data, 0, wanted);
    block_.data.erase(0, records.size());
  }

  std::unique_ptr<Opened> opened_;
  Element block_;  // with the records that have not been returned
};

}  // namespace

Cloud read_e57(const Source& source) {
  FileBytes bytes(source);
  check_e57(bytes);
  E57Points points(bytes);
  Cloud cloud;
  cloud.format = "e57";
  checked(points, [&] {
    points.open({source.bytes.data(), source.bytes.size(), e57::ChecksumNone});
    cloud.sensor_positions = points.sensors();
    auto table = std::make_shared<Attributes>(points.table());
    Element& element = table->elements.back();
    element.data.reserve(static_cast<std::size_t>(points.declared()) * element.stride());
    const bool apart = points.scans() > 1 && !cloud.sensor_positions.empty();
    while (points.next(element)) {
      if (apart) cloud.scan_of_point.resize(static_cast<std::size_t>(element.count), static_cast<std::uint32_t>(points.scan()));
    }
    if (points.dropped() != 0) cloud.warnings.push_back(std::to_string(points.dropped()) + kDropped);
    fill_cloud(source, std::move(table), cloud);
  });
  return cloud;
}

std::unique_ptr<PointStream> stream_e57(std::unique_ptr<RandomFile> file) {
  auto opened = std::make_unique<E57Records::Opened>(*file);
  check_e57(opened->bytes);
  checked(opened->points, [&] {
    opened->points.open({file->path(), "r", e57::ChecksumAll});  // once more: the file may be another one by now
    opened->table = opened->points.table();
    opened->table.elements.back().count = opened->points.count();
  });
  return std::make_unique<E57Records>(std::move(file), std::move(opened));
}

}  // namespace g3r::io
