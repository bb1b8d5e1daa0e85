#include "core/contact/candidates.hpp"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/chunks.hpp"
#include "core/contact/float_rounding.hpp"
#include "core/contact/obstacle_pair.hpp"

namespace bb {

namespace {
/// Median of x1 - x0 over all points, a coordinate at a time: the frame in which the boxes are shortest. 0
/// where that is not finite. `moved`: a buffer.
Vec3d common_motion(const Primitives<1>& points, const Positions& x0, const Positions& x1,
                    std::vector<double>& moved) {
  Vec3d out = Vec3d::Zero();
  if (points.size() == 0) return out;
  moved.resize(points.size());
  const auto middle = moved.begin() + static_cast<std::ptrdiff_t>(moved.size() / 2);
  for (int c = 0; c < 3; ++c) {
    std::transform(points.vertices.begin(), points.vertices.end(), moved.begin(),
                   [&](const std::array<int, 1>& v) { return x1(c, v[0]) - x0(c, v[0]); });
    if (!std::all_of(moved.begin(), moved.end(), [](double m) { return std::isfinite(m); })) continue;
    std::nth_element(moved.begin(), middle, moved.end());
    out[c] = *middle;
  }
  return out;
}
}  // namespace

BroadPhase::BroadPhase(const Surface& surface, std::vector<AnalyticSurface<double>> obstacles,
                       const ContactPlan& plan, Precision precision)
    : surface_(surface), obstacles_(std::move(obstacles)), plan_(plan), precision_(precision) {
  points_.needed = plan.point_point || plan.point_edge || plan.point_triangle;
  edges_.needed = plan.point_edge || plan.edge_edge;
  triangles_.needed = plan.point_triangle;
}

/// The origin of a frame is a point of the scene: floats are finest near it.
BroadPhase::Frame BroadPhase::frame(const Positions& x0, const Positions& x1) {
  if (surface_.points.size() == 0) return {Vec3d::Zero(), Vec3d::Zero()};
  Vec3d origin = x0.col(surface_.points.vertices[0][0]);
  if (!origin.allFinite()) origin.setZero();
  if (x0.data() == x1.data()) return {origin, origin};
  return {origin, origin + common_motion(surface_.points, x0, x1, moved_)};
}

void BroadPhase::fit_vertices(const Positions& x0, const Positions& x1, const Frame& frame) {
  const std::size_t n = static_cast<std::size_t>(x0.cols());
  vertices_.resize(n);
  for_each_chunk(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int v = static_cast<int>(i);
      TreeBox box;
      box.add(Vec3d(x0.col(v) - frame.start));
      if (x0.data() != x1.data()) box.add(Vec3d(x1.col(v) - frame.end));
      vertices_[i] = box;
    }
  });
}

template <int N>
void BroadPhase::fit(Tree& tree, const Primitives<N>& primitives, double rounding) const {
  if (!tree.needed) return;
  tree.boxes.resize(primitives.size());
  for_each_chunk(primitives.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      TreeBox box;
      for (int v : primitives.vertices[i]) box.add(vertices_[static_cast<std::size_t>(v)]);
      box.inflate(primitives.side[i].d_hat / 2 + primitives.side[i].offset + rounding);
      tree.boxes[i] = box;
    }
  });
  tree.bvh.update(tree.boxes, primitives.free);
}

/// Of any distance on the motion, m; 0 in double, where nothing is asked of the states.
double BroadPhase::state_rounding(const Positions& x0, const Positions& x1) const {
  if (!values_in_float(precision_) || x0.size() == 0) return 0;
  return distance_rounding(precision_, std::max(x0.cwiseAbs().maxCoeff(), x1.cwiseAbs().maxCoeff()));
}

void BroadPhase::update(const Positions& x0, const Positions& x1, Candidates& out) {
  const Surface& s = surface_;
  if (plan_.broad_phase.needed) {
    // Which pairs come close depends on relative motion alone: what most points share, a fall say, would only
    // make every box long.
    const Frame moving = frame(x0, x1);
    fit_vertices(x0, x1, moving);
    // a TreeBox knows the ulps of what it holds; x itself is larger by up to the frame, and rounded accordingly
    const double frames = moving.start.lpNorm<Eigen::Infinity>() + moving.end.lpNorm<Eigen::Infinity>();
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * frames + state_rounding(x0, x1) / 2;
    tbb::parallel_invoke([&] { fit(edges_, s.edges, rounding); },
                         [&] { fit(triangles_, s.triangles, rounding); },
                         [&] { fit(points_, s.points, rounding); });
  }
  for_each_obstacle_list(s, out, [&]<int N>(const Primitives<N>& of, std::vector<IndexPair>& pairs) {
    update_obstacles<N>(of, x0, x1, pairs);
  });
  const auto point = [&s](int i) { return s.points.vertices[static_cast<std::size_t>(i)][0]; };
  const auto edge = [&s](int i) { return s.edges.vertices[static_cast<std::size_t>(i)]; };
  const auto triangle = [&s](int i) { return s.triangles.vertices[static_cast<std::size_t>(i)]; };

  if (plan_.point_point) {
    finder_.find(
        points_.bvh, points_.bvh, [&](IndexPair p) { return !s.connected(point(p.first), point(p.second)); },
        out.point_point);
  }
  if (plan_.point_edge) {
    finder_.find(
        points_.bvh, edges_.bvh, [&](IndexPair p) { return !s.adjacent(point(p.first), edge(p.second)); },
        out.point_edge);
  }
  if (plan_.point_triangle) {
    finder_.find(
        points_.bvh, triangles_.bvh,
        [&](IndexPair p) { return s.disjoint(point(p.first), triangle(p.second)); }, out.point_triangle);
  }
  if (plan_.edge_edge) {
    finder_.find(
        edges_.bvh, edges_.bvh, [&](IndexPair p) { return s.disjoint(edge(p.first), edge(p.second)); },
        out.edge_edge);
  }
}

/// Every primitive is asked about every obstacle that it makes pairs with.
template <int N>
void BroadPhase::update_obstacles(const Primitives<N>& primitives, const Positions& x0, const Positions& x1,
                                  std::vector<IndexPair>& out) {
  out.clear();
  if (!plan_.obstacles.needed) return;
  const double of_states = state_rounding(x0, x1);
  if (near_obstacles_.size() < n_chunks(primitives.size()))
    near_obstacles_.resize(n_chunks(primitives.size()));
  for_each_chunk(primitives.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::vector<IndexPair>& near = near_obstacles_[chunk];
    near.clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (!primitives.free[i]) continue;
      for (std::size_t o = 0; o < obstacles_.size(); ++o) {
        const AnalyticSurface<double>& obstacle = obstacles_[o];
        if (!pairs_with<N>(obstacle, surface_.planar, primitives.lone[i] != 0)) continue;
        const double reach =
            primitives.side[i].d_hat + primitives.side[i].offset + of_states +
            distance_rounding(precision_, obstacle.point.cwiseAbs().maxCoeff() + obstacle.radius);
        const auto& vertex = primitives.vertices[i];
        if (may_reach<N>(obstacle, gather(x0, vertex), gather(x1, vertex), reach))
          near.push_back({static_cast<int>(i), static_cast<int>(o)});
      }
    }
  });
  for (std::size_t chunk = 0; chunk < n_chunks(primitives.size()); ++chunk)
    out.insert(out.end(), near_obstacles_[chunk].begin(), near_obstacles_[chunk].end());
}

}  // namespace bb
