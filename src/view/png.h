// PNG files, written by libpng.
#pragma once

#include <cstdint>
#include <vector>

namespace g3r::view {

/// An 8 bit RGB image, rows from top to bottom, width * height * 3 bytes.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// The bytes of a PNG file. Throws Error if libpng fails.
std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace g3r::view
