// Which rows stay of the contact model offset_geometric (docs/theory/contact-models.md, Offset geometric contact).
#pragma once

#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/contact/found_rows.hpp"
#include "core/contact/surface_topology.hpp"

namespace bb {

/// What pairs have a row. points: obstacles act on the vertices of surfaces alone, and surfaces not on each other; of the others all
/// pairs with an obstacle have one.
enum class ContactModel { all_pairs, offset_geometric, points };

/// The space within d_hat of a surface is cut into blocks, one a feature: over the inside of a triangle, round the inside of
/// an edge between the planes of its ends and beyond those of its triangles, round a vertex beyond the planes of its edges.
/// A point touches a feature in whose block it is, an edge a vertex in whose block its closest point is, and two edges each
/// other, where the closest points are inside of both and each is in the block of the other edge, which reaches 30 degrees
/// farther then. Each of these counts once, and what is shadowed by a neighbour of
/// the feature not at all. Source: Chen et al. 2025, Offset Geometric Contact, sections on the blocks of vertices, edges
/// and triangles, and their algorithms for contacts of a vertex and of an edge.
///
/// A block holds its border: 1e-9 of an angle beyond it belongs to it still, so that no contact falls between two blocks;
/// of rows of one point with closest points that are nearer to each other than that, the first stays.
class OffsetBlocks {
 public:
  explicit OffsetBlocks(const Surface& surface);

  /// parts: all rows of the state x in the order of their pairs, found without a mollifier. Those that are outside of their
  /// blocks get a share of 0; with `mollifier` those of two edges close to parallel become mollified rows.
  void apply(const PositionsView& x, bool mollifier, std::span<RowPart> parts);

 private:
  bool in_vertex_block(const PositionsView& x, const Vec3d& at, int vertex) const;
  bool in_edge_block(const PositionsView& x, const Vec3d& at, int e0, int e1) const;
  bool point_touches(const PositionsView& x, const PartRow& each);
  bool edge_touches(const PositionsView& x, const PartRow& each);
  int point_of(int vertex) const { return topology_.points[static_cast<std::size_t>(vertex)]; }

  const Surface& surface_;
  const SurfaceTopology topology_;
  PairId of_ = 0;                          // list and point whose rows are being read
  std::vector<Vec3d> touched_;             // closest points of the rows of it that stay
  std::set<std::pair<int, int>> at_edge_;  // (edge, vertex) that have a row
};

}  // namespace bb
