// LAS out: what makes the records, and where they go, which is a LAS file as it is or packed as LAZ. All takes points some at a time.
#pragma once

#include "io/columns.h"
#include "io/output_file.h"
#include "io/source.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace g3r::io {

class LasPlan;

/// Where the bytes of a LAS file go.
class LasOutput {
 public:
  virtual ~LasOutput() = default;
  /// Header and variable length records, first; offsets in them are those of the LAS file.
  virtual void header(const std::string& text) = 0;
  /// One record of a point, as long as the header says.
  virtual void record(const std::string& bytes) = 0;
  /// After the last point, once. `rest`: bytes that rest() will get.
  virtual void finish(std::uint64_t rest) = 0;
  /// What follows the points, in pieces.
  virtual void rest(std::string_view bytes) = 0;
};

/// Writes LAS.
std::unique_ptr<LasOutput> plain_las(OutputFile& file);

/// Writes LAZ in chunks of 50,000 points. What is in memory is a chunk; of a file that is a pipe or a device, which cannot be gone back in,
/// all packed points until finish(). Throws Unavailable in builds without LASzip.
std::unique_ptr<LasOutput> packed_las(OutputFile& file);

/// Makes records of points.
class LasWriter {
 public:
  virtual ~LasWriter() = default;
  /// The next points. `stored`: their records in the LAS file that they come from, back to back; not used by new_las(). Throws
  /// InvalidInput for a point that LAS cannot hold.
  virtual void write(const PointData& data, const char* stored) = 0;
};

/// For the points of a LAS file, which keep its header, variable length records and every byte of every record; normals and confidence are
/// added as extra bytes. `head` is what comes before the points of that file, whose count has been checked. Writes the header. Throws
/// InvalidInput.
std::unique_ptr<LasWriter> las_from_las(const Source& head, bool normals, bool confidence, LasOutput& out);

/// For other points, of which `plan` has all and which must outlive the writer. Writes the header. Throws InvalidInput.
std::unique_ptr<LasWriter> new_las(const LasPlan& plan, LasOutput& out);

}  // namespace g3r::io
