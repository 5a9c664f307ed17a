// From typed records to a Cloud: which properties are coordinates, normals, colours and confidence.
#pragma once

#include "io/source.h"
#include "io/table.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r::io {

/// Names of the properties that make up a cloud, in the dialects of PLY and PCD. npos where there is none.
struct Roles {
  std::size_t position[3];
  std::size_t normal[3];
  std::size_t color[3];
  std::size_t packed_color;  ///< PCD's "rgb" or "rgba"
  std::size_t confidence;
};

/// Finds the roles. A role that needs three properties is given only if all three are there and none is a list or an array.
Roles find_roles(const Element& points);

inline constexpr int kDeepSteps = 257;  ///< levels of 16 bits in one of 8: white is 255 and 65535

/// What brings a colour channel with this largest value to 0..255: floats may mean 0..1, all but bytes 0..65535.
double color_scale(Type type, double largest);

/// A colour channel as 0..255; what is beyond is cut off.
std::uint8_t to_color(double value, double scale);

/// The colours of records as 0..255. What brings a channel there depends on all records.
class RecordColors {
 public:
  explicit RecordColors(const Element& points);
  /// Whether the records have any.
  [[nodiscard]] bool exist() const { return channels_ || packed_ != Element::npos; }
  /// Takes note of `count` records. All are to be measured before color().
  void measure(const char* records, std::uint64_t count);
  /// Whether all that were measured are black: never set.
  [[nodiscard]] bool are_black() const;
  /// Of records that become one cloud, all measured: channels that are alike, of whole numbers or of floats beyond 0..1, have 16 bits if
  /// some have. Returns whether any have them.
  static bool agree(const std::vector<RecordColors*>& all);
  /// The colour as 0..65535.
  [[nodiscard]] std::array<std::uint16_t, 3> deep_color(const RecordLayout& layout, const char* record) const;
  /// The colour of a record, which `layout` has laid out.
  [[nodiscard]] std::array<std::uint8_t, 3> color(const RecordLayout& layout, const char* record) const;

 private:
  [[nodiscard]] Type first_type() const { return points_.properties[channel_[0]].type; }
  [[nodiscard]] std::array<double, 3> levels(const RecordLayout& layout, const char* record) const;  // 0..255

  const Element& points_;
  std::array<std::size_t, 3> channel_{};
  bool channels_ = false;
  std::size_t packed_ = Element::npos;
  std::array<double, 3> largest_{};
  double scale_ = 1;
  bool deep_ = false;  // deep_color() is what is kept
  std::uint32_t packed_bits_ = 0;
};

/// Fills positions, normals, colours, confidence and names from the table, which the cloud then holds.
/// Throws InvalidInput if x, y or z is missing or a list. Normals that are all zero are left out, with a warning.
void fill_cloud(const Source& source, std::shared_ptr<const Attributes> table, Cloud& cloud);

}  // namespace g3r::io
