#include "base/control_groups.h"

#include "base/platform.h"
#include "base/whole_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>

namespace g3r::platform {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kNoLimit = 0x1p62;  // bytes: the first version has no word for it, and says the largest number that is whole pages

// How the files of one version of control groups are called.
struct Names {
  const char* folder;
  const char* limit;
  const char* used;
  const char* cached;  // pages of files that the system takes back before it kills: a word of memory.stat, of this group and those in it
};
constexpr Names kFirst{"/memory", "/memory.limit_in_bytes", "/memory.usage_in_bytes", "total_inactive_file"};
constexpr Names kSecond{"", "/memory.max", "/memory.current", "inactive_file"};

// None where there is no such file, or no number in it ("max").
std::optional<double> number_in(const std::string& path) {
  std::ifstream in(path);
  double value = 0;
  if (in >> value) return value;
  return std::nullopt;
}

double cached_pages(const std::string& folder, const std::string& word) {
  std::ifstream in(folder + "/memory.stat");
  std::string name;
  double value = 0;
  while (in >> name >> value) {
    if (name == word) return value;
  }
  return 0;
}

double left_in(const std::string& folder, const Names& names) {
  const std::optional<double> limit = number_in(folder + names.limit);
  const std::optional<double> used = number_in(folder + names.used);
  if (!limit || !used || *limit >= kNoLimit) return kUnlimited;
  return std::max(0.0, *limit - *used + cached_pages(folder, names.cached));
}

// The group and all around it, to the root.
double left_along(std::string group, const std::string& root, const Names& names) {
  double left = left_in(root + names.folder, names);
  for (; group.size() > 1; group.erase(group.rfind('/'))) left = std::min(left, left_in(root + names.folder + group, names));
  return left;
}

}  // namespace

double memory_left_by_groups(const std::string& memberships, const std::string& root) {
  double left = kUnlimited;
  std::istringstream lines(memberships);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos || line.compare(second + 1, 1, "/") != 0) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string group = line.substr(second + 1);
    if (controllers == ",,") left = std::min(left, left_along(group, root, kSecond));
    if (controllers.find(",memory,") != std::string::npos) left = std::min(left, left_along(group, root, kFirst));
  }
  return left;
}

double container_memory() {
  std::ifstream groups("/proc/self/cgroup");
  const std::string memberships{std::istreambuf_iterator<char>(groups), {}};
  return memory_left_by_groups(memberships, "/sys/fs/cgroup");
}

std::size_t share_of_free_memory(double share) {
  const double free = free_memory();
  if (!(free > 0) && std::isinf(container_memory())) return 0;
  return std::max<std::size_t>(1, whole_bytes(share * std::max(0.0, free)));
}

}  // namespace g3r::platform
