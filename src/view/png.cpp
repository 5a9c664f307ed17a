#include "view/png.h"

#include <g3r/error.h>

#include <string>

#include <png.h>

namespace g3r::view {

std::vector<std::uint8_t> encode_png(const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<std::uint8_t> bytes(size);
  const int ok = png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr);
  const std::string message = header.message;
  png_image_free(&header);
  if (ok == 0) throw Error("png: " + message);
  bytes.resize(size);
  return bytes;
}

}  // namespace g3r::view
