#include "io/copc.h"

#include <algorithm>
#include <cmath>

namespace g3r::io {

namespace {

using namespace las;

constexpr std::size_t kInfo = 160;  // bytes of the record: centre, half side, spacing (double), place and size of the first page (u64) ...
constexpr std::size_t kEntryBytes = 32;  // level, x, y, z (i32), place (u64), bytes, points (i32)
constexpr std::int32_t kPage = -1;       // as the number of points: there is a page of entries

struct Octree {
  Vec3 low{};
  double side = 0;
};

class Hierarchy {
 public:
  Hierarchy(const Source& source, const Octree& octree, const ReadOptions& options) : source_(source), octree_(octree), options_(options) {}

  void read(std::uint64_t at, std::uint64_t bytes) {
    pages_.emplace_back(at, bytes);
    while (!pages_.empty()) {
      const auto [begin, size] = pages_.back();
      pages_.pop_back();
      read_page(begin, size);
    }
    std::sort(cells_.begin(), cells_.end(), [](const CopcCell& a, const CopcCell& b) { return a.begin < b.begin; });
  }

  std::vector<CopcCell> take() { return std::move(cells_); }

 private:
  void read_page(std::uint64_t begin, std::uint64_t size) {
    if (begin > source_.bytes.size() || size > source_.bytes.size() - begin || size % kEntryBytes != 0)
      fail_at_byte(source_, static_cast<std::size_t>(std::min<std::uint64_t>(begin, source_.bytes.size())),
                   "truncated or damaged: a page of the COPC hierarchy of " + std::to_string(size) + " bytes does not fit here");
    seen_ += size;
    if (seen_ > source_.bytes.size()) fail(source_, "damaged: the pages of the COPC hierarchy refer to each other");
    for (std::uint64_t at = begin; at < begin + size; at += kEntryBytes)
      read_entry(source_.bytes.data() + at, static_cast<std::size_t>(at));
  }

  void read_entry(const char* entry, std::size_t at) {
    const auto level = load<std::int32_t>(entry);
    const auto bytes = load<std::int32_t>(entry + 24);
    const auto points = load<std::int32_t>(entry + 28);
    constexpr std::int32_t kDeepest = 60;  // Cells of deeper levels are smaller than the steps of double; 2^level stays a whole number.
    if (level < 0 || level > kDeepest || bytes < 0 || points < kPage) fail_at_byte(source_, at, "damaged: no entry of a COPC hierarchy");
    if (options_.levels != 0 && level >= options_.levels) return;
    if (!meets_box(level, entry + 4)) return;
    const auto begin = load<std::uint64_t>(entry + 16);
    if (points == kPage) {
      pages_.emplace_back(begin, static_cast<std::uint64_t>(bytes));
    } else if (points != 0) {
      cells_.push_back({begin, static_cast<std::uint64_t>(bytes), static_cast<std::uint64_t>(points)});
    }
  }

  [[nodiscard]] bool meets_box(std::int32_t level, const char* key) const {
    if (!options_.box) return true;
    const double side = std::ldexp(octree_.side, -level);
    const double slack = 1e-6 * side;  // points on the side of a cell may lie in either
    for (std::size_t a = 0; a < 3; ++a) {
      const double low = octree_.low[a] + side * load<std::int32_t>(key + 4 * a);
      if (low - slack > options_.box->high[a] || low + side + slack < options_.box->low[a]) return false;
    }
    return true;
  }

  const Source& source_;
  const Octree& octree_;
  const ReadOptions& options_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> pages_;
  std::vector<CopcCell> cells_;
  std::uint64_t seen_ = 0;
};

}  // namespace

bool is_copc(const Source& source, const LasHeader& header) {
  const std::size_t at = header.header_size;
  if (header.vlr_count == 0 || header.points_at - at < kVlrHeader + kInfo) return false;
  return source.bytes.substr(at + 2, 5) == std::string_view("copc\0", 5) && load<std::uint16_t>(source.bytes.data() + at + 18) == 1 &&
         load<std::uint16_t>(source.bytes.data() + at + 20) == kInfo;
}

std::vector<CopcCell> find_copc_cells(const Source& source, const LasHeader& header, const ReadOptions& options) {
  const char* info = source.bytes.data() + header.header_size + kVlrHeader;
  const auto half = load<double>(info + 24);
  Octree octree;
  octree.side = 2 * half;
  bool sound = std::isfinite(half) && half > 0;
  for (std::size_t a = 0; a < 3; ++a) {
    octree.low[a] = load<double>(info + 8 * a) - half;
    sound = sound && std::isfinite(octree.low[a]);
  }
  if (!sound) fail_at_byte(source, header.header_size + kVlrHeader, "damaged: the cube of the COPC octree is not finite");
  Hierarchy hierarchy(source, octree, options);
  hierarchy.read(load<std::uint64_t>(info + 40), load<std::uint64_t>(info + 48));
  return hierarchy.take();
}

}  // namespace g3r::io
