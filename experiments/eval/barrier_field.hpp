// The fields `shape` and `argument`, common to several kinds.
#pragma once

#include "barriers/shapes/registry.hpp"
#include "experiments/eval/query.hpp"

namespace bb::eval {

/// Any registered shape, plugins included; the first one when the field is wrong.
inline Shape shape_field(Query& q) { return shapes().require(q.choice("shape", shapes().names()), "/shape"); }

inline BarrierFunction barrier_field(Query& q) {
  const Shape shape = shape_field(q);
  const bool squared = q.choice_or("argument", {"gap", "squared_gap"}) == "squared_gap";
  return {shape, squared ? Argument::squared_gap : Argument::gap};
}

}  // namespace bb::eval
