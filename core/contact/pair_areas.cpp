#include "core/contact/pair_areas.hpp"

#include <map>

#include "core/contact/obstacle_pair.hpp"
#include "core/geometry/pair.hpp"

namespace bb {

PairAreas::PairAreas(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles) {
  const auto at = [&surface](int v) { return Vec3d(surface.rest.col(v)); };
  std::vector<double> of_vertex(static_cast<std::size_t>(surface.rest.cols()), 0);
  std::map<std::array<int, 2>, double> of_edge;
  for (const std::array<int, 3>& t : surface.triangles.vertices) {
    const double area = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).norm() / 2;
    triangles_.push_back(area);
    for (std::size_t k = 0; k < 3; ++k) {
      of_vertex[static_cast<std::size_t>(t[k])] += area / 3;
      const int a = t[k], b = t[(k + 1) % 3];
      of_edge[{std::min(a, b), std::max(a, b)}] += area / 3;
    }
  }
  for (const std::array<int, 1>& p : surface.points.vertices) {
    points_.push_back(of_vertex[static_cast<std::size_t>(p[0])]);
    if (without_ < 0 && !(points_.back() > 0)) without_ = p[0];
  }
  for (const std::array<int, 2>& e : surface.edges.vertices) {
    const auto found = of_edge.find({std::min(e[0], e[1]), std::max(e[0], e[1])});
    edges_.push_back(found == of_edge.end() ? 0 : found->second);
    if (without_ < 0 && found == of_edge.end()) without_ = e[0];
  }
  for (const AnalyticSurface<double>& s : obstacles)
    line_.push_back(!is_convex(s) && is_line(s, surface.planar) ? 1 : 0);
}

double PairAreas::of(PairId pair) const {
  const int list = pair_list(pair), o = pair_obstacle(pair);
  const auto first = static_cast<std::size_t>(pair_first(pair)),
             second = static_cast<std::size_t>(pair_second(pair));
  if (o < 0) {
    const bool edges = list == static_cast<int>(PairKind::edge_edge);
    return (edges ? edges_[first] + edges_[second] : points_[first]) / 4;
  }
  const double half = line_[static_cast<std::size_t>(o)] != 0 ? 0.5 : 1;
  const auto& own = list == obstacle_pairs ? points_ : list == obstacle_pairs + 1 ? edges_ : triangles_;
  return half * own[first];
}

}  // namespace bb
