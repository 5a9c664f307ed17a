// Linux's control groups: the limits on memory that containers are made of. A process beyond one is killed without a word.
#pragma once

#include <cstddef>
#include <string>

namespace g3r::platform {

/// What the groups of a process and those around them leave of their limits, in bytes; infinite where none has a limit. `memberships`: what
/// /proc/self/cgroup says, "0::/a/b" or "4:memory:/a/b" in a line. `root`: where the groups are seen, /sys/fs/cgroup. Within a container
/// the names may be those outside: a group that is not seen has no limit here, and the root is that of the container.
[[nodiscard]] double memory_left_by_groups(const std::string& memberships, const std::string& root);

/// The same of this process; infinite on systems without control groups.
[[nodiscard]] double container_memory();

/// A share of free_memory() as a limit, in bytes: 1 where nothing is left, 0 where the system does not say.
[[nodiscard]] std::size_t share_of_free_memory(double share);

}  // namespace g3r::platform
