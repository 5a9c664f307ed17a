#include "cloud/morton.h"

#include "cpu/parallel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

namespace g3r {
namespace {

// Ones in groups of so many bits, each group at three times the place that it would have without gaps.
constexpr std::uint64_t groups_of(int bits) {
  std::uint64_t groups = 0;
  for (int at = 0; at < std::numeric_limits<std::uint64_t>::digits; at += 3 * bits) groups |= ((std::uint64_t{1} << bits) - 1) << at;
  return groups;
}

// The bits of v, which are in groups of 2 kBits with gaps of twice that, in groups of one.
template <int kBits>
std::uint64_t move_apart(std::uint64_t v) {
  constexpr std::uint64_t kGroups = groups_of(kBits);
  v = (v | v << (2 * kBits)) & kGroups;
  if constexpr (kBits == 1) {
    return v;
  } else {
    return move_apart<kBits / 2>(v);
  }
}

struct Keyed {
  std::uint64_t code;
  std::uint32_t index;
};

// Least-significant-digit radix sort, stable; blocks of fixed size keep it the same for any number of threads.
void radix_sort(std::vector<Keyed>& items) {
  constexpr int kBits = std::numeric_limits<std::uint8_t>::digits;
  constexpr std::size_t kDigits = std::size_t{1} << kBits;
  const std::size_t n = items.size();
  const std::size_t blocks = (n + parallel::kBlock - 1) / parallel::kBlock;
  std::vector<Keyed> other(n);
  std::vector<std::array<std::uint32_t, kDigits>> offset(blocks);
  for (int shift = 0; shift < std::numeric_limits<std::uint64_t>::digits; shift += kBits) {
    const auto digit = [shift](const Keyed& item) { return static_cast<std::size_t>(static_cast<std::uint8_t>(item.code >> shift)); };
    parallel::for_blocks(n, parallel::kBlock, [&](std::size_t begin, std::size_t end) {
      auto& count = offset[begin / parallel::kBlock];
      count.fill(0);
      for (std::size_t i = begin; i < end; ++i) ++count[digit(items[i])];
    });
    std::uint32_t total = 0;
    bool one_digit = false;
    for (std::size_t d = 0; d < kDigits; ++d) {
      const std::uint32_t before = total;
      for (auto& count : offset) {
        const std::uint32_t c = count[d];
        count[d] = total;
        total += c;
      }
      one_digit = one_digit || total - before == n;
    }
    if (one_digit) continue;
    parallel::for_blocks(n, parallel::kBlock, [&](std::size_t begin, std::size_t end) {
      auto& next = offset[begin / parallel::kBlock];
      for (std::size_t i = begin; i < end; ++i) other[next[digit(items[i])]++] = items[i];
    });
    items.swap(other);
  }
}

}  // namespace

std::uint64_t spread_bits(std::uint64_t v) {
  constexpr std::uint64_t kGrid = (std::uint64_t{1} << kGridBits) - 1;
  return move_apart<static_cast<int>(std::bit_floor(unsigned{kGridBits}))>(v & kGrid);
}

std::uint64_t morton_code(const Vec3& unit) {
  constexpr double kCells = static_cast<double>(1 << kGridBits);
  std::uint64_t code = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double cell = std::floor((unit[a] + 1) * (kCells / 2));
    const auto clamped = static_cast<std::uint64_t>(std::clamp(cell, 0.0, kCells - 1));
    code |= spread_bits(clamped) << (2 - a);
  }
  return code;
}

std::vector<std::uint64_t> morton_codes(const std::vector<Vec3>& unit_points) {
  std::vector<std::uint64_t> codes(unit_points.size());
  parallel::for_all(codes.size(), [&](std::size_t i) { codes[i] = morton_code(unit_points[i]); });
  return codes;
}

std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& unit_points) {
  const std::size_t n = unit_points.size();
  std::vector<Keyed> items(n);
  parallel::for_blocks(n, parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) items[i] = {morton_code(unit_points[i]), static_cast<std::uint32_t>(i)};
  });
  radix_sort(items);
  for (std::size_t begin = 0; begin < n;) {  // ties: by coordinates, then (equal points) by index
    std::size_t end = begin + 1;
    while (end < n && items[end].code == items[begin].code) ++end;
    if (end - begin > 1) {
      std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin), items.begin() + static_cast<std::ptrdiff_t>(end),
                [&](const Keyed& a, const Keyed& b) {
                  if (unit_points[a.index] != unit_points[b.index]) return unit_points[a.index] < unit_points[b.index];
                  return a.index < b.index;
                });
    }
    begin = end;
  }
  std::vector<std::uint32_t> order(n);
  parallel::for_all(n, [&](std::size_t i) { order[i] = items[i].index; });
  return order;
}

}  // namespace g3r
