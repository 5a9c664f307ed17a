// The inputs once more, with the results beside them: tiles list theirs in the order of the input, so all files are read front to back.
#include "base/platform.h"
#include "base/stages.h"
#include "io/point_stream.h"
#include "tiles/manifest.h"
#include "tiles/point_hash.h"
#include "tiles/point_writer.h"
#include "tiles/records.h"

#include <g3r/io.h>
#include <g3r/tiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>

namespace g3r::tiles {
namespace {

constexpr std::uint64_t kCursorMemory = 64u << 20;  // bytes of the results that all cursors hold: it does not grow with the tiles

// The results of a tile, front to back.
class Cursor {
 public:
  // `points`: of the input, which results lie among; `at_once`: results read at once.
  Cursor(std::string path, std::uint64_t points, std::uint64_t at_once) : pieces_(std::move(path), at_once), points_(points) {}

  // Calls take(result) for those before `end` that have not been taken.
  template <class Take>
  void take_until(std::uint64_t end, const Take& take) {
    while (fill() && results_[used_].index < end) take(results_[used_++]);
  }

 private:
  bool fill() {
    if (used_ < results_.size()) return true;
    if (ended_) return false;
    pieces_.next(results_);
    used_ = 0;
    ended_ = results_.empty();
    check();
    return !ended_;
  }

  void check() {
    for (std::size_t i = 0; i < results_.size(); ++i) {
      const Result& r = results_[i];
      const bool finite = std::isfinite(r.normal[0] + r.normal[1] + r.normal[2] + r.confidence);
      if (finite && r.index >= next_ && r.index < points_) {
        next_ = r.index + 1;
        continue;
      }
      throw InvalidInput(escape_text(pieces_.path()) + ": damaged at record " + std::to_string(pieces_.at() - results_.size() + i) +
                         "; remove it, and g3r tiles run FOLDER does the tile again");
    }
  }

  RecordPieces<Result> pieces_;
  std::uint64_t points_;
  std::uint64_t next_ = 0;  // least index that may follow
  bool ended_ = false;
  std::vector<Result> results_;
  std::size_t used_ = 0;
};

void require_done(const std::string& folder, const Manifest& m) {
  std::string missing;
  std::size_t count = 0;
  for (std::size_t t = 0; t < m.tiles.size(); ++t) {
    if (is_done(folder, m, t)) continue;
    if (++count <= 10) missing += (missing.empty() ? "" : ", ") + std::to_string(t + 1);
  }
  if (count == 0) return;
  throw InvalidInput(escape_text(folder) + ": " + std::to_string(count) + " of " + std::to_string(m.tiles.size()) +
                     " tiles are not done (" + missing + (count > 10 ? ", ..." : "") + "); g3r tiles run FOLDER does them");
}

void require_unchanged(const Input& input, bool same_points) {
  std::error_code ignored;
  if (std::filesystem::file_size(platform::path_of(input.path), ignored) == input.bytes && same_points) return;
  throw InvalidInput(escape_text(input.path) + ": not the file that the plan was made of; make the plan anew");
}

MergedTiles merge(const std::string& folder, const Manifest& m, const std::string& output, const Monitor& monitor) {
  Stages stages(monitor);
  stages.begin("merge");
  std::vector<Cursor> cursors;
  const std::uint64_t at_once = std::clamp<std::uint64_t>(kCursorMemory / (m.tiles.size() * sizeof(Result)), 1, kRecordsAtOnce);
  for (std::size_t t = 0; t < m.tiles.size(); ++t) cursors.emplace_back(result_path(folder, t), m.points, at_once);
  PointWriter writer(output, m, stages);
  std::vector<Vec3> points;
  std::string records;
  std::vector<Vec3> normals;
  std::vector<float> confidence;
  MergedTiles out;
  std::uint64_t begin = 0;
  for (std::size_t i = 0; i < m.inputs.size(); ++i) {
    const Input& input = m.inputs[i];
    const std::unique_ptr<io::PointStream> stream = io::open_points(input.path, true, {.cancel = stages.cancel()});
    const std::size_t block = PointWriter::block(*stream);
    writer.begin(*stream);
    std::uint64_t read = 0;
    std::uint64_t hash = 0;
    for (stream->next(block, points, &records); !points.empty(); stream->next(block, points, &records)) {
      read += points.size();
      require_unchanged(input, read <= input.points);
      for (const Vec3& p : points) hash = point_hash(hash, p);
      normals.assign(points.size(), Vec3{});
      confidence.assign(points.size(), 0);
      for (Cursor& cursor : cursors) {
        cursor.take_until(begin + points.size(), [&](const Result& r) {
          out.confidence_mean += r.confidence;
          out.confidence_below_half += r.confidence < 0.5F ? 1 : 0;
          if (r.index < begin) return;
          const auto at = static_cast<std::size_t>(r.index - begin);
          normals[at] = {r.normal[0], r.normal[1], r.normal[2]};
          confidence[at] = r.confidence;
        });
      }
      writer.write(i, points, records, normals, confidence);
      begin += points.size();
      stages.progress(static_cast<double>(begin) / static_cast<double>(m.points));
    }
    require_unchanged(input, read == input.points && hash == input.hash);
    writer.end(*stream);
  }
  writer.commit();
  out.warnings = writer.warnings();
  out.confidence_mean /= static_cast<double>(m.sorted());
  out.confidence_below_half /= static_cast<double>(m.sorted());
  return out;
}

}  // namespace
}  // namespace g3r::tiles

namespace g3r {

MergedTiles merge_tiles(const std::string& folder, const std::string& output, const Monitor& monitor) {
  const tiles::Manifest manifest = tiles::read_manifest(folder);
  tiles::PointWriter::check(output, manifest);
  tiles::require_done(folder, manifest);
  return tiles::merge(folder, manifest, output, monitor);
}

void check_merge(const std::string& folder, const std::string& output) { tiles::PointWriter::check(output, tiles::read_manifest(folder)); }

}  // namespace g3r
