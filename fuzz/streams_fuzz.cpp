// libFuzzer target for files as streams: what is read piece by piece is held against the reader of the whole file.
#include "io/point_stream.h"

#include <g3r/error.h>
#include <g3r/io.h>

#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "require.h"

namespace {

using g3r::fuzz::require;

constexpr std::size_t kAtOnce = 3;  // points, so that most streams are read in several pieces

// The input as a file, which is in memory.
class File {
 public:
  File(const std::uint8_t* data, std::size_t size) : fd_(::memfd_create("input", MFD_CLOEXEC)) {
    require(fd_ >= 0 && ::write(fd_, data, size) == static_cast<ssize_t>(size), "a file for the input");
  }
  ~File() { ::close(fd_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

struct Streamed {
  std::vector<g3r::Vec3> points;
  std::string records;
};

// Nothing where the file is refused.
std::optional<Streamed> streamed(const std::string& path) {
  try {
    const auto stream = g3r::io::open_points(path, true);
    const std::uint64_t count = stream->left();
    Streamed all;
    std::vector<g3r::Vec3> points;
    std::string records;
    for (stream->next(kAtOnce, points, &records); !points.empty(); stream->next(kAtOnce, points, &records)) {
      require(points.size() <= kAtOnce, "no more points than were asked for");
      all.points.insert(all.points.end(), points.begin(), points.end());
      all.records += records;
    }
    require(stream->left() == 0 && all.points.size() == count, "as many points as were announced");
    return all;
  } catch (const g3r::InvalidInput&) {
    return std::nullopt;
  }
}

std::optional<g3r::Cloud> whole(const std::uint8_t* data, std::size_t size) {
  try {
    return g3r::read_cloud_bytes(data, size, "input");
  } catch (const g3r::InvalidInput&) {
    return std::nullopt;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  const std::optional<Streamed> stream = streamed(file.path());
  const std::optional<g3r::Cloud> cloud = whole(data, size);
  if (!cloud) return 0;  // streams do not see what follows the points
  require(stream.has_value(), "a stream of what can be read");
  const std::size_t bytes = cloud->positions.size() * sizeof(g3r::Vec3);
  require(stream->points.size() == cloud->positions.size(), "as many points");
  require(bytes == 0 || std::memcmp(stream->points.data(), cloud->positions.data(), bytes) == 0, "the same points");
  if (cloud->attributes != nullptr) require(stream->records == cloud->attributes->points().data, "the same records");
  return 0;
}
