// libE57Format reads the XML (e57_scans.cpp) and unpacks the points (e57_points.cpp). What it does not check is checked in e57_check.cpp
// before.
// Source: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange", and libE57Format.
#include "io/e57.h"

#include "io/cloud_from_table.h"
#include "io/e57_points.h"
#include "io/fixed_records.h"
#include "io/readers.h"

#include <memory>
#include <string>
#include <utility>

#include <E57Format.h>

namespace g3r::io {

namespace {

constexpr const char* kDropped = " points marked as invalid are left out";

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
