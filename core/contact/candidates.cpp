#include "core/contact/candidates.hpp"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/contact/chunks.hpp"
#include "core/contact/float_rounding.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/rest_rule.hpp"

namespace bb {

namespace {
/// Vertex 0 of contact_pair<K>(), and that with which its second primitive begins.
template <PairKind K>
std::array<int, 2> first_vertices(const Surface& s, IndexPair pair) {
  const auto begin = [](const auto& primitives, int i) {
    return primitives.vertices[static_cast<std::size_t>(i)][0];
  };
  if constexpr (K == PairKind::point_point)
    return {begin(s.points, pair.first), begin(s.points, pair.second)};
  if constexpr (K == PairKind::point_edge) return {begin(s.points, pair.first), begin(s.edges, pair.second)};
  if constexpr (K == PairKind::point_triangle)
    return {begin(s.points, pair.first), begin(s.triangles, pair.second)};
  if constexpr (K == PairKind::edge_edge) return {begin(s.edges, pair.first), begin(s.edges, pair.second)};
}
}  // namespace

BroadPhase::BroadPhase(const Surface& surface, std::vector<AnalyticSurface<double>> obstacles,
                       const ContactPlan& plan, Precision precision)
    : surface_(surface),
      obstacles_(std::move(obstacles)),
      plan_(plan),
      chosen_(surface.collisions.chosen()),
      tests_states_(surface.collisions.has(CollisionKind::static_test)),
      precision_(precision) {
  points_.needed = plan.point_point || plan.point_edge || plan.point_triangle;
  edges_.needed = plan.point_edge || plan.edge_edge || tests_states_;
  triangles_.needed = plan.point_triangle || tests_states_;
  lone_edges_.needed = plan.point_edge && !surface.planar;
  for (const int e : surface.lone_edges)
    lone_free_.push_back(surface.edges.free[static_cast<std::size_t>(e)]);
}

/// of(vertex) of the sampled points, sorted, into sample_; NaNs are left out.
template <class Number>
std::vector<double>& BroadPhase::sample(int c, const Number& of) {
  const auto n = static_cast<long long>(surface_.points.size());
  std::vector<double>& out = sample_[c];
  out.clear();
  for (int k = 0; k < n_sampled(n); ++k) {
    const double x = of(surface_.points.vertices[static_cast<std::size_t>(sampled(k, n))][0]);
    if (std::isfinite(x)) out.push_back(x);
  }
  std::sort(out.begin(), out.end());
  return out;
}

FoldedFrame BroadPhase::folded(const PositionsView& x0) {
  for (int c = 0; c < 3; ++c) sample(c, [&](int v) { return x0(c, v); });
  // a float state far away is rounded by more than what is left of the empty stretch before it
  constexpr double never = std::numeric_limits<double>::infinity();
  return folded_frame([this](int c, int i) { return sample_[c][static_cast<std::size_t>(i)]; },
                      [this](int c) { return static_cast<int>(sample_[c].size()); },
                      values_in_float(precision_) ? never : surface_.element_size);
}

/// The frame in which the boxes are shortest: without what the sampled points share of the motion; all of it where one of
/// their displacements is NaN.
BroadPhase::Frame BroadPhase::frame(const PositionsView& x0, const PositionsView& x1) {
  Frame out{folded(x0), Vec3d::Zero()};
  if (x0.data() == x1.data() || pace_ == Pace::own || surface_.points.size() == 0) return out;
  for (int c = 0; c < 3; ++c) {
    const std::vector<double>& moved = sample(c, [&](int v) { return x1(c, v) - x0(c, v); });
    const int n = static_cast<int>(moved.size());
    if (n < n_sampled(static_cast<long long>(surface_.points.size()))) continue;
    out.moved[c] = median_of([&moved](int i) { return moved[static_cast<std::size_t>(i)]; }, n);
  }
  return out;
}

void BroadPhase::fit_vertices(const PositionsView& x0, const PositionsView& x1, const Frame& frame) {
  const std::size_t n = static_cast<std::size_t>(x0.cols());
  vertices_.resize(n);
  const auto place = [&](const Vec3d& x) {
    return Vec3d(frame.folded.axis[0](x[0]), frame.folded.axis[1](x[1]), frame.folded.axis[2](x[2]));
  };
  for_each_chunk(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int v = static_cast<int>(i);
      const Vec3d p0 = x0.col(v), p1 = x1.col(v);
      // a TreeBox knows the ulps of what it holds; x itself is larger by what is taken off, and rounded accordingly
      Vec3d margin;
      for (int c = 0; c < 3; ++c) margin[c] = place_rounding(p0[c], p1[c], frame.moved[c]);
      if (values_in_float(precision_)) {
        const double largest = std::max(p0.lpNorm<Eigen::Infinity>(), p1.lpNorm<Eigen::Infinity>());
        margin.array() += distance_rounding(precision_, largest);
      }
      TreeBox box;
      box.add(place(p0), margin);
      if (x0.data() != x1.data()) box.add(place(Vec3d(p1 - frame.moved)), margin);
      vertices_[i] = box;
    }
  });
}

template <int N>
void BroadPhase::fit(Tree& tree, const Primitives<N>& primitives) const {
  if (!tree.needed) return;
  tree.boxes.resize(primitives.size());
  tree.reach.resize(primitives.size());
  for_each_chunk(primitives.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      TreeBox box;
      for (int v : primitives.vertices[i]) box.add(vertices_[static_cast<std::size_t>(v)]);
      const double reach = primitives.side[i].d_hat / 2 + primitives.side[i].offset;
      box.inflate(reach);
      tree.boxes[i] = box;
      tree.reach[i] = float_above(reach);
    }
  });
  tree.bvh.update(tree.boxes, primitives.free, tree.reach);
}

void BroadPhase::fit_edges() {
  fit(edges_, surface_.edges);
  if (!lone_edges_.needed) return;
  lone_edges_.boxes.clear(), lone_edges_.reach.clear();
  for (const int e : surface_.lone_edges) {
    lone_edges_.boxes.push_back(edges_.boxes[static_cast<std::size_t>(e)]);
    lone_edges_.reach.push_back(edges_.reach[static_cast<std::size_t>(e)]);
  }
  lone_edges_.bvh.update(lone_edges_.boxes, lone_free_, lone_edges_.reach);
}

/// Pairs of kind K: may_pair says which there are, second_of what a primitive of b is in the surface.
template <PairKind K, class Second, class MayPair>
void BroadPhase::find(const Bvh& a, const Bvh& b, const PositionsView& x0, const PositionsView& x1,
                      const Second& second_of, const MayPair& may_pair, std::vector<IndexPair>& out) {
  const double eps = value_epsilon(precision_);
  finder_.find(
      a, b,
      [&](IndexPair p) {
        p.second = second_of(p.second);
        if (!may_pair(p)) return false;
        const auto [v, w] = first_vertices<K>(surface_, p);
        if (chosen_ && surface_.kind_of(v, w) == CollisionKind::off) return false;
        if (!surface_.ruled_at_rest(v, w)) return true;
        const ContactPair<K> pair = contact_pair<K>(surface_, p);
        return !apart_by_rest_rule<K>(pair.law, bb::gather(surface_.rest, pair.vertex),
                                      bb::gather(x0, pair.vertex), bb::gather(x1, pair.vertex), eps,
                                      pace_ == Pace::common);
      },
      out);
}

/// Of any distance on the motion, m; 0 in double, where the states are not read.
double BroadPhase::state_rounding(const PositionsView& x0, const PositionsView& x1) const {
  if (!values_in_float(precision_) || x0.size() == 0) return 0;
  return distance_rounding(precision_, std::max(x0.cwiseAbs().maxCoeff(), x1.cwiseAbs().maxCoeff()));
}

void BroadPhase::update(const PositionsView& x0, const PositionsView& x1, Candidates& out, Pace pace) {
  pace_ = pace;
  const Surface& s = surface_;
  if (plan_.broad_phase.needed) {
    // Which pairs come close depends on relative motion alone: what most points share, a fall say, would only
    // make every box long.
    const Frame moving = frame(x0, x1);
    fit_vertices(x0, x1, moving);
    tbb::parallel_invoke([&] { fit_edges(); }, [&] { fit(triangles_, s.triangles); },
                         [&] { fit(points_, s.points); });
  }
  for_each_obstacle_list(s, out, [&]<int N>(const Primitives<N>& of, std::vector<IndexPair>& pairs) {
    update_obstacles<N>(of, x0, x1, pairs);
  });
  find_pairs(x0, x1, out);
  if (tests_states_ && plan_.broad_phase.needed) find_intersections(out);
}

void BroadPhase::find_intersections(Candidates& out) {
  const Surface& s = surface_;
  finder_.find(
      edges_.bvh, triangles_.bvh,
      [&s](IndexPair p) {
        const auto& edge = s.edges.vertices[static_cast<std::size_t>(p.first)];
        const auto& triangle = s.triangles.vertices[static_cast<std::size_t>(p.second)];
        return s.kind_of(edge[0], triangle[0]) == CollisionKind::static_test &&
               s.disjoint(edge[0], triangle) && s.disjoint(edge[1], triangle);
      },
      out.edge_triangle);
}

/// Of surface primitives, from the trees.
void BroadPhase::find_pairs(const PositionsView& x0, const PositionsView& x1, Candidates& out) {
  const Surface& s = surface_;
  const auto point = [&s](int i) { return s.points.vertices[static_cast<std::size_t>(i)][0]; };
  const auto edge = [&s](int i) { return s.edges.vertices[static_cast<std::size_t>(i)]; };
  const auto triangle = [&s](int i) { return s.triangles.vertices[static_cast<std::size_t>(i)]; };

  const auto same = [](int i) { return i; };
  if (plan_.point_point) {
    find<PairKind::point_point>(
        points_.bvh, points_.bvh, x0, x1, same,
        [&](IndexPair p) { return !s.connected(point(p.first), point(p.second)); }, out.point_point);
  }
  if (lone_edges_.needed) {
    const auto lone = [&s](int i) { return s.lone_edges[static_cast<std::size_t>(i)]; };
    find<PairKind::point_edge>(
        points_.bvh, lone_edges_.bvh, x0, x1, lone,
        [&](IndexPair p) { return Surface::disjoint(point(p.first), edge(p.second)); }, out.point_edge);
    for (IndexPair& p : out.point_edge)
      p.second = lone(p.second);  // ascending, so that the list stays sorted
  } else if (plan_.point_edge) {
    find<PairKind::point_edge>(
        points_.bvh, edges_.bvh, x0, x1, same,
        [&](IndexPair p) { return !s.adjacent(point(p.first), edge(p.second)); }, out.point_edge);
  }
  if (plan_.point_triangle) {
    find<PairKind::point_triangle>(
        points_.bvh, triangles_.bvh, x0, x1, same,
        [&](IndexPair p) { return s.disjoint(point(p.first), triangle(p.second)); }, out.point_triangle);
  }
  if (plan_.edge_edge) {
    find<PairKind::edge_edge>(
        edges_.bvh, edges_.bvh, x0, x1, same,
        [&](IndexPair p) { return s.disjoint(edge(p.first), edge(p.second)); }, out.edge_edge);
  }
}

/// Every primitive is queried about every obstacle that it makes pairs with.
template <int N>
void BroadPhase::update_obstacles(const Primitives<N>& primitives, const PositionsView& x0,
                                  const PositionsView& x1, std::vector<IndexPair>& out) {
  out.clear();
  if (!plan_.obstacles.needed) return;
  const double of_states = state_rounding(x0, x1);
  pose(obstacles_, x0, first_poses_);
  pose(obstacles_, x1, last_poses_);
  if (near_obstacles_.size() < n_chunks(primitives.size()))
    near_obstacles_.resize(n_chunks(primitives.size()));
  for_each_chunk(primitives.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::vector<IndexPair>& near = near_obstacles_[chunk];
    near.clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (!primitives.free[i]) continue;
      for (std::size_t o = 0; o < obstacles_.size(); ++o) {
        const AnalyticSurface<double>&obstacle = first_poses_[o], &last = last_poses_[o];
        // with a pace of its own the obstacle is taken where it begins, and comes nearer by its whole way at most
        const bool together = pace_ == Pace::common;
        const double way = together ? 0 : (last.point - obstacle.point).norm();
        if (!pairs_with<N>(obstacle, surface_.planar, primitives.lone[i] != 0)) continue;
        if (chosen_ &&
            surface_.kind_at_obstacle(primitives.vertices[i][0], static_cast<int>(o)) == CollisionKind::off)
          continue;
        const double reach = primitives.side[i].d_hat + primitives.side[i].offset + of_states + way +
                             distance_rounding(precision_, std::max(obstacle.point.cwiseAbs().maxCoeff(),
                                                                    last.point.cwiseAbs().maxCoeff()) +
                                                               obstacle.radius);
        const auto& vertex = primitives.vertices[i];
        if (may_reach<N>(obstacle, together ? last : obstacle, gather(x0, vertex), gather(x1, vertex), reach))
          near.push_back({static_cast<int>(i), static_cast<int>(o)});
      }
    }
  });
  for (std::size_t chunk = 0; chunk < n_chunks(primitives.size()); ++chunk)
    out.insert(out.end(), near_obstacles_[chunk].begin(), near_obstacles_[chunk].end());
}

void select_kinds(const Surface& surface, const Candidates& all, CollisionKinds kinds, Candidates& out) {
  const auto copy = [kinds](const std::vector<IndexPair>& from, std::vector<IndexPair>& to,
                            const auto& kind) {
    to.clear();
    std::copy_if(from.begin(), from.end(), std::back_inserter(to),
                 [&](IndexPair pair) { return kinds.has(kind(pair)); });
  };
  const auto first_of = [](const auto& primitives, int i) {
    return primitives.vertices[static_cast<std::size_t>(i)][0];
  };
  const auto between = [&](const auto& a, const auto& b) {
    return [&surface, &first_of, first = &a, second = &b](IndexPair p) {
      return surface.kind_of(first_of(*first, p.first), first_of(*second, p.second));
    };
  };
  const auto at_obstacle = [&](const auto& primitives) {
    return [&surface, &first_of, of = &primitives](IndexPair p) {
      return surface.kind_at_obstacle(first_of(*of, p.first), p.second);
    };
  };
  copy(all.point_point, out.point_point, between(surface.points, surface.points));
  copy(all.point_edge, out.point_edge, between(surface.points, surface.edges));
  copy(all.point_triangle, out.point_triangle, between(surface.points, surface.triangles));
  copy(all.edge_edge, out.edge_edge, between(surface.edges, surface.edges));
  copy(all.obstacle, out.obstacle, at_obstacle(surface.points));
  copy(all.obstacle_edge, out.obstacle_edge, at_obstacle(surface.edges));
  copy(all.obstacle_triangle, out.obstacle_triangle, at_obstacle(surface.triangles));
}

}  // namespace bb
