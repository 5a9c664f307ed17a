// The points of an E57 file, unpacked scan by scan, in blocks. For sources of E57 alone, as it shows libE57Format.
#pragma once

#include "io/e57_scans.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <E57Format.h>

namespace g3r::io {

/// The points of all scans, one after the other. All members throw InvalidInput, and the library's exceptions.
class E57Points {
 public:
  explicit E57Points(FileBytes& bytes) : bytes_(bytes), place_{bytes.source()} {}

  /// Finds scans and properties. `file` is that of the bytes, which check_e57() has checked.
  void open(e57::ImageFile file);

  /// Without data.
  [[nodiscard]] const Attributes& table() const { return *table_; }
  /// With those that are marked as invalid.
  [[nodiscard]] std::uint64_t declared() const { return declared_; }
  [[nodiscard]] std::size_t scans() const { return scans_.size(); }
  /// Of the points that next() has given.
  [[nodiscard]] std::size_t scan() const { return at_; }
  /// Points marked as invalid, so far.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  /// A scanner stands at the origin of its scan. Where no scan has a pose the points may have been joined and moved before: none then.
  [[nodiscard]] std::vector<Vec3> sensors() const;
  /// How many points are not marked as invalid; unpacks the marks.
  [[nodiscard]] std::uint64_t count();
  /// Appends the records of the next block, which may all be marked as invalid; false at the end.
  bool next(Element& points);
  /// For errors of the library.
  [[nodiscard]] const E57Place& place() const { return place_; }

 private:
  void plan();
  void place_fields(E57Scan& scan, bool words);
  void begin_scan(E57Scan& scan);
  void end_scan(const E57Scan& scan);
  void append_point(const E57Scan& scan, std::size_t i, Element& points);

  FileBytes& bytes_;
  E57Place place_;
  std::optional<e57::ImageFile> file_;
  std::shared_ptr<Attributes> table_ = Attributes::of_points(Attributes::Dialect::kPly);
  std::uint64_t declared_ = 0;
  std::vector<E57Scan> scans_;
  std::vector<std::size_t> offsets_;  // of the properties within a record
  std::size_t stride_ = 0;
  std::size_t at_ = 0;                        // index of the scan that is read
  std::vector<std::vector<double>> numbers_;  // a block of each of its fields
  std::optional<e57::CompressedVectorReader> reader_;
  std::uint64_t done_ = 0;  // of its points
  std::uint64_t dropped_ = 0;
};

}  // namespace g3r::io
