// The fields of LAS points under the names that files of other formats have for them, and where they are in a record.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace g3r::io {

/// What of a point LAS has a field for. The last two are bytes of several fields, as g3r names them where it reads LAS.
enum class LasPart : std::uint8_t {
  kIntensity,
  kReturnNumber,
  kNumberOfReturns,
  kScanDirection,
  kEdgeOfFlightLine,
  kClassification,
  kSynthetic,
  kKeyPoint,
  kWithheld,
  kOverlap,
  kScannerChannel,
  kScanAngle,
  kUserData,
  kPointSource,
  kGpsTime,
  kNir,
  kReturnFlags,
  kReturnNumbers,
  kNone
};
inline constexpr std::size_t kLasParts = static_cast<std::size_t>(LasPart::kNone);

/// The part that a property is called after, in small or capital letters and whatever stands between words: gps_time, GpsTime,
/// scalar_Gps_Time.
LasPart las_part(std::string_view name);

/// Whether a name is one of LAS's fields, which extra bytes cannot have: readers stumble over two.
bool is_las_name(std::string_view name);

/// The two kinds of point formats: 0 to 5, and 6 to 10.
enum class LasFamily : std::uint8_t { kOld, kNew };

/// Where a part is in a record. A number of so many bits from bit `shift` of the byte at `offset` on; 64 bits are a double.
struct LasPlace {
  std::size_t offset = 0;
  unsigned shift = 0;
  unsigned bits = 0;  ///< 0: the family has no such part
  double low = 0;     ///< the whole numbers that it holds
  double high = 0;
};
/// `whole_bytes`: the points have the bytes of several fields as they are (return_flags, return_numbers), so that the other numbers are
/// those of the file too: a classification has its flags, a scan angle steps of 0.006 degrees.
LasPlace las_place(LasPart part, LasFamily family, bool whole_bytes);

/// Where red, green and blue are.
std::size_t las_color_offset(unsigned point_format);

/// Puts a number that the place holds into a record whose bits there are 0.
void put_las_part(const LasPlace& place, double value, std::string& record);

/// The point format of a family with the least that holds these.
unsigned las_point_format(LasFamily family, bool time, bool color, bool nir);

}  // namespace g3r::io
