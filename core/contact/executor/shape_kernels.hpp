// Barrier shapes on rows: one kernel a shape of the registry, a second one where kappa depends on the gap.
#pragma once

#include "core/barrier/shape.hpp"
#include "core/barrier/shape_potential.hpp"
#include "core/barrier/squared_gap.hpp"
#include "core/contact/executor/executor_rows.hpp"

namespace bb::exec {

/// Shape S at the gap d on its argument, derivatives in d. The arithmetic of core/barrier/barrier_function.cpp.
template <class S>
BB_HD ShapeTerms<double> shape_at(Argument argument, double d, double d_hat) {
  if (argument == Argument::gap) return S::eval(d, d_hat);
  const double d_sq = d * d, d_hat_sq = d_hat * d_hat;
  ShapeTerms<double> terms = S::eval(d_sq, d_hat_sq);
  chain_squared_gap(S::infinite_at_zero, d, d_sq, d_hat_sq, terms.b, terms.db, terms.d2b);
  return terms;
}

/// energy, force and stiffness of rows whose kappa is a number.
template <class S>
struct EvaluateShape {
  RowView rows;
  Argument argument;
  BB_HD void operator()(Index r) const {
    const ShapeTerms<double> terms = shape_at<S>(argument, rows.d[r], rows.d_hat[r]);
    const double kappa = rows.kappa ? rows.kappa[r] : rows.uniform_kappa;
    rows.energy[r] = kappa * terms.b;
    rows.force[r] = kappa * terms.db;
    rows.stiffness[r] = kappa * terms.d2b;
  }
};

/// The same of rows whose kappa is fixed + per_gap_sq/d^2, true derivatives: core/barrier/folded_barrier.hpp.
template <class S>
struct EvaluateFoldedShape {
  RowView rows;
  BB_HD void operator()(Index r) const {
    const double d = rows.d[r], d_hat = rows.d_hat[r];
    const ShapeTerms<double> b = S::eval(d, d_hat), psi = shapes::potential_terms<S>(d, d_hat);
    const KappaParts parts = rows.parts(r);
    const double fixed = parts.fixed, at_d_hat = parts.per_gap_sq / (d_hat * d_hat);
    rows.energy[r] = fixed * b.b + at_d_hat * psi.b;
    rows.force[r] = fixed * b.db + at_d_hat * psi.db;
    rows.stiffness[r] = fixed * b.d2b + at_d_hat * psi.d2b;
  }
};

}  // namespace bb::exec
