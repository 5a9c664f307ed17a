// Where write_las() puts a LAS file: as it is, or packed as LAZ.
#pragma once

#include "io/output_file.h"

#include <memory>
#include <string>
#include <string_view>

namespace g3r::io {

class LasOutput {
 public:
  virtual ~LasOutput() = default;
  /// Header and variable length records, first; offsets in them are those of the LAS file.
  virtual void header(const std::string& text) = 0;
  /// One record of a point, as long as the header says.
  virtual void record(const std::string& bytes) = 0;
  /// What follows the points, last.
  virtual void finish(std::string_view rest) = 0;
};

/// Writes LAS.
std::unique_ptr<LasOutput> plain_las(OutputFile& file);

/// Writes LAZ in chunks of 50,000 points; all packed points are held in memory until the end. Throws Unavailable in builds without LASzip.
std::unique_ptr<LasOutput> packed_las(OutputFile& file);

}  // namespace g3r::io
