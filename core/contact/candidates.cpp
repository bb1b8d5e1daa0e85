#include "core/contact/candidates.hpp"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/chunks.hpp"
#include "core/contact/float_rounding.hpp"

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
  update_obstacles(x0, x1, out.obstacle);
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

void BroadPhase::update_obstacles(const Positions& x0, const Positions& x1, std::vector<IndexPair>& out) {
  out.clear();
  if (!plan_.obstacles.needed) return;
  const double of_states = state_rounding(x0, x1);
  for (std::size_t i = 0; i < surface_.points.size(); ++i) {
    if (!surface_.points.free[i]) continue;
    const int v = surface_.points.vertices[i][0];
    const Side side = surface_.points.side[i];
    const Vec3d p0 = x0.col(v), p1 = x1.col(v);
    for (std::size_t o = 0; o < obstacles_.size(); ++o) {
      // the gap falls by at most the way gone: a bound for any obstacle; 1e-12 covers rounding
      const double start = surface_gap<double>(obstacles_[o], p0).d;
      const double least = start - (p1 - p0).norm() - 1e-12 * (std::abs(start) + (p1 - p0).norm());
      const double rounding =
          of_states +
          distance_rounding(precision_, obstacles_[o].point.cwiseAbs().maxCoeff() + obstacles_[o].radius);
      if (!(least > side.d_hat + side.offset + rounding))
        out.push_back({static_cast<int>(i), static_cast<int>(o)});
    }
  }
}

}  // namespace bb
