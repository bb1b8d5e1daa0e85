// Kernels that find candidate pairs, in rounds: every leaf walks its tree on floats until its places are full or the tree
// ends, one thread a pair applies the rules to what was found, and what is kept goes into the lists. The next round goes on
// where the walks stopped, so that no part of a tree is walked twice. Everything has its place by sizes alone.
#pragma once

#include "core/contact/executor/candidate_lists.hpp"
#include "core/contact/executor/pair_search.hpp"
#include "core/exec/sums/compaction_kernels.hpp"

namespace bb::exec {

/// Places of an item, by the number of leaves: as many as nearly all leaves need where that is 256 MiB or less, 16 at least.
/// Boxes of a cloth alone meet 18 others (of a mesh of half d_hat in eight layers: 48), those of its own neighbours among
/// them. Where places are full another round goes on.
constexpr int fewest_places = 16, most_places = 64;
constexpr int places_of_an_item(Index leaves) {
  const Index most = leaves > 0 ? (Index{1} << 26) / leaves : most_places;
  return static_cast<int>(most < fewest_places ? fewest_places : most < most_places ? most : most_places);
}
constexpr std::uint32_t nothing_held = ~std::uint32_t{0};

/// Where the candidates of a motion come from without a list of them.
struct CandidateSource {
  PairSearch point_point, point_edge, point_triangle, edge_edge;
  bool obstacles;
};

/// Leaves and primitives that are queried for candidates as one range of items, list by list (candidate_lists.hpp).
struct Askers {
  Index begin[n_candidate_lists + 1];
  int round, each, n_obstacles;  // each: places of an item

  BB_HD int list_of(Index item) const {
    int k = 0;
    while (item >= begin[k + 1]) ++k;
    return k;
  }
  BB_HD Index size(int list) const { return begin[list + 1] - begin[list]; }
  BB_HD Index leaves() const { return begin[first_obstacle_list]; }
  BB_HD Index items() const { return begin[n_candidate_lists]; }
  /// How many obstacles a primitive is queried about in this round.
  BB_HD int obstacles_asked() const {
    const int left = n_obstacles - each * round;
    return left < 0 ? 0 : left < each ? left : each;
  }
  /// Places of all items: `each` a leaf, then obstacles_asked() a primitive.
  BB_HD Index places() const { return each * leaves() + obstacles_asked() * (items() - leaves()); }
};

/// What items have found in a round: place k of all leaves, then place k + 1; the same of primitives.
struct HeldPairs {
  std::uint32_t*
      second;       // of a leaf the primitive of the other tree, of a primitive the obstacle; or nothing_held
  std::uint8_t* n;  // [leaves] how many places are taken
  std::uint32_t* next;  // [leaves] where the walk goes on
  BB_HD Index at(const Askers& askers, Index item, int k) const {
    const Index leaves = askers.leaves();
    return item < leaves ? leaves * k + item
                         : askers.each * leaves + (askers.items() - leaves) * k + (item - leaves);
  }
};

/// Of a leaf: what its box meets, on floats alone, until its places are full. *unfinished: whether a walk has to go on.
struct WalkTrees {
  struct Walk {
    TreeView first, second;
    LeafPairs leaves;
  };
  Askers askers;
  Walk walk[first_obstacle_list];
  HeldPairs held;
  std::uint32_t* unfinished;
  BB_HD void operator()(Index item) const {
    const int list = askers.list_of(item);
    const Walk& of = walk[list];
    const Index place = item - askers.begin[list];
    const Index from = askers.round > 0 ? Index{held.next[item]} : of.leaves.begin(place);
    int n = 0;
    Index next = of.second.n;
    if (from < next) {
      next = for_each_overlap(of.second, of.first.leaf(place), from, [&](std::uint32_t found) {
        held.second[held.at(askers, item, n)] = found;
        return ++n < askers.each;
      });
    }
    held.n[item] = static_cast<std::uint8_t>(n);
    held.next[item] = static_cast<std::uint32_t>(next);
    if (next < of.second.n) atomic_or(unfinished, 1);
  }
};

/// One thread a place: what is no candidate is taken from it. Obstacles, which no tree has, are put there.
struct KeepCandidates {
  Askers askers;
  PairSearch search[first_obstacle_list];
  const double *x0, *x1;
  HeldPairs held;
  BB_HD void operator()(Index place) const {
    const Index leaves = askers.leaves();
    if (place < askers.each * leaves) {
      const Index k = place / leaves;
      return ask(place, k, place - k * leaves);
    }
    const Index primitives = askers.items() - leaves, at = place - askers.each * leaves, k = at / primitives;
    const Index item = leaves + at - k * primitives;
    const int obstacle = askers.each * askers.round + static_cast<int>(k);
    held.second[place] = reaches(item, obstacle) ? static_cast<std::uint32_t>(obstacle) : nothing_held;
  }

  /// For a host: neighbours have the same k, which is divided for once.
  static constexpr int lanes = 64;
  void abreast(Index first) const {
    const Index leaves = askers.leaves(), k = leaves > 0 ? first / leaves : askers.each,
                item = first - k * leaves;
    const bool neighbours = k < askers.each && item + lanes <= leaves;
    for (Index i = 0; i < lanes; ++i) neighbours ? ask(first + i, k, item + i) : (*this)(first + i);
  }

 private:
  BB_HD void ask(Index place, Index k, Index item) const {
    if (k < held.n[item] && !keeps(item, held.second[place])) held.second[place] = nothing_held;
  }
  BB_HD bool keeps(Index item, Index found) const {
    const int list = askers.list_of(item);
    const PairSearch& s = search[list];
    const Key pair = s.leaves.pair(s.first.leaf(item - askers.begin[list]).primitive(), found);
    switch (list) {
      case 0:
        return is_candidate<PairKind::point_point>(s, pair);
      case 1:
        return is_candidate<PairKind::point_edge>(s, pair);
      case 2:
        return is_candidate<PairKind::point_triangle>(s, pair);
      default:
        return is_candidate<PairKind::edge_edge>(s, pair);
    }
  }
  BB_HD bool reaches(Index item, int obstacle) const {
    const SurfaceView& surface = search[0].surface;
    const int list = askers.list_of(item);
    const Index i = item - askers.begin[list];
    return list == first_obstacle_list       ? may_reach<1>(surface, i, obstacle, x0, x1)
           : list == first_obstacle_list + 1 ? may_reach<2>(surface, i, obstacle, x0, x1)
                                             : may_reach<3>(surface, i, obstacle, x0, x1);
  }
};

/// Counts of RankItems: how many candidates an item has found in this round.
struct HeldCandidates {
  static constexpr bool two = false;
  Askers askers;
  HeldPairs held;
  BB_HD int taken(Index item) const {
    return item < askers.leaves() ? held.n[item] : askers.obstacles_asked();
  }
  BB_HD int operator()(Index item) const {
    int n = 0;
    for (int k = 0; k < taken(item); ++k) n += held.second[held.at(askers, item, k)] != nothing_held ? 1 : 0;
    return n;
  }
};

/// The candidates of a round behind those of the rounds before; nothing where a list is too short.
struct FillCandidates {
  struct List {
    TreeView first;    // of leaves; empty: of the primitives themselves
    LeafPairs leaves;  // likewise
    Key* list;
    Index room;
  };
  HeldCandidates found;
  Places places;
  const Index* before;  // [lists] candidates of the rounds before; null in the first round
  List to[n_candidate_lists];
  BB_HD void operator()(Index item) const {
    const Askers& askers = found.askers;
    const int list = askers.list_of(item), taken = found.taken(item);
    if (taken == 0) return;
    const List& into = to[list];
    const Index of_list = item - askers.begin[list];
    const Index own = into.first.n > 0 ? into.first.leaf(of_list).primitive() : of_list;
    Index at = places.of(item) - places.of(askers.begin[list]) + (before ? before[list] : 0);
    for (int k = 0; k < taken; ++k) {
      const std::uint32_t second = found.held.second[found.held.at(askers, item, k)];
      if (second == nothing_held) continue;
      if (at < into.room) into.list[at] = into.leaves.pair(own, second);
      ++at;
    }
  }
};

/// total[list] gets the candidates of a round besides.
struct CandidateTotals {
  Askers askers;
  Places places;
  const Index* sum;  // of the round
  Index* total;
  BB_HD void operator()(Index list) const {
    const Index end = askers.begin[list + 1];
    const Index n = end == askers.begin[list]
                        ? 0
                        : (end < askers.items() ? places.of(end) : *sum) - places.of(askers.begin[list]);
    total[list] = (askers.round == 0 ? 0 : total[list]) + n;
  }
};

}  // namespace bb::exec
