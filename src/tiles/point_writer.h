// The merged file: points of all inputs with their results and with what the inputs say of them, written some points at a time.
#pragma once

#include "base/stages.h"
#include "io/cloud_from_table.h"
#include "io/columns.h"
#include "io/las_output.h"
#include "io/las_plan.h"
#include "io/merger.h"
#include "io/output_file.h"
#include "io/point_stream.h"
#include "tiles/manifest.h"

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace g3r::tiles {

/// A binary PLY with the properties that write_cloud() gives the same cloud, but no elements beside the points; or LAS or LAZ, the bytes
/// that write_cloud() writes.
class PointWriter {
 public:
  /// The extension of `output` chooses the format. Looks at the inputs; reads those once whose colours can be told only from all of them.
  /// Throws like read_cloud() and write_cloud(), and Cancelled.
  PointWriter(const std::string& output, const Manifest& manifest, Stages& stages);
  /// Throws InvalidInput where the extension is of another format, or the points are not finite, which LAS cannot hold; Unavailable for LAZ
  /// in builds without it.
  static void check(const std::string& output, const Manifest& manifest);

  /// Points to hand over at once, so that their records take little memory.
  [[nodiscard]] static std::size_t block(const io::PointStream& stream);
  /// Before the first points of an input are read from its stream.
  void begin(io::PointStream& stream);
  /// Writes points of an input, whose records are used up.
  void write(std::size_t input, const std::vector<Vec3>& points, std::string& records, const std::vector<Vec3>& normals,
             const std::vector<float>& confidence);
  /// After the last points of an input have been read from its stream.
  void end(io::PointStream& stream);
  /// Makes the file take its place.
  void commit();
  /// What the format cannot hold as it is: WriteOptions::warnings.
  [[nodiscard]] std::vector<std::string> warnings() const { return las_plan_ ? las_plan_->warnings() : std::vector<std::string>(); }

 private:
  // What is known of an input without its points.
  struct Part {
    std::shared_ptr<Attributes> table;       // with the comments of a PLY
    std::optional<io::RecordColors> colors;  // if they are to be brought to 0..255, and are not all black
    Cloud cloud;                             // without points; members that the file has are not empty
  };
  void look_at(const Input& input, Stages& stages);
  void write_header(const Manifest& manifest, Stages& stages);
  void measure_for_las(const Manifest& manifest, Stages& stages);
  [[nodiscard]] Cloud make_cloud(const Part& part, const std::vector<Vec3>& points, std::string& records) const;
  [[nodiscard]] Cloud as_written(std::size_t input, const std::vector<Vec3>& points, std::string& records);

  io::OutputFile file_;
  bool alone_;                               // one input
  std::unique_ptr<io::LasOutput> las_file_;  // null for PLY
  std::optional<io::LasPlan> las_plan_;      // of a LAS file that is none of the inputs with results
  std::unique_ptr<io::LasWriter> las_;
  bool from_las_ = false;  // one input that is LAS or LAZ, written as such
  std::string path_;       // of it
  std::string head_;       // what comes before its records
  std::string stored_;     // those of the points that are written next
  bool colored_ = false;   // several inputs, some with colours
  std::deque<Part> parts_;
  std::optional<io::Merger> merger_;  // of several inputs
  std::vector<io::Column> columns_;   // of PLY
};

}  // namespace g3r::tiles
