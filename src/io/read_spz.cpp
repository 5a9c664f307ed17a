// SPZ, packed Gaussian splats: gzip around a header of 16 bytes and one block per attribute. Versions 2 and 3, which differ in how
// rotations are packed. Higher harmonics are not read. Source: Niantic Labs, github.com/nianticlabs/spz, README.md and load-spz.cc (format
// only).
#include "io/gzip.h"
#include "io/readers.h"
#include "io/splats.h"
#include "io/table.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace g3r::io {

namespace {

constexpr std::size_t kHeader = 16;  // "NGSP", version, points (u32), degree of harmonics, fraction bits, flags, 0 (u8)
constexpr unsigned kExtensions = 2;  // flag: records of vendors follow

// What unpacks to more than this many times the size of its file is refused. Splats shrink to two thirds or so; larger: more memory for
// hostile files.
constexpr std::uint64_t kMostRatio = 32;

constexpr std::array<const char*, 14> kNames = {"x",       "y",       "z",       "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
                                                "scale_0", "scale_1", "scale_2", "rot_0",  "rot_1",  "rot_2",  "rot_3"};

struct SpzHeader {
  unsigned version = 0;
  std::uint64_t points = 0;
  unsigned fraction_bits = 0;
  bool extensions = false;
  std::uint64_t harmonics = 0;  // bytes of a point
  [[nodiscard]] std::size_t rotation() const { return version == 2 ? 3 : 4; }
  // Position, opacity, colour, scale, rotation, harmonics.
  [[nodiscard]] std::uint64_t bytes() const { return points * (9 + 1 + 3 + 3 + rotation() + harmonics); }
};

SpzHeader read_header(const Source& source, Gunzip& stream) {
  const std::string bytes = stream.read(kHeader);
  if (bytes.size() < kHeader) fail(source, "truncated: an SPZ header has 16 bytes, found " + std::to_string(bytes.size()));
  const auto byte = [&](std::size_t at) { return static_cast<unsigned>(static_cast<unsigned char>(bytes[at])); };
  SpzHeader header;
  header.version = load<std::uint32_t>(bytes.data() + 4);
  header.points = load<std::uint32_t>(bytes.data() + 8);
  header.fraction_bits = byte(13);
  header.extensions = (byte(14) & kExtensions) != 0;
  const std::uint64_t degree = byte(12);
  header.harmonics = 3 * ((degree + 1) * (degree + 1) - 1);
  if (header.version != 2 && header.version != 3)
    fail(source, "expected SPZ version 2 or 3, found " + std::to_string(header.version) + "; save it as version 3 or as PLY");
  if (degree > 4) fail(source, "expected spherical harmonics of degree 0 to 4, found " + std::to_string(degree));
  if (header.fraction_bits > 24) fail(source, "expected at most 24 fraction bits, found " + std::to_string(header.fraction_bits));
  if (header.bytes() > kMostRatio * source.bytes.size()) {
    fail(source, std::to_string(header.points) + " splats in a file of " + std::to_string(source.bytes.size()) +
                     " bytes unpack to more than " + std::to_string(kMostRatio) +
                     " times its size: the count is damaged (too large), or they are all alike");
  }
  return header;
}

// 24 bits, two's complement.
double fixed_point(const unsigned char* bytes, double step) {
  const auto bits = static_cast<std::int32_t>(static_cast<std::uint32_t>(bytes[0]) << 8 | static_cast<std::uint32_t>(bytes[1]) << 16 |
                                              static_cast<std::uint32_t>(bytes[2]) << 24);
  return (bits >> 8) * step;
}

// w x y z of a unit quaternion, of which x y z are stored as -1..1; w is not negative.
std::array<double, 4> three_of_four(const unsigned char* bytes) {
  std::array<double, 4> q{};
  double rest = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    q[i + 1] = bytes[i] / 127.5 - 1;
    rest -= q[i + 1] * q[i + 1];
  }
  q[0] = std::sqrt(std::max(rest, 0.0));
  return q;
}

// The same, of which all but the largest are stored: in 32 bits its index (of x y z w), then sign and 9 bits of each, the last one lowest.
std::array<double, 4> smallest_three(const unsigned char* bytes) {
  constexpr double kHalf = 0.70710678118654752440;  // none but the largest exceeds sqrt(1/2)
  auto bits = load<std::uint32_t>(reinterpret_cast<const char*>(bytes));
  const std::size_t largest = bits >> 30;
  std::array<double, 4> xyzw{};
  double rest = 1;
  for (std::size_t i = 4; i-- > 0;) {
    if (i == largest) continue;
    const double size = kHalf * (bits & 511U) / 511;
    xyzw[i] = (bits >> 9 & 1U) != 0 ? -size : size;
    rest -= size * size;
    bits >>= 10;
  }
  xyzw[largest] = std::sqrt(std::max(rest, 0.0));
  return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

// The properties that a PLY of splats has, as float.
void append_splats(const SpzHeader& header, const std::string& blocks, Element& points) {
  const auto count = static_cast<std::size_t>(header.points);
  const auto* position = reinterpret_cast<const unsigned char*>(blocks.data());
  const unsigned char* opacity = position + 9 * count;
  const unsigned char* color = opacity + count;
  const unsigned char* scale = color + 3 * count;
  const unsigned char* rotation = scale + 3 * count;
  const double step = std::ldexp(1.0, -static_cast<int>(header.fraction_bits));
  points.data.resize(bytes_of(count, kNames.size() * sizeof(float)));
  char* to = points.data.data();
  const auto append = [&](double value) {
    store_double(Type::kFloat32, value, to);
    to += sizeof(float);
  };
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t a = 0; a < 3; ++a) append(fixed_point(position + 9 * i + 3 * a, step));
    for (std::size_t c = 0; c < 3; ++c) append((color[3 * i + c] / 255.0 - 0.5) / 0.15);
    const double alpha = std::clamp(static_cast<double>(opacity[i]), 0.5, 254.5) / 255;  // else infinite
    append(std::log(alpha / (1 - alpha)));
    for (std::size_t a = 0; a < 3; ++a) append(scale[3 * i + a] / 16.0 - 10);  // logarithm
    const unsigned char* packed = rotation + header.rotation() * i;
    for (const double q : header.version == 2 ? three_of_four(packed) : smallest_three(packed)) append(q);
  }
}

}  // namespace

Cloud read_spz(const Source& source, const ReadOptions& options) {
  Gunzip stream(source.bytes);
  const SpzHeader header = read_header(source, stream);
  const std::shared_ptr<Attributes> table = Attributes::of_points(Attributes::Dialect::kPly);
  Element& points = table->elements.back();
  points.count = header.points;
  for (const char* name : kNames) points.add(name, Type::kFloat32);
  Cloud cloud;
  {
    const std::string blocks = stream.read(static_cast<std::size_t>(header.bytes()));
    if (blocks.size() < header.bytes()) {
      fail(source, "truncated or damaged: " + std::to_string(header.points) + " splats take " + std::to_string(header.bytes()) +
                       " bytes, only " + std::to_string(blocks.size()) + " could be unpacked");
    }
    append_splats(header, blocks, points);
  }
  const bool more = !stream.read(1).empty();
  if (!more && !stream.ended()) fail(source, "truncated or damaged: the gzip stream does not end as it should (checksum)");
  if (more && !header.extensions) cloud.warnings.emplace_back("trailing bytes after the last splat are not used");
  cloud.format = "spz version " + std::to_string(header.version);
  fill_splat_cloud(source, table, options, cloud);
  return cloud;
}

}  // namespace g3r::io
