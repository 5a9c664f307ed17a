// Files that name other files: lists, and virtual point clouds.
#pragma once

#include <string>
#include <vector>

namespace g3r::io {

/// Whether a path names a list (.list) or a virtual point cloud (.vpc), by its extension.
bool is_file_list(const std::string& path);

/// The files that it names, in its order, relative ones from its folder. A list has one path a line, blank lines and those that begin with
/// # aside. A virtual point cloud is a STAC FeatureCollection in JSON, as QGIS and PDAL write it: of every feature assets.data.href.
/// Throws IoError, and InvalidInput for what is none, names no file, or a place on the network.
std::vector<std::string> files_of_list(const std::string& path);

}  // namespace g3r::io
