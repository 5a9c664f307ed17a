#include "io/point_stream.h"

#include "io/cloud_from_table.h"
#include "io/ept.h"
#include "io/fixed_records.h"
#include "io/las.h"
#include "io/laz.h"
#include "io/merger.h"
#include "io/random_file.h"
#include "io/readers.h"
#include "io/recognise.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace g3r::io {
namespace {

constexpr std::size_t kHead = std::size_t{1} << 16;       // bytes that a format is told by and that headers of PLY seldom exceed
constexpr std::size_t kMostHead = std::size_t{16} << 20;  // bytes before the points of a LAS file that is read as a stream

class LasRecords : public FixedRecords, public LasOrigin {
 public:
  // `head`: what comes before the points.
  LasRecords(std::unique_ptr<RandomFile> file, const Source& head, const LasHeader& header)
      : FixedRecords(std::move(file), header.points_at, las_table(header)), header_(header) {
    if (header.compressed) {
      laz_ = std::make_unique<LazRecords>(head, header, this->file());
    } else {
      head_ = head.bytes.substr(0, header.points_at);
    }
  }

  [[nodiscard]] std::vector<std::string> warnings() const override {
    if (!header_.geographic) return {};
    return {kDegrees};
  }
  [[nodiscard]] LasOrigin* las() override { return this; }
  [[nodiscard]] const std::string& head() const override { return laz_ ? laz_->las_head() : head_; }
  void keep(std::string* records) override { kept_ = records; }
  [[nodiscard]] std::uint64_t rest() const override { return file().size() - rest_at(); }
  void read_rest(const std::function<void(std::string_view)>& take) const override {
    constexpr std::uint64_t kPiece = std::uint64_t{1} << 20U;
    std::string piece;
    for (std::uint64_t at = rest_at(); at < file().size(); at += piece.size()) {
      piece.resize(static_cast<std::size_t>(std::min(kPiece, file().size() - at)));
      file().read(at, piece.data(), piece.size());
      take(piece);
    }
  }

 private:
  [[nodiscard]] std::uint64_t rest_at() const { return laz_ ? laz_->rest() : header_.points_at + header_.count * header_.record_bytes; }

  void fetch(std::size_t count, std::string& records) override {
    bytes_.clear();
    if (laz_) {
      laz_->next(count, bytes_);
    } else {
      read(count * header_.record_bytes, bytes_);
    }
    records.resize(bytes_.size() / header_.record_bytes * table().points().stride());
    char* to = records.data();
    for (std::size_t at = 0; at < bytes_.size(); at += header_.record_bytes) to = copy_las_record(header_, bytes_.data() + at, to);
    if (kept_ != nullptr) kept_->append(bytes_);
  }

  LasHeader header_;
  std::string head_;  // of LAS
  std::unique_ptr<LazRecords> laz_;
  std::string bytes_;  // as in the file
  std::string* kept_ = nullptr;
};

// The whole file, in memory.
class WholeCloud : public PointStream {
 public:
  WholeCloud(const std::string& path, bool with_records, const ReadOptions& options) : cloud_(read_cloud(path, options)) {
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
  [[nodiscard]] std::vector<std::string> warnings() const override { return cloud_.warnings; }

 private:
  // Of a file that is no table: positions and colours. Normals and confidence would be replaced.
  void make_table() {
    cloud_.normals = {};
    cloud_.confidence = {};
    Merger merger({cloud_});
    merger.append(cloud_);
    cloud_.attributes = Attributes::of_points(Attributes::Dialect::kPly, merger.take());
  }

  Cloud cloud_;
  Attributes table_;  // without data
  const char* record_ = nullptr;
  std::size_t at_ = 0;
};

// Null for what the reader of whole files refuses.
std::unique_ptr<PointStream> las_records(std::unique_ptr<RandomFile> file, std::string head, const std::string& path) {
  // What the header says is checked against the size of the file, and its variable length records may be anywhere before the points.
  if (head.size() < las::kRecordBytes + 2) return nullptr;
  const std::uint64_t points_at = load<std::uint32_t>(head.data() + las::kPointsAt);
  if (points_at > file->size() || points_at > kMostHead) return nullptr;
  const std::size_t known = head.size();
  if (points_at > known) {
    head.resize(static_cast<std::size_t>(points_at));
    file->read(known, head.data() + known, head.size() - known);
  }
  const Source source{head, path};
  const LasHeader header = read_las_header(source, file->size());
  if (header.count == 0) return nullptr;
  return std::make_unique<LasRecords>(std::move(file), source, header);
}

std::unique_ptr<PointStream> stored_records(std::unique_ptr<RandomFile> file, std::optional<StoredTable> stored) {
  if (!stored) return nullptr;
  const Roles roles = find_roles(stored->table.points());
  if (std::count(roles.position, roles.position + 3, Element::npos) != 0) return nullptr;
  return std::make_unique<FixedRecords>(std::move(file), stored->begin, std::move(stored->table));
}

// Of what is told by more than its first letters; null for the rest, and for what may not be what its head looks like.
std::unique_ptr<PointStream> parsed_records(std::unique_ptr<RandomFile>& file, const Source& head) {
  const bool whole = head.bytes.size() == file->size();
  if (is_binary_stl(head.bytes, file->size())) return nullptr;
  const std::uint64_t begin = head.bytes.size() - without_mark(head.bytes).size();
  try {
    const Format format = recognise(head);
    if (format == Format::kText) return stream_xyz(std::move(file), begin);
    if (format == Format::kPtx) return stream_ptx(std::move(file), begin);
    if (format == Format::kAsciiGrid) return stream_ascii_grid(std::move(file), begin);
    if (format == Format::kE57) return stream_e57(std::move(file));
  } catch (const InvalidInput&) {
    if (whole || !file) throw;  // what is recognised is refused for good
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<PointStream> open_points(const std::string& path, bool with_records, const ReadOptions& options) {
  if (!find_ept(path).empty()) return std::make_unique<WholeCloud>(path, with_records, options);
  auto file = std::make_unique<RandomFile>(path);
  std::string head(static_cast<std::size_t>(std::min<std::uint64_t>(file->size(), kHead)), '\0');
  file->read(0, head.data(), head.size());
  const Source source{head, path};
  const std::uint64_t size = file->size();
  std::unique_ptr<PointStream> stream;
  if (head.starts_with("ply")) {
    stream = stored_records(std::move(file), find_ply_records(source, size));
  } else if (head.starts_with("# .PCD")) {
    stream = stored_records(std::move(file), find_pcd_records(source, size));
  } else if (head.starts_with("\x93NUMPY")) {
    std::optional<StoredTable> stored = find_npy_records(source, *file);
    stream = stored_records(std::move(file), std::move(stored));
  } else if (head.starts_with("LASF")) {
    stream = las_records(std::move(file), head, path);
  } else {
    stream = parsed_records(file, source);
  }
  if (!stream) stream = std::make_unique<WholeCloud>(path, with_records, options);
  return stream;
}

}  // namespace g3r::io
