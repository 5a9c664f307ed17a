// EPT (Entwine Point Tile): a folder of ept.json, pages of a hierarchy, and one file of points per cell of an octree, LAZ or records.
#pragma once

#include "io/source.h"

#include <string>
#include <vector>

namespace g3r::io {

/// The ept.json that a path stands for: itself, or that of a folder; empty if there is none.
std::string find_ept(const std::string& path);

/// Files of points that together are what an ept.json stands for, coarse cells first: of LAZ its cells, of records itself. Throws IoError,
/// InvalidInput.
std::vector<std::string> ept_files(const std::string& path);

/// The points of all cells, of the levels and the box of `options`, as one cloud, coarse cells first. Opens files below the folder of
/// ept.json only. Throws IoError, InvalidInput.
Cloud read_ept(const std::string& path, const ReadOptions& options);

}  // namespace g3r::io
