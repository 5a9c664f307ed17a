#include "io/las_extra_bytes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace g3r::io {

namespace {

using namespace las;

constexpr Type kDescribedTypes[] = {Type::kUint8, Type::kInt8,   Type::kUint16, Type::kInt16,   Type::kUint32,
                                    Type::kInt32, Type::kUint64, Type::kInt64,  Type::kFloat32, Type::kFloat64};

// The scale and offset of one of the numbers that a descriptor describes.
DecimalSteps steps_of(const char* descriptor, std::size_t number) {
  constexpr unsigned kHasScale = 8;
  constexpr unsigned kHasOffset = 16;
  constexpr std::size_t kScaleAt = 112;
  constexpr std::size_t kOffsetAt = 136;
  const auto options = static_cast<unsigned char>(descriptor[3]);
  const double scale = (options & kHasScale) != 0 ? load<double>(descriptor + kScaleAt + 8 * number) : 1;
  const double offset = (options & kHasOffset) != 0 ? load<double>(descriptor + kOffsetAt + 8 * number) : 0;
  if (!std::isfinite(scale) || scale == 0 || !std::isfinite(offset)) return DecimalSteps();  // never set, though the options say so
  return DecimalSteps(scale, offset);
}

}  // namespace

void read_extra_bytes(std::string_view descriptors, LasHeader& header) {
  constexpr unsigned kTypes = std::size(kDescribedTypes);
  constexpr unsigned kMostNumbers = 3;
  std::size_t at = kRecordSize[header.point_format];
  for (std::size_t d = 0; d + kDescriptor <= descriptors.size(); d += kDescriptor) {
    const char* descriptor = descriptors.data() + d;
    const auto type = static_cast<unsigned char>(descriptor[2]);
    const auto options = static_cast<unsigned char>(descriptor[3]);
    if (type > kTypes * kMostNumbers || (type == 0 && options == 0)) break;
    const Type number = kDescribedTypes[type == 0 ? 0 : (type - 1) % kTypes];
    const std::size_t numbers = type == 0 ? options : (type - 1) / kTypes + 1;  // type 0: that many bytes without meaning
    if (numbers * size_of(number) > header.record_bytes - at) break;
    const std::string name = las_text(descriptors.substr(d + kLasNameAt, kLasNameBytes));
    for (std::size_t k = 0; k < numbers; ++k, at += size_of(number)) {
      if (type == 0) continue;
      header.fields.push_back({numbers == 1 ? name : name + "_" + std::to_string(k), number, at, steps_of(descriptor, k)});
    }
  }
  header.undescribed_bytes = header.record_bytes - at;
}

unsigned las_type_number(Type type) {
  for (unsigned i = 0; i < std::size(kDescribedTypes); ++i) {
    if (kDescribedTypes[i] == type) return i + 1;
  }
  return 0;
}

std::string las_descriptor(const std::string& name, unsigned type, std::size_t options) {
  std::string bytes(kDescriptor, '\0');
  bytes[2] = static_cast<char>(type);
  bytes[3] = static_cast<char>(options);
  bytes.replace(kLasNameAt, std::min(name.size(), kLasNameBytes), name, 0, kLasNameBytes);
  return bytes;
}

std::string las_extra_vlr(std::size_t length) {
  std::string bytes(kVlrHeader, '\0');
  bytes.replace(2, 9, "LASF_Spec");
  put(bytes, 18, static_cast<std::uint16_t>(kExtraBytes));
  put(bytes, 20, static_cast<std::uint16_t>(length));
  bytes.replace(22, 11, "Extra Bytes");
  return bytes;
}

}  // namespace g3r::io
