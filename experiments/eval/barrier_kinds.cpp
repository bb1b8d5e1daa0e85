// shape, rho, equilibrium, match: the functions of one contact. The shape is evaluated in the precision of
// the query; rho, rest states and matching are double in the pipeline, here too, on rounded input.
#include <limits>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "experiments/eval/barrier_field.hpp"
#include "experiments/eval/kinds.hpp"

namespace bb::eval {

template <class T>
Answer answer::shape(Query& q) {
  const BarrierFunction barrier = barrier_field(q);
  const T d = static_cast<T>(q.number("d", kNonNegative));
  const T d_hat = static_cast<T>(q.number("d_hat", kPositive));
  q.finish();
  const ShapeTerms<T> terms = barrier.eval(d, d_hat);
  Answer a;
  a.number("b", static_cast<double>(terms.b));
  a.number("db", static_cast<double>(terms.db));
  a.number("d2b", static_cast<double>(terms.d2b));
  return a;
}

template <class T>
Answer answer::rho(Query& q) {
  const BarrierFunction barrier = barrier_with_derivative(q);
  const double u = q.number("u", kUnitOpen);
  q.finish();
  Answer a;
  a.number("rho", static_cast<double>(static_cast<T>(bb::rho(barrier, u))));
  return a;
}

template <class T>
Answer answer::equilibrium(Query& q) {
  const BarrierFunction barrier = barrier_with_derivative(q);
  const double kappa = q.number("kappa", kPositive);
  const double d_hat = q.number("d_hat", kPositive);
  const double load = q.number("load", kPositive);
  q.finish();
  const Equilibrium rest = bb::equilibrium(barrier, kappa, d_hat, load);
  Answer a;
  const auto put = [&a](const char* name, const std::optional<double>& v) {
    v ? a.number(name, static_cast<double>(static_cast<T>(*v))) : a.null(name);
  };
  put("d", rest.d);
  put("K", rest.stiffness);
  put("capacity", rest.capacity);
  if (rest.above_capacity) a.status("above_capacity");
  return a;
}

template <class T>
Answer answer::match(Query& q) {
  const bool by_force = q.choice("rule", {"equal_force", "equal_curvature"}) == "equal_force";
  const BarrierFunction barrier = barrier_field(q);
  const double d_hat = q.number("d_hat", kPositive);
  const double target = q.number(by_force ? "load" : "curvature", kPositive);
  const double theta = q.number_or("theta", kUnitOpen, by_force ? 0.1 : 0.5);
  q.finish();
  const double kappa = by_force ? match_equal_force(barrier, d_hat, target, theta)
                                : match_equal_curvature(barrier, d_hat, target, theta);
  Answer a;
  a.number("kappa", static_cast<double>(static_cast<T>(kappa)));
  return a;
}

BB_EVAL_KIND(shape);
BB_EVAL_KIND(rho);
BB_EVAL_KIND(equilibrium);
BB_EVAL_KIND(match);

}  // namespace bb::eval
