// The field `pair`: which two primitives the points of a query are.
#pragma once

#include "core/geometry/pair.hpp"
#include "experiments/eval/answer.hpp"
#include "experiments/eval/query.hpp"

namespace bb::eval {

template <PairKind K>
struct PairTag {
  static constexpr PairKind kind = K;
};

/// Calls f(PairTag<K>()) for the field `pair`; a wrong one is complained of and read as point_point.
template <class F>
Answer with_pair(Query& q, F f) {
  using enum PairKind;
  const std::string word = q.choice("pair", {pair_name(point_point), pair_name(point_edge),
                                             pair_name(point_triangle), pair_name(edge_edge)});
  if (word == pair_name(point_edge)) return f(PairTag<point_edge>());
  if (word == pair_name(point_triangle)) return f(PairTag<point_triangle>());
  if (word == pair_name(edge_edge)) return f(PairTag<edge_edge>());
  return f(PairTag<point_point>());
}

}  // namespace bb::eval
