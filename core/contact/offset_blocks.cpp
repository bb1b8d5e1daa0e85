#include "core/contact/offset_blocks.hpp"

#include <algorithm>

#include "core/contact/edge_end_row.hpp"

namespace bb {
namespace {

constexpr double border = 1e-9;      // sine of the angle by which a block reaches beyond its planes
constexpr double same_point = 1e-8;  // of the distance, between closest points that are one

/// The block of an edge of a flat mesh is a half-plane, which a tilted edge over it is never in: for edges, whose rows would
/// be those of the vertices otherwise, blocks of edges reach 30 degrees farther. Ours; the paper takes all pairs of insides.
constexpr double edges_border = 0.5;

/// Whether the cosine of a and b is at least -slack.
bool not_against(const Vec3d& a, const Vec3d& b, double slack = border) {
  return a.dot(b) >= -slack * a.norm() * b.norm();
}

/// From the closest point of the second side to that of the first, where the first has `vertex`, m.
Vec3d separation(const FoundRow& row, int vertex) {
  const Vec3d r = (row.d + row.offset) * row.normal;
  for (std::size_t k = 0; k < 4; ++k) {
    if (row.stencil[k] == vertex) return row.weight[k] < 0 ? Vec3d(-r) : r;
  }
  return r;
}

/// Whether `at` is beyond the plane through the edge across each of its triangles, or less than an angle with the sine
/// `slack` in front of it. That it lies between the ends of the edge is not tested: its closest point is inside.
bool beyond_triangles(const SurfaceTopology& topology, const PositionsView& x, const Vec3d& at,
                      const std::array<int, 2>& edge, double slack) {
  const Vec3d a = x.col(edge[0]), along = x.col(edge[1]) - a;
  const auto triangles = topology.triangles_at_edge.of(topology.edge_of(edge[0], edge[1]));
  return std::all_of(triangles.begin(), triangles.end(), [&](int t) {
    const std::array<int, 3>& corners = topology.surface.triangles.vertices[static_cast<std::size_t>(t)];
    const int opposite =
        *std::find_if(corners.begin(), corners.end(), [&](int v) { return v != edge[0] && v != edge[1]; });
    const Vec3d o = x.col(opposite), foot = a + along * (along.dot(o - a) / along.squaredNorm());
    Vec3d from = at - foot;
    from -= along * (along.dot(from) / along.squaredNorm());
    return not_against(from, foot - o, slack);
  });
}

}  // namespace

OffsetBlocks::OffsetBlocks(const Surface& surface) : surface_(surface), topology_(surface) {}

/// Beyond the plane across each edge of the vertex.
bool OffsetBlocks::in_vertex_block(const PositionsView& x, const Vec3d& at, int vertex) const {
  const Vec3d a = x.col(vertex), from = at - a;
  const auto edges = topology_.edges_at_point.of(point_of(vertex));
  return std::all_of(edges.begin(), edges.end(), [&](int e) {
    const std::array<int, 2>& ends = surface_.edges.vertices[static_cast<std::size_t>(e)];
    const int other = ends[0] == vertex ? ends[1] : ends[0];
    return not_against(from, a - x.col(other));
  });
}

bool OffsetBlocks::in_edge_block(const PositionsView& x, const Vec3d& at, int e0, int e1) const {
  return beyond_triangles(topology_, x, at, {e0, e1}, border);
}

/// The point is the first primitive of its pair; its rows follow one another.
bool OffsetBlocks::point_touches(const PositionsView& x, const PartRow& each) {
  const FoundRow& row = each.row;
  const PairId of = bb::pair_id(pair_list(each.pair), static_cast<PairId>(pair_first(each.pair)), 0);
  if (of != of_) touched_.clear();
  of_ = of;
  const int p = surface_.points.vertices[static_cast<std::size_t>(pair_first(each.pair))][0];
  const Vec3d at = x.col(p), touched = at - separation(row, p);
  if (row.kind == ContactKind::point_point) {
    if (!in_vertex_block(x, at, row.stencil[0] == p ? row.stencil[1] : row.stencil[0])) return false;
  } else if (row.kind == ContactKind::point_edge) {
    if (!in_edge_block(x, at, row.stencil[1], row.stencil[2])) return false;
  }
  const double near = same_point * (row.d + row.offset);
  const auto is_same = [&](const Vec3d& other) { return (other - touched).norm() <= near; };
  if (std::any_of(touched_.begin(), touched_.end(), is_same)) return false;
  touched_.push_back(touched);
  return true;
}

/// Insides of two edges: the closest point of each is in the block of the other. Two ends are the business of points. The inside of an edge and an end count once, whatever edges end there.
bool OffsetBlocks::edge_touches(const PositionsView& x, const PartRow& each) {
  const FoundRow& row = each.row;
  if (row.kind == ContactKind::edge_edge) {
    const auto at = [&](std::size_t k) { return Vec3d(row.weight[k] * x.col(row.stencil[k])); };
    const Vec3d of_first = at(0) + at(1), of_second = -(at(2) + at(3));
    const auto in_block = [&](const Vec3d& point, std::size_t k) {
      return beyond_triangles(topology_, x, point, {row.stencil[k], row.stencil[k + 1]}, edges_border);
    };
    return in_block(of_first, 2) && in_block(of_second, 0);
  }
  if (row.kind == ContactKind::point_point) return false;
  const int vertex = row.stencil[0];
  const int first = pair_first(each.pair), second = pair_second(each.pair);
  const std::array<int, 2>& ends = surface_.edges.vertices[static_cast<std::size_t>(first)];
  const int edge = vertex == ends[0] || vertex == ends[1] ? second : first;
  return in_vertex_block(x, Vec3d(x.col(vertex) - separation(row, vertex)), vertex) &&
         at_edge_.insert({edge, vertex}).second;
}

void OffsetBlocks::apply(const PositionsView& x, bool mollifier, std::span<RowPart> parts) {
  of_ = ~PairId{0};
  touched_.clear();
  at_edge_.clear();
  for (RowPart& part : parts) {
    for (PartRow& each : part.rows) {
      const int list = pair_list(each.pair);
      if (list >= obstacle_pairs) continue;
      const bool edges = list == static_cast<int>(PairKind::edge_edge);
      each.share = (edges ? edge_touches(x, each) : point_touches(x, each)) ? 1 : 0;
      if (!edges || !mollifier || each.share == 0 || each.row.kind != ContactKind::edge_edge) continue;
      const std::array<int, 4> vertex =
          edge_pair_vertices(surface_, pair_first(each.pair), pair_second(each.pair));
      const double eps = mollifier_threshold_at<double>(surface_, vertex.data(), gather(x, vertex));
      if (eps == 0) continue;
      PartRow mollified = each;
      mollified.row.eps = eps;
      part.mollified.push_back(mollified);
      each.share = 0;
    }
  }
}

}  // namespace bb
