#include "io/fixed_records.h"

#include "io/cloud_from_table.h"

#include <algorithm>
#include <utility>

namespace g3r::io {

namespace {

constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // bytes of records read at once

}  // namespace

std::optional<StoredTable> stored_table(Attributes::Dialect dialect, std::vector<std::string> comments, Element points, std::uint64_t begin,
                                        std::uint64_t file_size) {
  const std::size_t stride = points.stride();
  if (stride == 0 || points.count > (file_size - begin) / stride) return std::nullopt;
  StoredTable stored;
  stored.begin = begin;
  stored.table.dialect = dialect;
  stored.table.comments = std::move(comments);
  stored.table.elements.push_back(std::move(points));
  return stored;
}

FixedRecords::FixedRecords(std::unique_ptr<RandomFile> file, std::uint64_t begin, Attributes table)
    : file_(std::move(file)), at_(begin), left_(table.points().count), table_(std::move(table)), layout_(table_.points()) {
  const Roles roles = find_roles(table_.points());
  std::copy_n(roles.position, 3, position_.begin());
}

void FixedRecords::next(std::size_t most, std::vector<Vec3>& points, std::string* records) {
  points.clear();
  if (records != nullptr) records->clear();
  while (left_ > 0 && points.size() < most) {
    const std::uint64_t wanted = std::min<std::uint64_t>(left_, most - points.size());
    const std::size_t at_once = std::max<std::size_t>(1, kAtOnce / layout_.size());
    fetch(static_cast<std::size_t>(std::min<std::uint64_t>(wanted, at_once)), bytes_);
    if (bytes_.empty())
      throw InvalidInput(escape_text(file_->path()) + ": has changed while it was read: " + std::to_string(left_) + " points are missing");
    left_ -= bytes_.size() / layout_.size();
    const std::vector<Property>& properties = table_.points().properties;
    for (const char* record = bytes_.data(); record != bytes_.data() + bytes_.size(); record += layout_.size()) {
      Vec3 p{};
      for (std::size_t a = 0; a < 3; ++a) p[a] = load_as_double(properties[position_[a]].type, record + layout_.offset(position_[a]));
      points.push_back(p);
    }
    if (records != nullptr) records->append(bytes_);
  }
}

Scalar FixedRecords::scalar() const {
  const auto single = [&](std::size_t property) { return table_.points().properties[property].type == Type::kFloat32; };
  return std::all_of(position_.begin(), position_.end(), single) ? Scalar::kFloat32 : Scalar::kFloat64;
}

void FixedRecords::read(std::size_t count, std::string& bytes) {
  bytes.resize(count);
  file_->read(at_, bytes.data(), count);
  at_ += count;
}

}  // namespace g3r::io
