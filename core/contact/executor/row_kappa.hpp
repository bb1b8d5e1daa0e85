// kappa of rows by a policy, with w^T H w streamed from the blocks of the matrix.
#pragma once

#include "core/barrier/scaled_policy.hpp"
#include "core/contact/executor/executor_rows.hpp"
#include "core/linear/executor/sub_matrix.hpp"

namespace bb::exec {

struct RowKappaInputs {
  RowView rows;
  const std::uint8_t* missing;  // only rows marked here; null: all
  bool with_hessian;
  StiffnessTime time;
  bool at_d_hat;       // the gap is d_hat
  const double* mass;  // [n_vertices] kg
  MatrixPart elastic;
};

/// kappa of rows by a policy of contacts, P its struct of values.
template <class P>
struct RowKappa : RowKappaInputs {
  ScaledPolicy<P> policy;

  BB_HD void operator()(Index r) const {
    if (missing && missing[r] == 0) return;
    double weight[4], masses[4], normal[3];
    int vertex[4], n = 0;
    for (int k = 0; k < 4; ++k) {
      if (!rows.is_free(r, k)) continue;
      vertex[n] = rows.vertex[k * rows.n + r];
      weight[n] = rows.weight[k * rows.n + r];
      masses[n] = mass[vertex[n]];
      ++n;
    }
    for (int c = 0; c < 3; ++c) normal[c] = rows.normal[c * rows.n + r];
    const SubMatrix h(elastic, vertex, with_hessian ? n : 0);
    const ContactSums<double> sums = contact_sums(n, weight, normal, masses, h, with_hessian);
    const double d_hat = rows.d_hat[r];
    if (rows.per_gap_sq) {
      const KappaParts one = policy.contact_parts(sums, d_hat, time);
      rows.kappa[r] = one.fixed;
      rows.per_gap_sq[r] = one.per_gap_sq;
      return;
    }
    rows.kappa[r] = policy.contact_kappa(sums, at_d_hat ? d_hat : rows.d[r], d_hat, time);
  }
};

}  // namespace bb::exec
