#include "core/resident/contact/row_finder.hpp"

#include <limits>

#include "core/resident/sums/resident_sum.hpp"

namespace bb::resident {
namespace {

/// f(rows, list) of every list of candidates; rows: what its kernels ask.
template <class F>
void for_each_list(const NarrowPhase& phase, const ResidentCandidates& c, const F& f) {
  f(SurfaceRows<PairKind::point_point>{phase}, c.point_point);
  f(SurfaceRows<PairKind::point_edge>{phase}, c.point_edge);
  f(SurfaceRows<PairKind::point_triangle>{phase}, c.point_triangle);
  f(SurfaceRows<PairKind::edge_edge>{phase}, c.edge_edge);
  f(ObstacleRows<1>{phase}, c.obstacle);
  f(ObstacleRows<2>{phase}, c.obstacle_edge);
  f(ObstacleRows<3>{phase}, c.obstacle_triangle);
}

Index n_candidates(const ResidentCandidates& c) {
  return c.point_point.size() + c.point_edge.size() + c.point_triangle.size() + c.edge_edge.size() +
         c.obstacle.size() + c.obstacle_edge.size() + c.obstacle_triangle.size();
}

}  // namespace

RowFinder::RowFinder(exec::Executor& executor, const ResidentSurface& surface, bool mollifier)
    : executor_(executor),
      surface_(surface),
      mollifier_(mollifier),
      places_(executor, "narrow phase"),
      numbers_(executor, "numbers of rows", 1) {}

void RowFinder::find(const exec::Buffer<double>& x, const ResidentCandidates& candidates,
                     ResidentRows& rows) {
  rows.list.resize(0);
  numbers_.fill_zero();
  executor_.each(x.size(), FindNonFinite{x.data(), &numbers_.data()->not_finite});
  const NarrowPhase phase{surface_.view(), x.data(), mollifier_};
  std::uint8_t* const mark = places_.counts(n_candidates(candidates));
  Index first = 0;
  for_each_list(phase, candidates, [&]<class Rows>(const Rows& of, const exec::Buffer<Key>& list) {
    executor_.each(list.size(), MarkRows<Rows>{of, list.data(), mark + first});
    first += list.size();
  });
  places_.rank_to(&numbers_.data()->rows);
  RowNumbers numbers{0, 0, expected_.rows, ~Key{0}, expected_.mollified};
  if (!executor_.counts_only()) numbers = numbers_.get(0);
  if (numbers.not_finite != 0) {  // comparisons mean nothing then
    rows.resize(0);
    rows.min_gap = -std::numeric_limits<double>::infinity();
    return;
  }
  rows.resize(numbers.rows);
  const RowView view = rows.view();
  first = 0;
  for_each_list(phase, candidates, [&]<class Rows>(const Rows& of, const exec::Buffer<Key>& list) {
    executor_.each(list.size(), FillRows<Rows>{of, list.data(), mark + first, first, places_.places(), view});
    first += list.size();
  });
  measure(rows);
}

/// The smallest gap, and which rows are mollified.
void RowFinder::measure(ResidentRows& rows) {
  rows.min_gap = std::numeric_limits<double>::infinity();
  if (rows.size() == 0) return;
  Key* const least = &numbers_.data()->least_gap;
  const Index n = rows.size(), items = items_a_block(n);
  executor_.fill_bytes(least, 0xff, sizeof(Key));
  executor_.blocks((n + items - 1) / items, LeastKey<RowGaps>{{rows.view().d}, n, least});
  if (mollifier_) {
    executor_.each(n, MarkMollified{rows.view().kind, places_.counts(n)});
    places_.rank_to(&numbers_.data()->mollified);
  }
  RowNumbers numbers{0, 0, 0, ~Key{0}, expected_.mollified};
  if (!executor_.counts_only()) numbers = numbers_.get(0);
  if (numbers.least_gap != ~Key{0}) rows.min_gap = from_smallest_key(numbers.least_gap);
  if (mollifier_) places_.list(numbers.mollified, rows.list);
}

bool RowFinder::same_stencils(ResidentRows& a, ResidentRows& b) {
  if (a.size() != b.size() || executor_.counts_only()) return false;
  numbers_.fill_zero();
  executor_.each(a.size(), CompareStencils{a.view(), b.view(), &numbers_.data()->not_finite});
  return numbers_.get(0).not_finite == 0;
}

}  // namespace bb::resident
