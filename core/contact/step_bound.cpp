#include "core/contact/step_bound.hpp"

#include "core/contact/chunks.hpp"
#include "core/contact/contact_row.hpp"
#include "core/contact/pair_motion.hpp"

namespace bb {
namespace {

/// The earlier bound limits; on a tie the first in the order of the candidates. Counters add up.
void combine_bounds(StepBound& into, const StepBound& next) {
  if (next.alpha < into.alpha) {
    into.alpha = next.alpha;
    into.kind = next.kind;
    into.key = next.key;
  }
  into.queries += next.queries;
  into.probes += next.probes;
  into.capped += next.capped;
  into.zero += next.zero;
}

/// What all pairs share.
struct Query {
  const Surface& surface;
  const std::vector<AnalyticSurface<double>>& obstacles;
  const Positions &x0, &x1;
  const StopLevel& level;

  template <PairKind K>
  void bound_pair(IndexPair index, StepBound& out) const {
    const ContactPair<K> pair = contact_pair<K>(surface, index);
    const auto p0 = gather(x0, pair.vertex), p1 = gather(x1, pair.vertex);
    const double park = level.park * pair.law.d_hat;
    if (proven_apart<K>(p0, p1, pair.law.offset, park)) return;
    const AccdResult<double> r = pair_toi<K>(p0, p1, pair.law.offset, park, level.max_probes);
    const double toi = r.hit ? r.toi : 1;
    combine_bounds(out, {toi, contact_kind<K>(), pair_key(pair.vertex), 1, r.probes, r.capped, toi == 0});
  }

  void bound_obstacle(IndexPair index, StepBound& out) const {
    const std::size_t i = static_cast<std::size_t>(index.first);
    const int v = surface.points.vertices[i][0];
    const Side law = surface.points.side[i];
    const double toi = obstacle_toi(obstacles[static_cast<std::size_t>(index.second)], x0.col(v), x1.col(v),
                                    law.offset, level.park * law.d_hat);
    combine_bounds(out, {toi, ContactKind::obstacle, obstacle_key(index.second, v), 0, 0, 0, toi == 0});
  }
};

}  // namespace

StepBound find_step_bound(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles,
                          const Candidates& candidates, const Positions& x0, const Positions& x1,
                          const StopLevel& level) {
  const Query query{surface, obstacles, x0, x1, level};
  StepBound bound;
  const auto reduce = [&](const StepBound& part) { combine_bounds(bound, part); };
  for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    over_chunks<StepBound>(
        pairs, [&](IndexPair pair, StepBound& out) { query.bound_pair<K>(pair, out); }, reduce);
  });
  over_chunks<StepBound>(
      candidates.obstacle, [&](IndexPair pair, StepBound& out) { query.bound_obstacle(pair, out); }, reduce);
  return bound;
}

}  // namespace bb
