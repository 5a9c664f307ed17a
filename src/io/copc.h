// COPC: a LAZ file whose chunks are the cells of an octree, coarse ones first. Source: COPC 1.0, copc.io.
#pragma once

#include "io/las.h"

#include <cstdint>
#include <vector>

namespace g3r::io {

/// Whether a LAZ file says that it is COPC: by its first variable length record.
bool is_copc(const Source& source, const LasHeader& header);

/// A cell with points.
struct CopcCell {
  std::uint64_t begin;  ///< of its chunk in the file
  std::uint64_t bytes;
  std::uint64_t points;
};

/// The cells of a COPC file that meet the box and belong to the levels of `options`, by their place in the file. Throws InvalidInput.
std::vector<CopcCell> find_copc_cells(const Source& source, const LasHeader& header, const ReadOptions& options);

}  // namespace g3r::io
