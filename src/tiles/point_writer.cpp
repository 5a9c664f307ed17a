#include "tiles/point_writer.h"

#include "io/laz.h"
#include "io/source.h"
#include "io/writers.h"

#include <algorithm>
#include <utility>

namespace g3r::tiles {
namespace {

constexpr std::size_t kMostPoints = std::size_t{1} << 18;    // written at once
constexpr std::size_t kMostRecords = std::size_t{32} << 20;  // bytes of their records; larger gains no time
constexpr std::size_t kListPoints = std::size_t{1} << 14;    // written at once where lists make records differ

}  // namespace

std::size_t PointWriter::block(const io::PointStream& stream) {
  const std::size_t stride = stream.table().points().stride();
  return stride == 0 ? kListPoints : std::clamp<std::size_t>(kMostRecords / stride, 1, kMostPoints);
}

void PointWriter::look_at(const Input& input, Stages& stages) {
  Part& part = parts_.emplace_back();
  const auto stream = io::open_points(input.path, true, {.cancel = stages.cancel()});
  const Attributes& table = stream->table();
  part.table = Attributes::of_points(table.dialect, table.points());
  if (table.dialect == Attributes::Dialect::kPly) part.table->comments = table.comments;
  if (io::LasOrigin* las = stream->las(); las != nullptr && las_file_ && alone_) {
    from_las_ = true;
    path_ = input.path;
    head_ = las->head();
    las_ = io::las_from_las({head_, path_}, true, true, *las_file_);
    return;
  }
  const io::Element& properties = part.table->elements[0];
  const io::Roles roles = io::find_roles(properties);
  part.cloud.scalar = stream->scalar();
  part.cloud.attributes = part.table;
  if (roles.normal[0] != io::Element::npos) part.cloud.normals.resize(1);
  io::RecordColors colors(properties);
  if (!colors.exist()) return;
  const bool kept = alone_ && !las_file_ && table.dialect == Attributes::Dialect::kPly;  // as they are in the records
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

PointWriter::PointWriter(const std::string& output, const Manifest& manifest, Stages& stages)
    : file_(output, stages.cancel()), alone_(manifest.inputs.size() == 1) {
  check(output, manifest);
  const std::string format = io::extension(output);
  if (format == "las") las_file_ = io::plain_las(file_);
  if (format == "laz") las_file_ = io::packed_las(file_);
  for (const Input& input : manifest.inputs) look_at(input, stages);
  if (!from_las_) write_header(manifest, stages);
}

void PointWriter::check(const std::string& output, const Manifest& manifest) {
  require_no_input(manifest, output);
  const std::string format = io::extension(output);
  if (format == "ply") return;
  const std::string name = escape_text(output);
  if (format != "las" && format != "laz") {
    throw InvalidInput(name + ": tiles are merged into a binary PLY, LAS or LAZ: expected a name that ends in .ply, .las or .laz");
  }
  if (format == "laz" && !io::laz_is_compiled()) throw Unavailable(name + ": this build does not write LAZ: write LAS (.las)");
  if (manifest.non_finite == 0) return;
  throw InvalidInput(name + ": LAS cannot hold coordinates that are not finite, and " + std::to_string(manifest.non_finite) +
                     " points have such: write PLY");
}

// Reads the inputs as they will be written.
void PointWriter::measure_for_las(const Manifest& manifest, Stages& stages) {
  const std::vector<Vec3> normals;
  const std::vector<float> confidence;
  const WriteOptions options;
  for (std::size_t i = 0; i < manifest.inputs.size(); ++i) {
    const auto stream = io::open_points(manifest.inputs[i].path, true, {.cancel = stages.cancel()});
    std::vector<Vec3> points;
    std::string records;
    const std::size_t most = block(*stream);
    for (stream->next(most, points, &records); !points.empty(); stream->next(most, points, &records)) {
      stages.still_going();
      const Cloud cloud = as_written(i, points, records);
      las_plan_->add({cloud, &normals, &confidence, cloud.attributes.get(), options});
    }
  }
  las_plan_->finish();
}

void PointWriter::write_header(const Manifest& manifest, Stages& stages) {
  Cloud like = parts_[0].cloud;
  if (!alone_) {
    std::vector<Cloud> clouds;
    std::vector<io::RecordColors*> colors;
    for (Part& part : parts_) {
      clouds.push_back(part.cloud);
      if (part.colors) colors.push_back(&*part.colors);
    }
    merger_.emplace(clouds, io::RecordColors::agree(colors));
    like = Cloud();
    like.attributes = Attributes::of_points(merger_->dialect(), merger_->element());
    const auto is_float = [](const Cloud& cloud) { return cloud.scalar == Scalar::kFloat32; };
    if (std::all_of(clouds.begin(), clouds.end(), is_float)) like.scalar = Scalar::kFloat32;
    colored_ = std::any_of(clouds.begin(), clouds.end(), [](const Cloud& cloud) { return !cloud.colors.empty(); });
    if (colored_) like.colors.resize(1);
  } else if (las_file_ && like.attributes->dialect == Attributes::Dialect::kLas) {
    like.attributes = Attributes::of_points(Attributes::Dialect::kNone, like.attributes->points());  // without what belongs to its header
  }
  const std::vector<Vec3> normals;
  const std::vector<float> confidence;
  const WriteOptions options;
  const io::PointData data{like, &normals, &confidence, like.attributes.get(), options};
  if (las_file_) {
    las_plan_.emplace(data);
    measure_for_las(manifest, stages);
    las_ = io::new_las(*las_plan_, *las_file_);
    return;
  }
  columns_ = io::ply_columns(data);
  file_.write(io::ply_header(alone_ ? parts_[0].table->comments : std::vector<std::string>(), manifest.points, columns_));
}

void PointWriter::begin(io::PointStream& stream) {
  if (!from_las_) return;
  io::LasOrigin* las = stream.las();
  if (las == nullptr || las->head() != head_)
    throw InvalidInput(escape_text(path_) + ": has changed while it was read: another header; make the plan anew");
  las->keep(&stored_);
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
  cloud.attributes = Attributes::of_points(part.table->dialect, std::move(element));
  return cloud;
}

// The points with the properties that the file gets.
Cloud PointWriter::as_written(std::size_t input, const std::vector<Vec3>& points, std::string& records) {
  const Part& part = parts_[input];
  Cloud cloud = make_cloud(part, points, records);
  if (merger_) {
    merger_->append(cloud, part.colors ? &*part.colors : nullptr);
    cloud.attributes = Attributes::of_points(merger_->dialect(), merger_->take());
    if (colored_) cloud.colors.resize(points.size());  // of those that have none
  }
  return cloud;
}

void PointWriter::write(std::size_t input, const std::vector<Vec3>& points, std::string& records, const std::vector<Vec3>& normals,
                        const std::vector<float>& confidence) {
  const WriteOptions options;
  if (from_las_) {
    Cloud cloud;
    cloud.positions = points;
    las_->write({cloud, &normals, &confidence, nullptr, options}, stored_.data());
    stored_.clear();
    return;
  }
  const Cloud cloud = as_written(input, points, records);
  const io::PointData data{cloud, &normals, &confidence, cloud.attributes.get(), options};
  if (las_) {
    las_->write(data, nullptr);
  } else {
    io::write_rows(data, columns_, file_);
  }
}

void PointWriter::end(io::PointStream& stream) {
  if (!from_las_) return;
  las_file_->finish(stream.las()->rest());
  stream.las()->read_rest([&](std::string_view bytes) { las_file_->rest(bytes); });
}

void PointWriter::commit() {
  if (las_file_ && !from_las_) las_file_->finish(0);
  file_.commit();
}

}  // namespace g3r::tiles
