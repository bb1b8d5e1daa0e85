// Construction: sort by the Morton code of the box centres, then unite bottom up.
#include "core/audit/box_tree.hpp"

#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

#include "core/math/parallel.hpp"

namespace bb::audit {
namespace {

/// Every third bit of the result holds the 21 low bits of v.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffffULL;
  v = (v | v << 16) & 0x001f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

std::uint64_t morton(const Vec3d& centre, const Box& world, const Vec3d& scale) {
  std::uint64_t code = 0;
  for (int k = 0; k < 3; ++k) {
    const double cell = std::min(std::max((centre[k] - world.lo[k]) * scale[k], 0.0), 2097151.0);
    code |= spread(static_cast<std::uint64_t>(cell)) << k;
  }
  return code;
}

}  // namespace

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(boxes.size()), order_(boxes.size()) {
  const std::size_t n = boxes.size();
  Box world;
  for (const Box& b : boxes) world.add(b);
  Vec3d scale = Vec3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const double extent = world.hi[k] - world.lo[k];
    if (extent > 0.0) scale[k] = std::min(2097152.0 / extent, 1e300);
  }
  std::vector<std::pair<std::uint64_t, int>> keys(n);
  parallel_items(n, 1, [&](std::size_t i) {
    const Vec3d centre = 0.5 * boxes[i].lo + 0.5 * boxes[i].hi;
    keys[i] = {morton(centre, world, scale), static_cast<int>(i)};
  });
  tbb::parallel_sort(keys.begin(), keys.end());

  const std::size_t n_groups = std::max<std::size_t>(1, (n + leaf_size - 1) / leaf_size);
  n_leaves_ = static_cast<int>(std::bit_ceil(n_groups));
  nodes_.resize(2 * static_cast<std::size_t>(n_leaves_));
  for (std::size_t i = 0; i < n; ++i) {
    order_[i] = keys[i].second;
    boxes_[i] = boxes[static_cast<std::size_t>(keys[i].second)];
    nodes_[static_cast<std::size_t>(n_leaves_) + i / leaf_size].add(boxes_[i]);
  }
  for (std::size_t i = static_cast<std::size_t>(n_leaves_); i-- > 1;) {
    nodes_[i] = nodes_[2 * i];
    nodes_[i].add(nodes_[2 * i + 1]);
  }
}

}  // namespace bb::audit
