#include "core/contact/overlap.hpp"

#include "core/contact/chunks.hpp"
#include "core/contact/contact_row.hpp"
#include "core/contact/pair_geometry.hpp"

namespace bb {
namespace {

template <PairKind K>
std::optional<Overlap> pair_overlap(const Surface& surface, const Positions& x, IndexPair index) {
  const ContactPair<K> pair = contact_pair<K>(surface, index);
  const auto points = gather(x, pair.vertex);
  if (farther_than<K>(points, pair.law.offset)) return std::nullopt;
  const double gap = closest_points<K, double>(points).d - pair.law.offset;
  if (gap > 0) return std::nullopt;
  return Overlap{contact_kind<K>(), pair_key(pair.vertex), gap, {}};
}

std::optional<Overlap> obstacle_overlap(const Surface& surface,
                                        const std::vector<AnalyticSurface<double>>& obstacles,
                                        const Positions& x, IndexPair index) {
  const std::size_t i = static_cast<std::size_t>(index.first);
  const int v = surface.points.vertices[i][0];
  const double gap = surface_gap<double>(obstacles[static_cast<std::size_t>(index.second)], x.col(v)).d -
                     surface.points.side[i].offset;
  if (gap > 0) return std::nullopt;
  return Overlap{ContactKind::obstacle, obstacle_key(index.second, v), gap, {}};
}

}  // namespace

std::optional<Overlap> first_overlap(const Surface& surface,
                                     const std::vector<AnalyticSurface<double>>& obstacles,
                                     const Candidates& candidates, const Positions& x) {
  std::optional<Overlap> first;
  const auto scan = [&](const std::vector<IndexPair>& pairs, const auto& test) {
    over_chunks<std::optional<Overlap>>(
        pairs,
        [&](IndexPair pair, std::optional<Overlap>& found) {
          if (!found) found = test(pair);
        },
        [&](const std::optional<Overlap>& found) {
          if (!first) first = found;
        });
  };
  for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    scan(pairs, [&](IndexPair pair) { return pair_overlap<K>(surface, x, pair); });
  });
  scan(candidates.obstacle, [&](IndexPair pair) { return obstacle_overlap(surface, obstacles, x, pair); });
  return first;
}

}  // namespace bb
