#include "baselines/near_pairs.h"

#include "cloud/neighbours.h"
#include "cpu/parallel.h"

#include <algorithm>

namespace g3r {

NearPairs near_pairs(const std::vector<Vec3>& points, double radius, const std::atomic<bool>* cancel) {
  const Neighbours neighbours(points);
  const std::size_t n = points.size();
  std::vector<std::vector<std::uint32_t>> found((n + parallel::kBlock - 1) / parallel::kBlock);
  NearPairs pairs;
  pairs.first.assign(n + 1, 0);
  parallel::for_blocks(
      n, parallel::kBlock,
      [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t>& here = found[begin / parallel::kBlock];
        std::vector<std::uint32_t> matches;
        for (std::size_t i = begin; i < end; ++i) {
          neighbours.within(points[i], radius, matches);
          here.insert(here.end(), matches.begin(), matches.end());
          pairs.first[i + 1] = matches.size();
        }
      },
      cancel);
  for (std::size_t i = 0; i < n; ++i) pairs.first[i + 1] += pairs.first[i];
  pairs.other.resize(pairs.first[n]);
  parallel::for_each(found.size(), [&](std::size_t block) {
    std::copy(found[block].begin(), found[block].end(),
              pairs.other.begin() + static_cast<std::ptrdiff_t>(pairs.first[block * parallel::kBlock]));
  });
  return pairs;
}

}  // namespace g3r
