// The fields `shape` and `argument`, common to several kinds.
#pragma once

#include "barriers/shapes/registry.hpp"
#include "core/barrier/folded_barrier.hpp"
#include "experiments/eval/query.hpp"

namespace bb::eval {

/// Any registered shape, plugins included, or NAME:A with its exponent; the first one when the field is wrong.
inline Shape shape_field(Query& q) {
  const bool fine = !q.wrong();
  const std::string name = q.word("shape");
  if (q.wrong() && fine) return all_shapes().front();
  try {
    return require_shape(name, "/shape");
  } catch (const ConfigError& error) {
    const Violation& v = error.violations().front();
    q.complain("shape", v.found, v.allowed);
    return all_shapes().front();
  }
}

inline BarrierFunction barrier_field(Query& q) {
  const Shape shape = shape_field(q);
  const bool squared = q.choice_or("argument", {"gap", "squared_gap"}) == "squared_gap";
  return {shape, squared ? Argument::squared_gap : Argument::gap};
}

/// The same with the field `derivative`; included: the potential of kappa (d_hat/d)^2 b'(d), kappa being the
/// stiffness at d_hat, as a barrier of its own.
inline BarrierFunction barrier_with_derivative(Query& q) {
  BarrierFunction barrier = barrier_field(q);
  if (q.choice_or("derivative", {"dropped", "included"}) == "dropped") return barrier;
  if (has_potential(barrier)) return potential_of(barrier);
  q.complain("derivative",
             "included with " + barrier.shape.name + " on " + std::string(to_string(barrier.argument)),
             "dropped, or argument gap and one of the shapes with a potential: " + shapes_with_potential());
  return barrier;
}

}  // namespace bb::eval
