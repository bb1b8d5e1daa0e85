#include "core/resident/contact/resident_broad_phase.hpp"

#include <bit>

#include "core/resident/contact/candidate_kernels.hpp"
#include "core/resident/contact/compaction.hpp"

namespace bb::resident {

namespace {

template <std::size_t N>
void upload_rows(exec::Buffer<int>& to, const std::vector<std::array<int, N>>& rows) {
  to.upload({rows.empty() ? nullptr : rows[0].data(), N * rows.size()});
}

/// The edges that pair with vertices in space.
Primitives<2> lone_primitives(const Surface& surface, const ContactPlan& plan) {
  Primitives<2> out;
  if (!plan.point_edge) return out;
  for (const int e : surface.lone_edges) {
    const auto i = static_cast<std::size_t>(e);
    out.vertices.push_back(surface.edges.vertices[i]);
    out.side.push_back(surface.edges.side[i]);
    out.free.push_back(surface.edges.free[i]);
  }
  return out;
}

}  // namespace

ResidentBroadPhase::ResidentBroadPhase(exec::Executor& executor, const ResidentSurface& resident,
                                       const Surface& surface, const ContactPlan& plan)
    : executor_(executor),
      surface_(resident),
      plan_(plan),
      connected_(executor, "connected vertices"),
      opposite_(executor, "corners opposite to edges"),
      frame_(executor, "frame of motion", 1),
      sample_(executor, "sampled coordinates"),
      scratch_(executor),
      points_(executor, "tree of points"),
      edges_(executor, "tree of edges"),
      triangles_(executor, "tree of triangles"),
      lone_(executor, "lone edges", lone_primitives(surface, plan)),
      edge_of_(executor, "numbers of lone edges"),
      lone_edges_(executor, "tree of lone edges"),
      point_points_(executor, "point-point"),
      point_edges_(executor, "point-edge"),
      point_triangles_(executor, "point-triangle"),
      edge_edges_(executor, "edge-edge"),
      obstacle_points_(executor, "obstacle"),
      obstacle_edges_(executor, "obstacle-edge"),
      obstacle_triangles_(executor, "obstacle-triangle"),
      total_(executor, "numbers of candidates", 1) {
  if (plan.point_point) upload_rows(connected_, surface.connected_pairs());
  if (plan.point_edge) upload_rows(opposite_, surface.opposite_corners());
  if (lone_.free.size() > 0) edge_of_.upload(surface.lone_edges);
}

/// The frame in which the boxes are shortest: what most points share of the motion is taken off. As BroadPhase does.
void ResidentBroadPhase::find_frame(const Column& x0, const Column& x1) {
  const PrimitiveView<1> points = surface_.view().points;
  if (points.n == 0) return frame_.fill_zero();
  const int n = n_sampled(points.n);
  sample_.resize(3 * most_sampled);
  for (int c = 0; c < 3; ++c) {
    Key* const key = sample_.data() + most_sampled * c;
    executor_.each(n, SampleKeys{points.vertex, points.n, x0.data(), c, key});
    executor_.sort(key, nullptr, n, 64);
  }
  executor_.each(1, FoldFrame{sample_.data(), n, surface_.element_size(), frame_.data()});
  if (x0.data() != x1.data()) {
    scratch_.key.resize(points.n);
    for (int c = 0; c < 3; ++c) {
      Key* const key = scratch_.key.data();
      executor_.each(points.n, DisplacementKeys{points.vertex, x0.data(), x1.data(), c, key});
      executor_.sort(key, nullptr, points.n, 64);
      executor_.each(1, MoveFrame{key, points.n, c, frame_.data()});
    }
  }
}

void ResidentBroadPhase::fit(const Column& x0, const Column& x1) {
  if (!plan_.broad_phase.needed) return;
  find_frame(x0, x1);
  const SurfaceView s = surface_.view();
  const MotionView motion{x0.data(), x1.data(), frame_.data()};
  if (plan_.point_point || plan_.point_edge || plan_.point_triangle) points_.fit(s.points, motion, scratch_);
  const bool lone = lone_.free.size() > 0;
  if ((plan_.point_edge && !lone) || plan_.edge_edge) edges_.fit(s.edges, motion, scratch_);
  if (lone) lone_edges_.fit(lone_.view(), motion, scratch_);
  if (plan_.point_triangle) triangles_.fit(s.triangles, motion, scratch_);
}

template <PairKind K>
PairSearch ResidentBroadPhase::search() const {
  const TreeView points = points_.view(), edges = edges_.view(), triangles = triangles_.view();
  const bool lone = K == PairKind::point_edge && lone_.free.size() > 0;
  return {K == PairKind::edge_edge ? edges : points,
          K == PairKind::point_point      ? points
          : K == PairKind::point_triangle ? triangles
          : lone                          ? lone_edges_.view()
                                          : edges,
          surface_.view(),
          {connected_.data(), connected_.size() / 2},
          {opposite_.data(), opposite_.size() / 3},
          x0_,
          x1_,
          lone ? edge_of_.data() : nullptr};
}

CandidateSource ResidentBroadPhase::source() const {
  CandidateSource out{search<PairKind::point_point>(), search<PairKind::point_edge>(),
                      search<PairKind::point_triangle>(), search<PairKind::edge_edge>(),
                      plan_.obstacles.needed};
  const auto only = [](bool needed, PairSearch& s) {
    if (!needed) s.first.top = s.second.top = -1;
  };
  only(plan_.point_point, out.point_point);
  only(plan_.point_edge, out.point_edge);
  only(plan_.point_triangle, out.point_triangle);
  only(plan_.edge_edge, out.edge_edge);
  return out;
}

/// From counts [n] to places [n + 1]; the last is their number, which is read with those of all kinds.
void ResidentBroadPhase::sum_up(Found& found) {
  const Index n = found.begin.size() - 1;
  scan_counts(executor_, found.begin.data(), n);
  executor_.copy(reinterpret_cast<Index*>(total_.data()) + n_counted_, found.begin.data() + n, sizeof(Index));
}

template <PairKind K>
void ResidentBroadPhase::count_kind(bool needed, Found& found) {
  if (needed) {
    const PairSearch s = search<K>();
    const Index n = s.first.top < 0 ? 0 : s.first.size(0);
    found.begin.resize(n + 1), found.held.resize(pairs_held * n);
    executor_.each(n, CountPairs<K>{s, found.begin.data(), found.held.data(), n});
    sum_up(found);
  }
  ++n_counted_;
}

template <int N>
void ResidentBroadPhase::count_obstacles(Found& found) {
  if (plan_.obstacles.needed) {
    const SurfaceView s = surface_.view();
    const Index n = s.primitives<N>().n;
    found.begin.resize(n + 1);
    executor_.each(n, CountObstacles<N>{s, x0_, x1_, found.begin.data()});
    sum_up(found);
  }
  ++n_counted_;
}

template <int N>
void ResidentBroadPhase::fill_obstacles(const Found& found, Index total, exec::Buffer<Key>& out) {
  out.grow(plan_.obstacles.needed ? total : 0);
  if (!plan_.obstacles.needed || total == 0) return;
  const SurfaceView s = surface_.view();
  executor_.each(s.primitives<N>().n, FillObstacles<N>{s, x0_, x1_, found.begin.data(), out.data()});
}

CandidateCounts ResidentBroadPhase::count(const Column& x0, const Column& x1) {
  static_assert(sizeof(CandidateCounts) == 7 * sizeof(Index), "one number a kind");
  x0_ = x0.data();
  x1_ = x1.data();
  fit(x0, x1);
  n_counted_ = 0;  // in the order of CandidateCounts
  total_.fill_zero();
  count_kind<PairKind::point_point>(plan_.point_point, point_points_);
  count_kind<PairKind::point_edge>(plan_.point_edge, point_edges_);
  count_kind<PairKind::point_triangle>(plan_.point_triangle, point_triangles_);
  count_kind<PairKind::edge_edge>(plan_.edge_edge, edge_edges_);
  count_obstacles<1>(obstacle_points_);
  count_obstacles<2>(obstacle_edges_);
  count_obstacles<3>(obstacle_triangles_);
  if (!executor_.counts_only()) counts_ = total_.get(0);
  return counts_;
}

template <PairKind K>
void ResidentBroadPhase::fill_kind(bool needed, const Found& found, Index total, exec::Buffer<Key>& out) {
  room_ ? out.grow(needed ? total : 0) : out.resize(needed ? total : 0);
  if (!needed || total == 0) return;
  const PairSearch s = search<K>();
  const Index n = s.first.size(0);
  executor_.each(n, FillPairs<K>{s, found.begin.data(), found.held.data(), n, out.data()});
  const auto bits = std::bit_width(static_cast<Key>(n - 1));
  executor_.sort(out.data(), nullptr, total, 32 + static_cast<int>(bits));
}

void ResidentBroadPhase::fill(ResidentCandidates& out) {
  fill_kind<PairKind::point_point>(plan_.point_point, point_points_, counts_.point_point, out.point_point);
  fill_kind<PairKind::point_edge>(plan_.point_edge, point_edges_, counts_.point_edge, out.point_edge);
  fill_kind<PairKind::point_triangle>(plan_.point_triangle, point_triangles_, counts_.point_triangle,
                                      out.point_triangle);
  fill_kind<PairKind::edge_edge>(plan_.edge_edge, edge_edges_, counts_.edge_edge, out.edge_edge);
  fill_obstacles<1>(obstacle_points_, counts_.obstacle, out.obstacle);
  fill_obstacles<2>(obstacle_edges_, counts_.obstacle_edge, out.obstacle_edge);
  fill_obstacles<3>(obstacle_triangles_, counts_.obstacle_triangle, out.obstacle_triangle);
}

void ResidentBroadPhase::free() {
  points_.free(), edges_.free(), triangles_.free(), lone_edges_.free();
  scratch_.key.free(), scratch_.order.free();
  for (Found* found : {&point_points_, &point_edges_, &point_triangles_, &edge_edges_, &obstacle_points_,
                       &obstacle_edges_, &obstacle_triangles_}) {
    found->free();
  }
}

void ResidentBroadPhase::update(const Column& x0, const Column& x1, ResidentCandidates& out) {
  count(x0, x1);
  fill(out);
}

}  // namespace bb::resident
