// All lists of candidate pairs as one range of items, so that one launch serves all of them.
#pragma once

#include "core/contact/candidates.hpp"
#include "core/contact/executor/executor_surface.hpp"

namespace bb::exec {

/// The lists of point-point, point-edge, point-triangle and edge-edge pairs (PairKind), then those of obstacles with
/// points, edges and triangles.
constexpr int n_candidate_lists = 7, first_obstacle_list = 4;

struct CandidateItem {
  int list;
  Key pair;
};

struct CandidateLists {
  const Key* list[n_candidate_lists];
  Index begin[n_candidate_lists + 1];  // of each list among the items

  BB_HD int list_of(Index i) const {
    int k = 0;
    while (i >= begin[k + 1]) ++k;
    return k;
  }
  BB_HD CandidateItem operator[](Index i) const {
    const int k = list_of(i);
    return {k, list[k][i - begin[k]]};
  }
  Index size() const { return begin[n_candidate_lists]; }
  Index of_obstacles() const { return size() - begin[first_obstacle_list]; }
};

inline CandidateLists candidate_lists(const ExecutorCandidates& c) {
  const Buffer<Key>* const lists[] = {&c.point_point, &c.point_edge,    &c.point_triangle,   &c.edge_edge,
                                      &c.obstacle,    &c.obstacle_edge, &c.obstacle_triangle};
  CandidateLists out{};
  for (int k = 0; k < n_candidate_lists; ++k) {
    out.list[k] = lists[k]->data();
    out.begin[k + 1] = out.begin[k] + lists[k]->size();
  }
  return out;
}

}  // namespace bb::exec
