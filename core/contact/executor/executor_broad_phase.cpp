#include "core/contact/executor/executor_broad_phase.hpp"

#include <array>
#include <bit>

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

std::array<Buffer<Key>*, n_candidate_lists> lists_of(ExecutorCandidates& c) {
  return {&c.point_point, &c.point_edge,    &c.point_triangle,   &c.edge_edge,
          &c.obstacle,    &c.obstacle_edge, &c.obstacle_triangle};
}
std::array<Index, n_candidate_lists> numbers_of(const CandidateCounts& c) {
  return {c.point_point, c.point_edge,    c.point_triangle,   c.edge_edge,
          c.obstacle,    c.obstacle_edge, c.obstacle_triangle};
}
Index room_of(const Buffer<Key>& list) { return static_cast<Index>(list.bytes() / sizeof(Key)); }

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
      held_(executor, "held pairs"),
      n_held_(executor, "held pairs"),
      next_(executor, "held pairs"),
      total_(executor),
      unfinished_(executor) {
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
  x0_ = x0.data();
  x1_ = x1.data();
  if (!plan_.broad_phase.needed) return;
  find_frame(x0, x1);
  const SurfaceView s = surface_.view();
  TreeSources of{s.points, s.edges, s.triangles, lone_.view(), {}, {x0.data(), x1.data(), frame_.data()}};
  const bool lone = lone_.free.size() > 0;
  if (!(plan_.point_point || plan_.point_edge || plan_.point_triangle)) of.points.n = 0;
  if (!((plan_.point_edge && !lone) || plan_.edge_edge)) of.edges.n = 0;
  if (!plan_.point_triangle) of.triangles.n = 0;
  // nothing is held until the trees stand, and a leaf's places are longer than its code
  constexpr Index numbers_of_a_code = sizeof(Key) / sizeof(std::uint32_t);
  held_.resize(numbers_of_a_code * BoxTrees::size(of));
  trees_.fit(of, reinterpret_cast<Key*>(held_.data()));
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
          {lone ? edge_of_.data() : nullptr, one_tree<K>},
          surface_.view(),
          {connected_.data(), connected_.size() / 2},
          {opposite_.data(), opposite_.size() / 3},
          x0_,
          x1_};
}

CandidateSource ExecutorBroadPhase::source() const {
  CandidateSource out{search<PairKind::point_point>(), search<PairKind::point_edge>(),
                      search<PairKind::point_triangle>(), search<PairKind::edge_edge>(),
                      plan_.obstacles.needed};
  const auto only = [](bool needed, PairSearch& s) {
    if (!needed) s.first.n = s.second.n = 0;
  };
  only(plan_.point_point, out.point_point);
  only(plan_.point_edge, out.point_edge);
  only(plan_.point_triangle, out.point_triangle);
  only(plan_.edge_edge, out.edge_edge);
  return out;
}

Askers ExecutorBroadPhase::askers(const CandidateSource& from, int round) const {
  const SurfaceView s = surface_.view();
  Askers out{{}, round, 0, s.n_obstacles};
  const Index obstacle_items[] = {s.points.n, s.edges.n, s.triangles.n};
  const PairSearch* const search[] = {&from.point_point, &from.point_edge, &from.point_triangle,
                                      &from.edge_edge};
  for (int k = 0; k < n_candidate_lists; ++k) {
    Index n = 0;
    if (k >= first_obstacle_list) {
      n = from.obstacles ? obstacle_items[k - first_obstacle_list] : 0;
    } else if (search[k]->second.n > 0) {
      n = search[k]->first.n;
    }
    out.begin[k + 1] = out.begin[k] + n;
  }
  out.each = places_each_ > 0 ? places_each_ : places_of_an_item(out.leaves());
  return out;
}

HeldPairs ExecutorBroadPhase::held() { return {held_.data(), n_held_.data(), next_.data()}; }

/// The lists get memory for what was counted last; `next`: before the next count, which may find more. @return whether what they
/// hold is still there
bool ExecutorBroadPhase::size_lists(ExecutorCandidates& out, bool next) const {
  const auto list = lists_of(out);
  const auto count = numbers_of(counts_);
  bool kept = true;
  for (std::size_t k = 0; k < n_candidate_lists; ++k) {
    const bool room = room_ || k >= first_obstacle_list;
    kept = kept && count[k] <= room_of(*list[k]);
    room ? list[k]->grow(count[k]) : list[k]->resize(count[k] + (next ? count[k] / 32 : 0));
  }
  return kept;
}

/// Puts the candidates that a round has found into the lists, as far as these are long enough.
void ExecutorBroadPhase::put(const CandidateSource& from, const Askers& askers, ExecutorCandidates& out) {
  const PairSearch* const search[] = {&from.point_point, &from.point_edge, &from.point_triangle,
                                      &from.edge_edge};
  FillCandidates fill{{askers, held()}, places_.places(), askers.round > 0 ? totals() : nullptr, {}};
  const auto list = lists_of(out);
  for (std::size_t k = 0; k < n_candidate_lists; ++k) {
    fill.to[k].list = list[k]->data();
    fill.to[k].room = room_of(*list[k]);
    if (k < first_obstacle_list) fill.to[k].first = search[k]->first, fill.to[k].leaves = search[k]->leaves;
  }
  executor_.each(askers.items(), fill);
}

/// One round: walks, rules, places, lists, counts.
void ExecutorBroadPhase::look(const CandidateSource& from, const Askers& askers, ExecutorCandidates& out) {
  const auto walk = [](const PairSearch& s) { return WalkTrees::Walk{s.first, s.second, s.leaves}; };
  unfinished_.fill(0);
  executor_.each(askers.leaves(), WalkTrees{askers,
                                            {walk(from.point_point), walk(from.point_edge),
                                             walk(from.point_triangle), walk(from.edge_edge)},
                                            held(),
                                            unfinished_.to_write()});
  executor_.each(askers.places(),
                 KeepCandidates{askers,
                                {from.point_point, from.point_edge, from.point_triangle, from.edge_edge},
                                x0_,
                                x1_,
                                held()});
  places_.rank_by(askers.items(), HeldCandidates{askers, held()});
  put(from, askers, out);
  executor_.each(n_candidate_lists,
                 CandidateTotals{askers, places_.places(), places_.sum_on_executor(), totals()});
}

void ExecutorBroadPhase::search(ExecutorCandidates& out) {
  const CandidateSource from = source();
  const Askers first = askers(from, 0);
  held_.resize(first.places()), n_held_.resize(first.leaves()), next_.resize(first.leaves());
  rounds_ = 0;
  for (bool on = true; on;) {
    const Askers asked = askers(from, rounds_++);
    look(from, asked, out);
    const bool more = from.obstacles && asked.n_obstacles > rounds_ * asked.each;
    on = !executor_.counts_only() && (unfinished_.get() != 0 || more);
  }
  if (!executor_.counts_only()) counts_ = total_.get();
}

CandidateCounts ExecutorBroadPhase::count(const PositionsView& x0, const PositionsView& x1,
                                          ExecutorCandidates& out, std::size_t most) {
  static_assert(sizeof(CandidateCounts) == n_candidate_lists * sizeof(Index), "one number a list");
  fit(x0, x1);
  if (counts_.bytes() <= most) size_lists(out, true);
  search(out);
  return counts_;
}

void ExecutorBroadPhase::fill(ExecutorCandidates& out) {
  if (!size_lists(out, false)) {
    const CandidateSource from = source();
    rounds_ == 1 ? put(from, askers(from, 0), out) : search(out);
  }
  const Askers items = askers(source(), 0);
  const auto list = lists_of(out);
  for (int k = 0; k < first_obstacle_list; ++k) {  // leaves are in the order of their tree
    Buffer<Key>& pairs = *list[static_cast<std::size_t>(k)];
    if (pairs.size() == 0) continue;
    const auto bits = std::bit_width(static_cast<Key>(items.size(k) - 1));
    executor_.sort(pairs.data(), nullptr, pairs.size(), 32 + static_cast<int>(bits));
  }
}

void ExecutorBroadPhase::free() {
  trees_.free();
  places_.free(), held_.free(), n_held_.free(), next_.free();
}

void ExecutorBroadPhase::update(const PositionsView& x0, const PositionsView& x1, ExecutorCandidates& out) {
  count(x0, x1, out);
  fill(out);
}

}  // namespace bb::exec
