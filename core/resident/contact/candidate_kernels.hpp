// Kernels that find candidate pairs. One walk of a tree counts the pairs of a leaf and holds the first of them, so that
// they can be put in their places without another walk; a leaf with more than it can hold is asked again.
#pragma once

#include "core/resident/contact/pair_search.hpp"

namespace bb::resident {

/// Pairs that are held for a leaf. On eight layers of cloth with a mesh of half d_hat a leaf has six.
constexpr Index pairs_held = 8;

/// count[place]: candidates of the leaf at that place; held: the first of them.
template <PairKind K>
struct CountPairs {
  PairSearch search;
  Index* count;
  Key* held;  // [pairs_held][n]
  Index n;
  BB_HD void operator()(Index place) const {
    Index found = 0;
    Key* const own = held + place;
    const Index stride = n;
    for_each_pair<K>(search, place, [&](Index i, Index j) {
      if (found < pairs_held) own[found * stride] = pair_of(i, j);
      ++found;
    });
    count[place] = found;
  }
};

/// pair[begin[place], begin[place + 1]): the same candidates.
template <PairKind K>
struct FillPairs {
  PairSearch search;
  const Index* begin;
  const Key* held;
  Index n;
  Key* pair;
  BB_HD void operator()(Index place) const {
    const Index first = begin[place], found = begin[place + 1] - first;
    if (found <= pairs_held) {
      for (Index k = 0; k < found; ++k) pair[first + k] = held[k * n + place];
      return;
    }
    Key* next = pair + first;
    for_each_pair<K>(search, place, [&](Index i, Index j) { *next++ = pair_of(i, j); });
  }
};

/// count[i], pair[begin[i], ...): candidates of primitive i with N vertices and the obstacles.
template <int N>
struct CountObstacles {
  SurfaceView surface;
  const double *x0, *x1;
  Index* count;
  BB_HD void operator()(Index i) const {
    Index n = 0;
    for (int o = 0; o < surface.n_obstacles; ++o) n += may_reach<N>(surface, i, o, x0, x1) ? 1 : 0;
    count[i] = n;
  }
};

template <int N>
struct FillObstacles {
  SurfaceView surface;
  const double *x0, *x1;
  const Index* begin;
  Key* pair;
  BB_HD void operator()(Index i) const {
    Key* next = pair + begin[i];
    for (int o = 0; o < surface.n_obstacles; ++o) {
      if (may_reach<N>(surface, i, o, x0, x1)) *next++ = pair_of(i, o);
    }
  }
};

}  // namespace bb::resident
