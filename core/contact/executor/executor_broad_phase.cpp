#include "core/contact/executor/executor_broad_phase.hpp"

#include <algorithm>
#include <bit>

#include "core/exec/sums/compaction.hpp"

namespace bb::exec {

namespace {

template <std::size_t N>
void upload_rows(Buffer<int>& to, const std::vector<std::array<int, N>>& rows) {
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

ExecutorBroadPhase::ExecutorBroadPhase(Executor& executor, const ExecutorSurface& on_executor,
                                       const Surface& surface, const ContactPlan& plan)
    : executor_(executor),
      surface_(on_executor),
      plan_(plan),
      connected_(executor, "connected vertices"),
      opposite_(executor, "corners opposite to edges"),
      frame_(executor, "frame of motion", 1),
      trees_(executor),
      lone_(executor, "lone edges", lone_primitives(surface, plan)),
      edge_of_(executor, "numbers of lone edges"),
      places_(executor, "places of candidates"),
      held_(executor, "held candidates"),
      total_(executor) {
  if (plan.point_point) upload_rows(connected_, surface.connected_pairs());
  if (plan.point_edge) upload_rows(opposite_, surface.opposite_corners());
  if (lone_.free.size() > 0) edge_of_.upload(surface.lone_edges);
}

/// The frame in which the boxes are shortest: what most points share of the motion is taken off. As BroadPhase does.
void ExecutorBroadPhase::find_frame(const PositionsView& x0, const PositionsView& x1) {
  const PrimitiveView<1> points = surface_.view().points;
  if (points.n == 0) return frame_.fill_zero();
  executor_.blocks(
      1, FindFrame{points.vertex, points.n, x0.data(), x1.data(), surface_.element_size(), frame_.data()});
}

void ExecutorBroadPhase::fit(const PositionsView& x0, const PositionsView& x1) {
  if (!plan_.broad_phase.needed) return;
  find_frame(x0, x1);
  const SurfaceView s = surface_.view();
  TreeSources of{s.points, s.edges, s.triangles, lone_.view(), {}, {x0.data(), x1.data(), frame_.data()}};
  const bool lone = lone_.free.size() > 0;
  if (!(plan_.point_point || plan_.point_edge || plan_.point_triangle)) of.points.n = 0;
  if (!((plan_.point_edge && !lone) || plan_.edge_edge)) of.edges.n = 0;
  if (!plan_.point_triangle) of.triangles.n = 0;
  trees_.fit(of);
}

template <PairKind K>
PairSearch ExecutorBroadPhase::search() const {
  const TreeView points = trees_.view(0), edges = trees_.view(1), triangles = trees_.view(2);
  const bool lone = K == PairKind::point_edge && lone_.free.size() > 0;
  return {K == PairKind::edge_edge ? edges : points,
          K == PairKind::point_point      ? points
          : K == PairKind::point_triangle ? triangles
          : lone                          ? trees_.view(3)
                                          : edges,
          surface_.view(),
          {connected_.data(), connected_.size() / 2},
          {opposite_.data(), opposite_.size() / 3},
          x0_,
          x1_,
          lone ? edge_of_.data() : nullptr};
}

CandidateSource ExecutorBroadPhase::source() const {
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

Askers ExecutorBroadPhase::askers() const {
  const CandidateSource from = source();
  const SurfaceView s = surface_.view();
  Askers out{{from.point_point, from.point_edge, from.point_triangle, from.edge_edge}, x0_, x1_, {}};
  const Index obstacle_items[] = {s.points.n, s.edges.n, s.triangles.n};
  for (int k = 0; k < n_candidate_lists; ++k) {
    Index n = 0;
    if (k >= first_obstacle_list) {
      n = from.obstacles ? obstacle_items[k - first_obstacle_list] : 0;
    } else if (out.search[k].first.top >= 0 && out.search[k].second.top >= 0) {
      n = out.search[k].first.size(0);
    }
    out.begin[k + 1] = out.begin[k] + n;
  }
  return out;
}

CandidateCounts ExecutorBroadPhase::count(const PositionsView& x0, const PositionsView& x1) {
  static_assert(sizeof(CandidateCounts) == n_candidate_lists * sizeof(Index), "one number a list");
  x0_ = x0.data();
  x1_ = x1.data();
  fit(x0, x1);
  const Askers from = askers();
  const Index n = from.begin[n_candidate_lists];
  places_.resize(n + 1), held_.resize(pairs_held * from.begin[first_obstacle_list]);
  executor_.each(n, CountCandidates{from, places_.data(), held_.data()});
  scan_counts(executor_, places_.data(), n);
  CandidateTotals totals{places_.data(), {}, reinterpret_cast<Index*>(total_.to_write())};
  std::copy(std::begin(from.begin), std::end(from.begin), totals.begin);
  executor_.each(n_candidate_lists, totals);
  if (!executor_.counts_only()) counts_ = total_.get();
  return counts_;
}

void ExecutorBroadPhase::fill(ExecutorCandidates& out) {
  Buffer<Key>* const list[] = {&out.point_point, &out.point_edge,    &out.point_triangle,   &out.edge_edge,
                               &out.obstacle,    &out.obstacle_edge, &out.obstacle_triangle};
  const Index count[] = {counts_.point_point,      counts_.point_edge, counts_.point_triangle,
                         counts_.edge_edge,        counts_.obstacle,   counts_.obstacle_edge,
                         counts_.obstacle_triangle};
  FillCandidates to{askers(), places_.data(), held_.data(), {}};
  for (int k = 0; k < n_candidate_lists; ++k) {
    const bool room = room_ || k >= first_obstacle_list;
    room ? list[k]->grow(count[k]) : list[k]->resize(count[k]);
    to.list[k] = list[k]->data();
  }
  if (counts_.total() == 0) return;
  executor_.each(to.askers.begin[n_candidate_lists], to);
  for (int k = 0; k < first_obstacle_list; ++k) {  // leaves are in the order of their tree
    if (count[k] == 0) continue;
    const auto bits = std::bit_width(static_cast<Key>(to.askers.size(k) - 1));
    executor_.sort(list[k]->data(), nullptr, count[k], 32 + static_cast<int>(bits));
  }
}

void ExecutorBroadPhase::free() {
  trees_.free();
  places_.free(), held_.free();
}

void ExecutorBroadPhase::update(const PositionsView& x0, const PositionsView& x1, ExecutorCandidates& out) {
  count(x0, x1);
  fill(out);
}

}  // namespace bb::exec
