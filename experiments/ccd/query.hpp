// One query of continuous collision detection with its truth: two primitives of four vertices in straight motion.
#pragma once

#include <vector>

#include "core/geometry/pair.hpp"
#include "core/math/types.hpp"

namespace bb::ccd {

struct Query {
  Mat<double, 3, 4> x0, x1;     // m, at t = 0 and 1, in the order of pair.hpp
  bool hits = false;            // whether the primitives meet at some t in [0, 1], without any rounding
  bool rounded_double = false;  // a coordinate of the source is no double
  bool rounded_float = false;   // or no float
};

struct QuerySet {
  std::vector<Query> point_triangle, edge_edge;
  const std::vector<Query>& of(PairKind kind) const {
    return kind == PairKind::point_triangle ? point_triangle : edge_edge;
  }
};

}  // namespace bb::ccd
