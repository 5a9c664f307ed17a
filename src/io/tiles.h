// Several files that are one cloud: those of a folder, of a pattern, of a list or a virtual point cloud.
#pragma once

#include "io/source.h"

#include <string>
#include <vector>

namespace g3r::io {

/// The files of points that a path stands for, sorted by name: those of a folder, by their extensions, or those that a pattern with * or ?
/// names, or in its own order those of a list (file_lists.h); empty if the path is none of these, or names a file itself. Throws IoError
/// for a folder or pattern without any, and what files_of_list() throws.
std::vector<std::string> find_tiles(const std::string& path);

/// Drops what a cloud keeps of its LAS file beside the points, which a cloud of several files has no use for.
void forget_las(Cloud& cloud);

/// One cloud of several, in their order: properties of numbers that any of them has, 0 where one has not; scanner positions if all have
/// them. `names` and `path` are for messages. The clouds are used up.
Cloud merge_clouds(std::vector<Cloud>& clouds, const std::vector<std::string>& names, const std::string& path);

}  // namespace g3r::io
