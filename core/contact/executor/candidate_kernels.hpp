// Kernels that find candidate pairs. One walk of a tree counts the pairs of a leaf and holds the first of them, so that
// they can be put in their places without another walk; a leaf with more than it can hold is asked again.
#pragma once

#include "core/contact/executor/candidate_lists.hpp"
#include "core/contact/executor/pair_search.hpp"

namespace bb::exec {

/// Pairs that are held for a leaf. On eight layers of cloth with a mesh of half d_hat a leaf has six.
constexpr Index pairs_held = 8;

/// Where the candidates of a motion come from without a list of them.
struct CandidateSource {
  PairSearch point_point, point_edge, point_triangle, edge_edge;
  bool obstacles;
};

/// Leaves and primitives that are asked for candidates as one range of items, list by list (candidate_lists.hpp).
struct Askers {
  PairSearch search[first_obstacle_list];
  const double *x0, *x1;
  Index begin[n_candidate_lists + 1];
  BB_HD int list_of(Index item) const {
    int k = 0;
    while (item >= begin[k + 1]) ++k;
    return k;
  }
  BB_HD Index size(int list) const { return begin[list + 1] - begin[list]; }
  /// Calls f(i, j) for the candidates of an item of a list.
  template <class F>
  BB_HD void for_each(int list, Index place, const F& f) const {
    switch (list) {
      case 0:
        return for_each_pair<PairKind::point_point>(search[0], place, f);
      case 1:
        return for_each_pair<PairKind::point_edge>(search[1], place, f);
      case 2:
        return for_each_pair<PairKind::point_triangle>(search[2], place, f);
      case 3:
        return for_each_pair<PairKind::edge_edge>(search[3], place, f);
      case 4:
        return for_each_obstacle<1>(place, f);
      case 5:
        return for_each_obstacle<2>(place, f);
      default:
        return for_each_obstacle<3>(place, f);
    }
  }

 private:
  template <int N, class F>
  BB_HD void for_each_obstacle(Index i, const F& f) const {
    const SurfaceView& surface = search[0].surface;
    for (int o = 0; o < surface.n_obstacles; ++o) {
      if (may_reach<N>(surface, i, o, x0, x1)) f(i, Index{o});
    }
  }
};

/// count[item]: its candidates; held: the first of those of a leaf.
struct CountCandidates {
  Askers askers;
  Index* count;
  Key* held;  // [pairs_held][leaves] list by list
  BB_HD void operator()(Index item) const {
    const int list = askers.list_of(item);
    const Index place = item - askers.begin[list], stride = askers.size(list);
    Key* const own = held + pairs_held * askers.begin[list] + place;
    const bool holds = list < first_obstacle_list;
    Index found = 0;
    askers.for_each(list, place, [&](Index i, Index j) {
      if (holds && found < pairs_held) own[found * stride] = pair_of(i, j);
      ++found;
    });
    count[item] = found;
  }
};

/// How many candidates each list has, of the places [items + 1] that its items have among all.
struct CandidateTotals {
  const Index* place;
  Index begin[n_candidate_lists + 1];
  Index* total;
  BB_HD void operator()(Index list) const { total[list] = place[begin[list + 1]] - place[begin[list]]; }
};

/// The same candidates, in their lists.
struct FillCandidates {
  Askers askers;
  const Index* place;
  const Key* held;
  Key* list[n_candidate_lists];
  BB_HD void operator()(Index item) const {
    const int k = askers.list_of(item);
    const Index found = place[item + 1] - place[item], leaf = item - askers.begin[k];
    if (found == 0) return;
    Key* next = list[k] + (place[item] - place[askers.begin[k]]);
    if (k < first_obstacle_list && found <= pairs_held) {
      const Key* const own = held + pairs_held * askers.begin[k] + leaf;
      for (Index m = 0; m < found; ++m) next[m] = own[m * askers.size(k)];
      return;
    }
    askers.for_each(k, leaf, [&](Index i, Index j) { *next++ = pair_of(i, j); });
  }
};

}  // namespace bb::exec
