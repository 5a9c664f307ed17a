#include "io/point_stream.h"

#include "io/cloud_from_table.h"
#include "io/las.h"
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

// A coordinate in a record of fixed size: value * scale + offset.
struct Axis {
  Type type = Type::kFloat64;
  std::size_t at = 0;
  double scale = 1;
  double offset = 0;
};

class FixedRecords : public PointStream {
 public:
  FixedRecords(std::unique_ptr<RandomFile> file, std::uint64_t begin, std::uint64_t count, std::size_t stride,
               const std::array<Axis, 3>& axes)
      : file_(std::move(file)), at_(begin), left_(count), stride_(stride), axes_(axes) {}

  void next(std::size_t most, std::vector<Vec3>& points) override {
    points.clear();
    while (left_ > 0 && points.size() < most) {
      const std::uint64_t wanted = std::min<std::uint64_t>(left_, most - points.size());
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(wanted, std::max<std::size_t>(1, kAtOnce / stride_)));
      bytes_.resize(count * stride_);
      file_->read(at_, bytes_.data(), bytes_.size());
      for (std::size_t i = 0; i < count; ++i) {
        Vec3 p{};
        for (std::size_t a = 0; a < 3; ++a) {
          const double value = load_as_double(axes_[a].type, bytes_.data() + i * stride_ + axes_[a].at);
          p[a] = value * axes_[a].scale + axes_[a].offset;
        }
        points.push_back(p);
      }
      at_ += bytes_.size();
      left_ -= count;
    }
  }

  [[nodiscard]] std::uint64_t left() const override { return left_; }
  [[nodiscard]] Scalar scalar() const override {
    const auto single = [](const Axis& axis) { return axis.type == Type::kFloat32; };
    return std::all_of(axes_.begin(), axes_.end(), single) ? Scalar::kFloat32 : Scalar::kFloat64;
  }

 private:
  std::unique_ptr<RandomFile> file_;
  std::uint64_t at_;
  std::uint64_t left_;
  std::size_t stride_;
  std::array<Axis, 3> axes_;
  std::vector<char> bytes_;
};

class WholeCloud : public PointStream {
 public:
  explicit WholeCloud(const std::string& path) {
    Cloud cloud = read_cloud(path);
    positions_ = std::move(cloud.positions);
    scalar_ = cloud.scalar;
  }

  void next(std::size_t most, std::vector<Vec3>& points) override {
    const std::size_t count = std::min(most, positions_.size() - at_);
    const auto begin = positions_.begin() + static_cast<std::ptrdiff_t>(at_);
    points.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
    at_ += count;
  }

  [[nodiscard]] std::uint64_t left() const override { return positions_.size() - at_; }
  [[nodiscard]] Scalar scalar() const override { return scalar_; }

 private:
  std::vector<Vec3> positions_;
  std::size_t at_ = 0;
  Scalar scalar_;
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
  std::array<Axis, 3> axes;
  for (std::size_t a = 0; a < 3; ++a) axes[a] = {Type::kInt32, 4 * a, header.scale[a], header.offset[a]};
  return std::make_unique<FixedRecords>(std::move(file), header.points_at, header.count, header.record_bytes, axes);
}

// The same for PLY: null where records are not found by counting.
std::unique_ptr<PointStream> ply_records(std::unique_ptr<RandomFile> file, const std::string& head, const std::string& path) {
  if (head.find("end_header") == std::string::npos) return nullptr;
  const PlyHeader header = read_ply_header({head, path});
  if (header.encoding != PlyEncoding::kLittleEndian || header.vertex != 0) return nullptr;
  const Element& points = header.elements[0];
  const std::size_t stride = points.stride();
  if (stride == 0 || is_splat(points) || points.count > (file->size() - header.body) / stride) return nullptr;
  const Roles roles = find_roles(points);
  std::array<Axis, 3> axes;
  const RecordLayout layout(points);
  for (std::size_t a = 0; a < 3; ++a) {
    if (roles.position[a] == Element::npos) return nullptr;
    axes[a] = {points.properties[roles.position[a]].type, layout.offset(roles.position[a])};
  }
  return std::make_unique<FixedRecords>(std::move(file), header.body, points.count, stride, axes);
}

}  // namespace

std::unique_ptr<PointStream> open_points(const std::string& path) {
  auto file = std::make_unique<RandomFile>(path);
  std::string head(static_cast<std::size_t>(std::min<std::uint64_t>(file->size(), kHead)), '\0');
  file->read(0, head.data(), head.size());
  std::unique_ptr<PointStream> stream;
  if (head.rfind("ply", 0) == 0) stream = ply_records(std::move(file), head, path);
  if (head.rfind("LASF", 0) == 0) stream = las_records(std::move(file), path);
  if (!stream) stream = std::make_unique<WholeCloud>(path);
  return stream;
}

}  // namespace g3r::io
