// LAZ, which is LAS with compressed points. Only laz_*.cpp and pack_laz.cpp know LASzip; laz_not_compiled.cpp stands in for them.
#pragma once

#include "io/las.h"
#include "io/random_file.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace g3r::io {

/// Whether LAZ files can be read and written.
bool laz_is_compiled();

/// Throws InvalidInput, with the name of a converter, if LAZ files cannot be read.
void require_laz(const Source& source);

/// The LAS file that a LAZ file stands for: the same header, variable length records and records of points, byte for byte, and what follows
/// the points. `header` is that of `source`. Of COPC, whose own record is left out, only the cells that `options` ask for; counts and
/// bounds are theirs. Throws InvalidInput, also if that would be more than 256 times the size of the file.
std::string unpack_laz(const Source& source, const LasHeader& header, const ReadOptions& options = {});

/// The records of the points of a LAZ file, COPC too, as unpack_laz() gives them, some at a time: what is in memory is a chunk.
class LazRecords {
 public:
  /// `head`: what comes before the points, with the name of the file, from which `header` is. The file must outlive this. Throws
  /// InvalidInput, IoError.
  LazRecords(const Source& head, const LasHeader& header, const RandomFile& file);
  ~LazRecords();
  /// Appends the next records, at most `most`; none at the end. Throws InvalidInput, IoError.
  void next(std::size_t most, std::string& records);
  /// Header and variable length records as unpack_laz() gives them.
  [[nodiscard]] const std::string& las_head() const;
  /// Byte offset in the file of what follows the points.
  [[nodiscard]] std::uint64_t rest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace g3r::io
