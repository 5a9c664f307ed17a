#include "io/point_stream.h"

#include "io/cloud_from_table.h"
#include "io/las.h"
#include "io/merger.h"
#include "io/ply_header.h"
#include "io/random_file.h"
#include "io/recognise.h"
#include "io/splats.h"

#include <algorithm>
#include <array>
#include <utility>

namespace g3r::io {
namespace {

constexpr std::size_t kHead = std::size_t{1} << 16;    // bytes that a format is told by and that headers of PLY seldom exceed
constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // bytes of records read at once

// Records of one size, one after the other in the file.
class FixedRecords : public PointStream {
 public:
  FixedRecords(std::unique_ptr<RandomFile> file, std::uint64_t begin, std::uint64_t count, std::size_t stride, Attributes table)
      : file_(std::move(file)), at_(begin), left_(count), stride_(stride), table_(std::move(table)), layout_(table_.points()) {
    const Roles roles = find_roles(table_.points());
    std::copy_n(roles.position, 3, position_.begin());
  }

  void next(std::size_t most, std::vector<Vec3>& points, std::string* records) override {
    points.clear();
    if (records != nullptr) records->clear();
    while (left_ > 0 && points.size() < most) {
      const std::uint64_t wanted = std::min<std::uint64_t>(left_, most - points.size());
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(wanted, std::max<std::size_t>(1, kAtOnce / stride_)));
      bytes_.resize(count * stride_);
      file_->read(at_, bytes_.data(), bytes_.size());
      at_ += bytes_.size();
      left_ -= count;
      decode(bytes_);
      const std::vector<Property>& properties = table_.points().properties;
      for (const char* record = bytes_.data(); record != bytes_.data() + bytes_.size(); record += layout_.size()) {
        Vec3 p{};
        for (std::size_t a = 0; a < 3; ++a) p[a] = load_as_double(properties[position_[a]].type, record + layout_.offset(position_[a]));
        points.push_back(p);
      }
      if (records != nullptr) records->append(bytes_);
    }
  }

  [[nodiscard]] std::uint64_t left() const override { return left_; }
  [[nodiscard]] Scalar scalar() const override {
    const auto single = [&](std::size_t property) { return table_.points().properties[property].type == Type::kFloat32; };
    return std::all_of(position_.begin(), position_.end(), single) ? Scalar::kFloat32 : Scalar::kFloat64;
  }
  [[nodiscard]] const Attributes& table() const override { return table_; }

 protected:
  // Turns records of the file into those of the table.
  virtual void decode(std::string& /*records*/) const {}

 private:
  std::unique_ptr<RandomFile> file_;
  std::uint64_t at_;
  std::uint64_t left_;
  std::size_t stride_;  // in the file
  Attributes table_;
  RecordLayout layout_;
  std::array<std::size_t, 3> position_{};
  std::string bytes_;
};

class LasRecords : public FixedRecords {
 public:
  LasRecords(std::unique_ptr<RandomFile> file, const LasHeader& header)
      : FixedRecords(std::move(file), header.points_at, header.count, header.record_bytes, las_table(header)), header_(header) {}

 private:
  void decode(std::string& records) const override {
    std::string out(records.size() / header_.record_bytes * table().points().stride(), '\0');
    char* to = out.data();
    for (std::size_t at = 0; at < records.size(); at += header_.record_bytes) to = copy_las_record(header_, records.data() + at, to);
    records.swap(out);
  }

  LasHeader header_;
};

// The whole file, in memory.
class WholeCloud : public PointStream {
 public:
  WholeCloud(const std::string& path, bool with_records) : cloud_(read_cloud(path)) {
    if (cloud_.attributes == nullptr) make_table();
    const Attributes& from = *cloud_.attributes;
    table_.dialect = from.dialect;
    table_.comments = from.comments;
    table_.elements.push_back({from.points().name, from.points().count, from.points().properties, {}});
    record_ = from.points().data.data();
    if (with_records) return;
    cloud_.attributes.reset();
    record_ = nullptr;
  }

  void next(std::size_t most, std::vector<Vec3>& points, std::string* records) override {
    const std::size_t count = std::min(most, cloud_.positions.size() - at_);
    const auto begin = cloud_.positions.begin() + static_cast<std::ptrdiff_t>(at_);
    points.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
    at_ += count;
    if (record_ == nullptr) return;
    RecordLayout layout(table_.points());
    const char* const first = record_;
    for (std::size_t i = 0; i < count; ++i, record_ += layout.size()) layout.seek(record_);
    if (records != nullptr) records->assign(first, record_);
  }

  [[nodiscard]] std::uint64_t left() const override { return cloud_.positions.size() - at_; }
  [[nodiscard]] Scalar scalar() const override { return cloud_.scalar; }
  [[nodiscard]] const Attributes& table() const override { return table_; }

 private:
  // Of a file that is no table: positions and colours. Normals and confidence would be replaced.
  void make_table() {
    cloud_.normals = {};
    cloud_.confidence = {};
    Merger merger({cloud_});
    merger.append(cloud_);
    Attributes table;
    table.elements.push_back(merger.take());
    cloud_.attributes = std::make_shared<Attributes>(std::move(table));
  }

  Cloud cloud_;
  Attributes table_;  // without data
  const char* record_ = nullptr;
  std::size_t at_ = 0;
};

// The header of a LAS file that is not packed, from which its records are found; null for LAZ.
std::unique_ptr<PointStream> las_records(std::unique_ptr<RandomFile> file, const std::string& path) {
  // What the header says is checked against the size of the file, and its variable length records may be anywhere before the points.
  std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(file->size(), kHead)), '\0');
  file->read(0, bytes.data(), bytes.size());
  if (bytes.size() < las::kRecordBytes + 2 || (load<std::uint8_t>(bytes.data() + las::kPointFormat) & 0xC0U) != 0) return nullptr;
  const std::uint64_t points_at = load<std::uint32_t>(bytes.data() + las::kPointsAt);
  if (points_at > bytes.size()) return nullptr;
  const LasHeader header = read_las_header({bytes, path}, file->size());
  if (header.compressed) return nullptr;
  return std::make_unique<LasRecords>(std::move(file), header);
}

// The same for PLY: null where records are not found by counting.
std::unique_ptr<PointStream> ply_records(std::unique_ptr<RandomFile> file, const std::string& head, const std::string& path) {
  if (head.find("end_header") == std::string::npos) return nullptr;
  PlyHeader header = read_ply_header({head, path});
  if (header.encoding != PlyEncoding::kLittleEndian || header.vertex != 0) return nullptr;
  const Element& points = header.elements[0];
  const std::size_t stride = points.stride();
  if (stride == 0 || is_splat(points) || points.count > (file->size() - header.body) / stride) return nullptr;
  const Roles roles = find_roles(points);
  if (std::count(roles.position, roles.position + 3, Element::npos) != 0) return nullptr;
  const std::uint64_t count = points.count;
  Attributes table;
  table.comments = std::move(header.comments);
  table.elements.push_back(std::move(header.elements[0]));
  return std::make_unique<FixedRecords>(std::move(file), header.body, count, stride, std::move(table));
}

}  // namespace

std::unique_ptr<PointStream> open_points(const std::string& path, bool with_records) {
  auto file = std::make_unique<RandomFile>(path);
  std::string head(static_cast<std::size_t>(std::min<std::uint64_t>(file->size(), kHead)), '\0');
  file->read(0, head.data(), head.size());
  std::unique_ptr<PointStream> stream;
  if (head.rfind("ply", 0) == 0) stream = ply_records(std::move(file), head, path);
  if (head.rfind("LASF", 0) == 0) stream = las_records(std::move(file), path);
  if (!stream) stream = std::make_unique<WholeCloud>(path, with_records);
  return stream;
}

}  // namespace g3r::io
