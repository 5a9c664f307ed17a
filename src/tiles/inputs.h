// The files that a plan of tiles is made of, and their points as they come.
#pragma once

#include "base/stages.h"
#include "io/point_stream.h"

#include <g3r/io.h>
#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace g3r::tiles {

/// The files of points that inputs stand for, in their order: those of folders, of patterns and of lists of tiles, and other inputs
/// themselves. Throws IoError, InvalidInput.
[[nodiscard]] std::vector<std::string> found_files(const std::vector<std::string>& inputs);

/// The same, at least one, with absolute paths, so that workers may be started anywhere. Throws InvalidInput also for names that are not
/// UTF-8.
[[nodiscard]] std::vector<std::string> files_of(const std::vector<std::string>& inputs);

/// No point takes less than a byte of its file: as many points as bytes; more than there can be where a size is not known. Most clouds need
/// not be counted then.
[[nodiscard]] std::uint64_t most_points(const std::vector<std::string>& files);

/// point_hash() of the points of each file. Reads all. Throws like read_cloud().
[[nodiscard]] std::vector<std::uint64_t> hashes_of(const std::vector<std::string>& files, int threads, Stages& stages);

/// Points read at once.
inline constexpr std::size_t kPointsAtOnce = std::size_t{1} << 16;

/// Calls begin(file, stream) for each file, take(file, point) for all points in order, and between(share of the work) now and then: files
/// count alike, as only one of them is open. Throws what io::open_points() and PointStream::next() throw.
template <class Begin, class Between, class Take>
void for_all_points(const std::vector<std::string>& files, const ReadOptions& options, const Begin& begin, const Between& between,
                    const Take& take) {
  std::vector<Vec3> points;
  for (std::size_t f = 0; f < files.size(); ++f) {
    const std::unique_ptr<io::PointStream> stream = io::open_points(files[f], false, options);
    begin(f, *stream);
    const auto all = static_cast<double>(stream->left());
    for (stream->next(kPointsAtOnce, points); !points.empty(); stream->next(kPointsAtOnce, points)) {
      const double of_file = 1 - static_cast<double>(stream->left() + points.size()) / all;
      between((static_cast<double>(f) + of_file) / static_cast<double>(files.size()));
      for (const Vec3& p : points) take(f, p);
    }
  }
}

}  // namespace g3r::tiles
