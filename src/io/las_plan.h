// What has to be known of all points before a new LAS file begins: the steps of its coordinates, and which properties its fields hold.
#pragma once

#include "io/columns.h"
#include "io/las_column.h"
#include "io/las_coordinates.h"
#include "io/las_fields.h"
#include "io/rows.h"

#include <g3r/io.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::io {

/// Coordinates get the steps of LasCoordinates. A property with the name of a LAS field becomes that field if all its numbers fit, else
/// extra bytes.
class LasPlan {
 public:
  /// `like` has no points but says what they have, as plan_columns() takes it, and has a colour if they have.
  explicit LasPlan(const PointData& like);
  /// Takes note of some points; all are to be added before what follows is asked. Throws InvalidInput for one that is not finite.
  void add(const PointData& data);
  /// Decides, after the last point.
  void finish();

  /// A property that becomes a field.
  struct Field {
    std::size_t column;
    LasPlace place;
  };
  /// A property that becomes extra bytes.
  struct Extra {
    std::size_t column;
    std::string name;
  };
  [[nodiscard]] std::uint64_t count() const { return coordinates_.count(); }
  [[nodiscard]] const Box& bounds() const { return coordinates_.bounds(); }
  [[nodiscard]] const DecimalSteps& steps(std::size_t axis) const { return coordinates_.steps(axis); }
  [[nodiscard]] LasFamily family() const { return family_; }
  [[nodiscard]] unsigned point_format() const { return las_point_format(family_, has(LasPart::kGpsTime), colored_, has(LasPart::kNir)); }
  /// What Rows takes.
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  [[nodiscard]] const std::vector<Field>& fields() const { return fields_; }
  [[nodiscard]] const std::vector<Extra>& extras() const { return extras_; }
  [[nodiscard]] bool colored() const { return colored_; }
  /// The columns of red, green and blue that hold 16 bits; if there are none, colours are those of the cloud.
  [[nodiscard]] const std::vector<std::size_t>& deep_colors() const { return deep_colors_; }
  /// Whether a field holds this, or the byte that does.
  [[nodiscard]] bool has(LasPart part) const;
  [[nodiscard]] bool has_return_numbers() const;
  [[nodiscard]] bool has_counts_of_returns() const;
  /// Points by return number, from 0 on.
  [[nodiscard]] std::array<std::uint64_t, 16> returns() const;
  /// Whether GPS times are more than the seconds of a week.
  [[nodiscard]] bool absolute_time() const;
  /// One line each: what LAS cannot take as it is.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  [[nodiscard]] LasPlace place(const LasColumn& named, LasFamily family) const;
  [[nodiscard]] const LasColumn* find(LasPart part) const;
  void add_returns(double numbers, double flags);
  /// Whether the points are of formats of both families, whose bytes of several fields differ.
  [[nodiscard]] bool is_mixed() const { return has_old_ || (is_numbered_ && has_flags_alone_); }
  void choose_family();
  void place_columns();
  void name_extras();
  void choose_deep_colors();
  [[nodiscard]] std::string misfit(const LasColumn& named) const;

  std::vector<Column> columns_;
  std::vector<std::size_t> others_;  // columns that are neither coordinates nor colours
  std::vector<LasColumn> named_;     // called after parts
  std::vector<LasColumn> channels_;  // red, green and blue in the table
  LasCoordinates coordinates_;
  bool colored_;
  std::array<std::uint64_t, 256> return_bytes_{};  // points by the number that says which return they are
  bool is_numbered_ = false;                       // any point, by return_numbers
  bool has_flags_alone_ = false;                   // any point: return_flags, and no return_numbers
  bool has_old_ = false;                           // such a point whose flags number a return of an old format

  LasFamily family_ = LasFamily::kOld;
  std::vector<Field> fields_;
  std::vector<LasPart> placed_;
  std::vector<Extra> extras_;
  std::vector<std::size_t> deep_colors_;
  std::vector<std::string> warnings_;
};

}  // namespace g3r::io
