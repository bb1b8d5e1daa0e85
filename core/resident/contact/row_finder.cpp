#include "core/resident/contact/row_finder.hpp"

#include <limits>

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

double smallest_gap(const GapBits& bits) {
  constexpr Key none = ~Key{0};
  if (bits.most_negative != none) return -exec::from_ordered_bits(~bits.most_negative);
  if (bits.least_positive != none) return exec::from_ordered_bits(bits.least_positive);
  return std::numeric_limits<double>::infinity();
}

}  // namespace

RowFinder::RowFinder(exec::Executor& executor, const ResidentSurface& surface, bool mollifier)
    : executor_(executor),
      surface_(surface),
      mollifier_(mollifier),
      places_(executor, "narrow phase"),
      gap_(executor, "smallest gap", 1),
      found_(executor, "non-finite flag", 1) {}

bool RowFinder::finite(const exec::Buffer<double>& x) {
  found_.fill_zero();
  executor_.each(x.size(), FindNonFinite{x.data(), found_.data()});
  return executor_.counts_only() || found_.get(0) == 0;
}

void RowFinder::find(const exec::Buffer<double>& x, const ResidentCandidates& candidates,
                     ResidentRows& rows) {
  rows.list.resize(0);
  if (!finite(x)) {  // comparisons mean nothing then
    rows.resize(0);
    rows.min_gap = -std::numeric_limits<double>::infinity();
    return;
  }
  const NarrowPhase phase{surface_.view(), x.data(), mollifier_};
  std::uint8_t* const mark = places_.counts(n_candidates(candidates));
  Index first = 0;
  for_each_list(phase, candidates, [&]<class Rows>(const Rows& of, const exec::Buffer<Key>& list) {
    executor_.each(list.size(), MarkRows<Rows>{of, list.data(), mark + first});
    first += list.size();
  });

  rows.resize(places_.rank(expected_.rows));
  gap_.set(0, {~Key{0}, ~Key{0}});
  const RowView view = rows.view();
  first = 0;
  for_each_list(phase, candidates, [&]<class Rows>(const Rows& of, const exec::Buffer<Key>& list) {
    executor_.each(list.size(),
                   FillRows<Rows>{of, list.data(), mark + first, first, places_.places(), view, gap_.data()});
    first += list.size();
  });
  rows.min_gap =
      executor_.counts_only() ? std::numeric_limits<double>::infinity() : smallest_gap(gap_.get(0));
  list_mollified(rows);
}

void RowFinder::list_mollified(ResidentRows& rows) {
  if (!mollifier_ || rows.size() == 0) return;
  executor_.each(rows.size(), MarkMollified{rows.view().kind, places_.counts(rows.size())});
  places_.list(places_.rank(expected_.mollified), rows.list);
}

bool same_stencils(exec::Executor& executor, ResidentRows& a, ResidentRows& b) {
  if (a.size() != b.size() || executor.counts_only()) return false;
  exec::Buffer<std::uint32_t> found(executor, "stencil flag", 1);
  found.fill_zero();
  executor.each(a.size(), CompareStencils{a.view(), b.view(), found.data()});
  return found.get(0) == 0;
}

}  // namespace bb::resident
