// Which primitives of a surface meet: sides of triangles, what is at an edge and at a point. Indices are those of Surface.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/contact/surface.hpp"

namespace bb {

/// Lists of numbers, one for each of n things.
class IndexLists {
 public:
  /// members: pairs (thing, number), in the order in which a thing has its numbers.
  IndexLists(std::size_t n, const std::vector<std::array<int, 2>>& members);
  std::span<const int> of(int thing) const {
    const auto i = static_cast<std::size_t>(thing);
    return {&items_[begin_[i]], begin_[i + 1] - begin_[i]};
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<int> items_;
};

/// The surface has to outlive it.
struct SurfaceTopology {
  explicit SurfaceTopology(const Surface& surface);

  /// The edge with these ends, which is there.
  int edge_of(int v, int w) const;

  const Surface& surface;
  std::vector<int> points;                          // of the vertices, -1 where there is none
  std::vector<std::array<int, 3>> triangle_edges;   // of t0 t1, t1 t2, t2 t0
  std::vector<std::array<int, 3>> triangle_points;  // its corners in the list of points
  std::vector<std::array<int, 2>> edge_points;
  IndexLists triangles_at_edge, triangles_at_point, edges_at_point;  // ascending
};

}  // namespace bb
