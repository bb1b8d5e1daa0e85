// Kernels that count candidate pairs and write them.
#pragma once

#include "core/resident/contact/pair_search.hpp"

namespace bb::resident {

/// count[place]: candidates of the leaf at that place.
template <PairKind K>
struct CountPairs {
  PairSearch search;
  Index* count;
  BB_HD void operator()(Index place) const {
    Index n = 0;
    for_each_pair<K>(search, place, [&](Index, Index) { ++n; });
    count[place] = n;
  }
};

/// pair[begin[place], ...): the same candidates.
template <PairKind K>
struct FillPairs {
  PairSearch search;
  const Index* begin;
  Key* pair;
  BB_HD void operator()(Index place) const {
    Key* next = pair + begin[place];
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
