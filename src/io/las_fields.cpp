#include "io/las_fields.h"

#include "io/las.h"
#include "io/text.h"

#include <algorithm>
#include <cmath>

namespace g3r::io {

namespace {

struct PartName {
  std::string_view name;  // without what stands between words
  LasPart part;
};

// Those of the LAS specification, of LASlib, laspy, PDAL and CloudCompare, and the usual short one.
constexpr PartName kPartNames[] = {{"intensity", LasPart::kIntensity},
                                   {"returnnumber", LasPart::kReturnNumber},
                                   {"numberofreturns", LasPart::kNumberOfReturns},
                                   {"numreturns", LasPart::kNumberOfReturns},
                                   {"scandirectionflag", LasPart::kScanDirection},
                                   {"edgeofflightline", LasPart::kEdgeOfFlightLine},
                                   {"classification", LasPart::kClassification},
                                   {"class", LasPart::kClassification},
                                   {"synthetic", LasPart::kSynthetic},
                                   {"keypoint", LasPart::kKeyPoint},
                                   {"withheld", LasPart::kWithheld},
                                   {"overlap", LasPart::kOverlap},
                                   {"scannerchannel", LasPart::kScannerChannel},
                                   {"scanchannel", LasPart::kScannerChannel},
                                   {"scanangle", LasPart::kScanAngle},
                                   {"scananglerank", LasPart::kScanAngle},
                                   {"userdata", LasPart::kUserData},
                                   {"pointsourceid", LasPart::kPointSource},
                                   {"gpstime", LasPart::kGpsTime},
                                   {"nir", LasPart::kNir},
                                   {"infrared", LasPart::kNir},
                                   {"returnflags", LasPart::kReturnFlags},
                                   {"returnnumbers", LasPart::kReturnNumbers}};

// Names of fields that are no part.
constexpr std::string_view kOtherNames[] = {"x", "y", "z", "red", "green", "blue", "bitfields", "rawclassification", "classificationflags"};

std::string letters_of(std::string_view name) {
  std::string letters;
  for (const char c : lower_case(name)) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) letters += c;
  }
  constexpr std::string_view kScalar = "scalar";  // before CloudCompare's names in PLY
  if (letters.size() > kScalar.size() && letters.compare(0, kScalar.size(), kScalar) == 0) letters.erase(0, kScalar.size());
  return letters;
}

LasPlace unsigned_place(std::size_t offset, unsigned shift, unsigned bits) {
  return {offset, shift, bits, 0, std::ldexp(1.0, static_cast<int>(bits)) - 1};
}

LasPlace old_place(LasPart part, bool whole_bytes) {
  switch (part) {
    case LasPart::kIntensity:
      return unsigned_place(12, 0, 16);
    case LasPart::kReturnNumber:
      return unsigned_place(14, 0, 3);
    case LasPart::kNumberOfReturns:
      return unsigned_place(14, 3, 3);
    case LasPart::kScanDirection:
      return unsigned_place(14, 6, 1);
    case LasPart::kEdgeOfFlightLine:
      return unsigned_place(14, 7, 1);
    case LasPart::kReturnFlags:
      return unsigned_place(14, 0, 8);
    case LasPart::kClassification:
      return unsigned_place(15, 0, whole_bytes ? 8 : 5);
    case LasPart::kSynthetic:
      return unsigned_place(15, 5, 1);
    case LasPart::kKeyPoint:
      return unsigned_place(15, 6, 1);
    case LasPart::kWithheld:
      return unsigned_place(15, 7, 1);
    case LasPart::kScanAngle:
      return whole_bytes ? LasPlace{16, 0, 8, -128, 127} : LasPlace{16, 0, 8, -90, 90};
    case LasPart::kUserData:
      return unsigned_place(17, 0, 8);
    case LasPart::kPointSource:
      return unsigned_place(18, 0, 16);
    case LasPart::kGpsTime:
      return {20, 0, 64, 0, 0};
    default:
      return {};
  }
}

LasPlace new_place(LasPart part, bool whole_bytes) {
  switch (part) {
    case LasPart::kIntensity:
      return unsigned_place(12, 0, 16);
    case LasPart::kReturnNumber:
      return unsigned_place(14, 0, 4);
    case LasPart::kNumberOfReturns:
      return unsigned_place(14, 4, 4);
    case LasPart::kReturnNumbers:
      return unsigned_place(14, 0, 8);
    case LasPart::kSynthetic:
      return unsigned_place(15, 0, 1);
    case LasPart::kKeyPoint:
      return unsigned_place(15, 1, 1);
    case LasPart::kWithheld:
      return unsigned_place(15, 2, 1);
    case LasPart::kOverlap:
      return unsigned_place(15, 3, 1);
    case LasPart::kScannerChannel:
      return unsigned_place(15, 4, 2);
    case LasPart::kScanDirection:
      return unsigned_place(15, 6, 1);
    case LasPart::kEdgeOfFlightLine:
      return unsigned_place(15, 7, 1);
    case LasPart::kReturnFlags:
      return whole_bytes ? unsigned_place(15, 0, 8) : LasPlace{};
    case LasPart::kClassification:
      return unsigned_place(16, 0, 8);
    case LasPart::kUserData:
      return unsigned_place(17, 0, 8);
    case LasPart::kScanAngle:
      return whole_bytes ? LasPlace{18, 0, 16, -32768, 32767} : LasPlace{};
    case LasPart::kPointSource:
      return unsigned_place(20, 0, 16);
    case LasPart::kGpsTime:
      return {22, 0, 64, 0, 0};
    case LasPart::kNir:
      return unsigned_place(36, 0, 16);
    default:
      return {};
  }
}

}  // namespace

LasPart las_part(std::string_view name) {
  const std::string letters = letters_of(name);
  const auto* found =
      std::find_if(std::begin(kPartNames), std::end(kPartNames), [&](const PartName& known) { return known.name == letters; });
  return found == std::end(kPartNames) ? LasPart::kNone : found->part;
}

bool is_las_name(std::string_view name) {
  if (las_part(name) != LasPart::kNone) return true;
  const std::string letters = letters_of(name);
  return std::find(std::begin(kOtherNames), std::end(kOtherNames), letters) != std::end(kOtherNames);
}

LasPlace las_place(LasPart part, LasFamily family, bool whole_bytes) {
  return family == LasFamily::kOld ? old_place(part, whole_bytes) : new_place(part, whole_bytes);
}

std::size_t las_color_offset(unsigned point_format) { return point_format == 2 ? 20 : point_format == 3 ? 28 : 30; }

void put_las_part(const LasPlace& place, double value, std::string& record) {
  if (place.bits == 64) return las::put(record, place.offset, value);
  const auto bits = static_cast<std::uint32_t>(static_cast<std::int32_t>(value)) & ((1U << place.bits) - 1);
  for (std::size_t byte = 0; 8 * byte < place.bits; ++byte) {
    char& at = record[place.offset + byte];
    at = static_cast<char>(static_cast<unsigned char>(at) | ((bits << place.shift) >> (8 * byte) & 0xFFU));
  }
}

unsigned las_point_format(LasFamily family, bool time, bool color, bool nir) {
  if (family == LasFamily::kOld) return (time ? 1U : 0U) + (color ? 2U : 0U);
  return nir ? 8 : color ? 7 : 6;
}

}  // namespace g3r::io
