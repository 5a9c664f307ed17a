// The merged file: points of all inputs with their results and with what the inputs say of them, written some points at a time.
#pragma once

#include "base/stages.h"
#include "io/cloud_from_table.h"
#include "io/columns.h"
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

/// A binary PLY with the properties that write_cloud() gives the same cloud, but no elements beside the points.
class PointWriter {
 public:
  /// Looks at the inputs; reads those once whose colours can be told only from all of them. Throws like read_cloud(), and Cancelled.
  PointWriter(const std::string& output, const Manifest& manifest, Stages& stages);

  /// Points to hand over at once, so that their records take little memory.
  [[nodiscard]] static std::size_t block(const io::PointStream& stream);
  /// Writes points of an input, whose records are used up.
  void write(std::size_t input, const std::vector<Vec3>& points, std::string& records, const std::vector<Vec3>& normals,
             const std::vector<float>& confidence);
  /// Makes the file take its place.
  void commit() { file_.commit(); }

 private:
  // What is known of an input without its points.
  struct Part {
    std::shared_ptr<Attributes> table;
    std::optional<io::RecordColors> colors;  // if they are to be brought to 0..255, and are not all black
    Cloud cloud;                             // without points; members that the file has are not empty
  };
  void look_at(const Input& input, bool alone, Stages& stages);
  [[nodiscard]] Cloud make_cloud(const Part& part, const std::vector<Vec3>& points, std::string& records) const;

  io::OutputFile file_;
  std::deque<Part> parts_;
  std::optional<io::Merger> merger_;  // of several inputs
  std::vector<io::Column> columns_;
};

}  // namespace g3r::tiles
