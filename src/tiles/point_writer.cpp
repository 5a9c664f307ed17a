#include "tiles/point_writer.h"

#include "io/writers.h"

#include <algorithm>
#include <utility>

namespace g3r::tiles {
namespace {

constexpr std::size_t kMostPoints = std::size_t{1} << 18;    // written at once
constexpr std::size_t kMostRecords = std::size_t{32} << 20;  // bytes of their records; larger gains no time
constexpr std::size_t kListPoints = std::size_t{1} << 14;    // written at once where lists make records differ

// A table of an element's properties with records in it.
std::shared_ptr<Attributes> table_of(const Attributes& like, io::Element element) {
  auto table = std::make_shared<Attributes>();
  table->dialect = like.dialect;
  table->elements.push_back(std::move(element));
  return table;
}

}  // namespace

std::size_t PointWriter::block(const io::PointStream& stream) {
  const std::size_t stride = stream.table().points().stride();
  return stride == 0 ? kListPoints : std::clamp<std::size_t>(kMostRecords / stride, 1, kMostPoints);
}

void PointWriter::look_at(const Input& input, bool alone, Stages& stages) {
  Part& part = parts_.emplace_back();
  const auto stream = io::open_points(input.path, true);
  const Attributes& table = stream->table();
  part.table = table_of(table, table.points());
  const io::Element& properties = part.table->elements[0];
  const io::Roles roles = io::find_roles(properties);
  part.cloud.scalar = stream->scalar();
  part.cloud.attributes = part.table;
  if (roles.normal[0] != io::Element::npos) part.cloud.normals.resize(1);
  if (roles.confidence != io::Element::npos) part.cloud.confidence.resize(1);
  io::RecordColors colors(properties);
  if (!colors.exist()) return;
  const bool kept = alone && table.dialect == Attributes::Dialect::kPly;  // as they are in the records
  if (!kept) {
    std::vector<Vec3> points;
    std::string records;
    const std::size_t most = block(*stream);
    for (stream->next(most, points, &records); !points.empty(); stream->next(most, points, &records)) {
      stages.still_going();
      colors.measure(records.data(), points.size());
    }
    if (colors.are_black()) return;
    part.colors.emplace(colors);
  }
  part.cloud.colors.resize(1);
}

PointWriter::PointWriter(const std::string& output, const Manifest& manifest, Stages& stages) : file_(output, stages.cancel()) {
  std::vector<Cloud> clouds;
  for (const Input& input : manifest.inputs) {
    look_at(input, manifest.inputs.size() == 1, stages);
    clouds.push_back(parts_.back().cloud);
  }
  Cloud like = clouds[0];
  std::vector<std::string> comments = parts_[0].table->comments;
  if (clouds.size() > 1) {
    merger_.emplace(clouds);
    like = Cloud();
    like.attributes = table_of(Attributes(), merger_->element());
  }
  const std::vector<Vec3> normals;
  const std::vector<float> confidence;
  const WriteOptions options;
  columns_ = io::ply_columns({like, &normals, &confidence, like.attributes.get(), options});
  file_.write(io::ply_header(comments, manifest.points, columns_));
}

Cloud PointWriter::make_cloud(const Part& part, const std::vector<Vec3>& points, std::string& records) const {
  Cloud cloud;
  cloud.positions = points;
  if (part.colors) {
    io::RecordLayout layout(part.table->points());
    const char* record = records.data();
    for (std::size_t i = 0; i < points.size(); ++i, record += layout.size()) {
      layout.seek(record);
      cloud.colors.push_back(part.colors->color(layout, record));
    }
  }
  io::Element element = part.table->points();
  element.count = points.size();
  element.data.swap(records);
  cloud.attributes = table_of(*part.table, std::move(element));
  return cloud;
}

void PointWriter::write(std::size_t input, const std::vector<Vec3>& points, std::string& records, const std::vector<Vec3>& normals,
                        const std::vector<float>& confidence) {
  Cloud cloud = make_cloud(parts_[input], points, records);
  if (merger_) {
    merger_->append(cloud);
    cloud.colors = {};  // are in the table now
    cloud.attributes = table_of(Attributes(), merger_->take());
  }
  const WriteOptions options;
  io::write_rows({cloud, &normals, &confidence, cloud.attributes.get(), options}, columns_, file_);
}

}  // namespace g3r::tiles
