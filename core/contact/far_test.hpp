// Which candidate pairs are certainly farther apart than their contact distance at a state: eight at a time, in
// float. Most candidates are, and the closest points of a pair cost as much as this does for twenty. Floats are
// differences of the points of one pair in units of its own contact distance: what else is in the scene, and where,
// does not matter.
#pragma once

#include <vector>

#include "core/contact/lane_set.hpp"
#include "core/contact/pair_lanes.hpp"
#include "core/contact/tree_box.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// Not thread-safe while a state is set; any number of threads may call far().
class FarTest {
 public:
  static constexpr std::size_t width = 8;

  /// precision: that in which distances are evaluated.
  explicit FarTest(const Surface& surface, Precision precision = Precision::full);
  /// [3 x n] m, finite.
  void set_state(const PositionsView& x);
  /// Those of n <= 8 pairs of kind K that are proven farther apart than the d_hat and offset of their two sides,
  /// however their distance is rounded.
  template <PairKind K>
  LaneSet far(const IndexPair* pairs, std::size_t n) const;
  /// Prefetches what far() will need of a pair: the second primitive of a candidate jumps about.
  template <PairKind K>
  void fetch(IndexPair pair) const {
    __builtin_prefetch(&second<K>()[static_cast<std::size_t>(pair.second)]);
  }

 private:
  using Point = VectorOf<double, 4>::type;
  /// The vertices of a primitive and its share of the contact distance, m.
  struct alignas(16) Corners {
    int vertex[3];
    float reach;
  };
  template <int N>
  static std::vector<Corners> corners(const Primitives<N>& primitives);
  template <PairKind K>
  const std::vector<Corners>& first() const {
    return K == PairKind::edge_edge ? edges_ : points_;
  }
  template <PairKind K>
  const std::vector<Corners>& second() const {
    return K == PairKind::point_point ? points_ : K == PairKind::point_triangle ? triangles_ : edges_;
  }

  const Precision precision_;
  const std::vector<Corners> points_, edges_, triangles_;
  std::vector<Point> x_;  // m, and how much nearer than to this point the distance of a pair can be, m
};

}  // namespace bb
