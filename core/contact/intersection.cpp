#include "core/contact/intersection.hpp"

#include <algorithm>
#include <atomic>

#include "core/contact/chunks.hpp"

namespace bb {
namespace {

/// Six times the signed volume of the tetrahedron o a b c, m^3.
double volume(const Vec3d& o, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return (a - o).dot((b - o).cross(c - o));
}

}  // namespace

bool pierces(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double above = volume(p, a, b, c), below = volume(q, a, b, c);
  if (above * below > 0 || (above == 0 && below == 0)) return false;
  const double sides[] = {volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)};
  const auto [low, high] = std::minmax_element(std::begin(sides), std::end(sides));
  return *low >= 0 || *high <= 0;
}

bool any_intersection(const Surface& surface, const std::vector<IndexPair>& edge_triangle,
                      const PositionsView& x) {
  std::atomic<bool> found = false;
  for_each_chunk(edge_triangle.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !found.load(std::memory_order_relaxed); ++i) {
      const auto& edge = surface.edges.vertices[static_cast<std::size_t>(edge_triangle[i].first)];
      const auto& t = surface.triangles.vertices[static_cast<std::size_t>(edge_triangle[i].second)];
      if (pierces(x.col(edge[0]), x.col(edge[1]), x.col(t[0]), x.col(t[1]), x.col(t[2])))
        found.store(true, std::memory_order_relaxed);
    }
  });
  return found;
}

}  // namespace bb
