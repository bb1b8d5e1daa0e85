// What the stiffness of contact rows is found by, and where it is kept: a view of columns, whatever table they are of.
#pragma once

#include "core/barrier/stiffness_policy.hpp"
#include "core/contact/pair_id.hpp"
#include "core/exec/kernel.hpp"

namespace bb {

using exec::Index;

/// In an executor's memory. The parts of row r are at by * r.
struct StiffnessRows {
  Index n = 0;
  const PairId* pair = nullptr;  // [n] ascending
  const double* d = nullptr;     // [n] m
  double* fixed = nullptr;       // N/m
  double* per_gap_sq = nullptr;  // N m; null where no policy has a potential
  Index by = 1;
  double* kappa = nullptr;  // [n] N/m, the parts at d; null where nobody reads it
  double* kappa_before =
      nullptr;  // [n] N/m: what kappa the row came with when its iterate was accepted, 0: it was not there

  BB_HD KappaParts parts(Index r) const { return {fixed[by * r], per_gap_sq ? per_gap_sq[by * r] : 0.0}; }
  BB_HD void set(Index r, const KappaParts& parts) const {
    fixed[by * r] = parts.fixed;
    if (per_gap_sq) per_gap_sq[by * r] = parts.per_gap_sq;
    if (kappa) kappa[r] = parts.at(d[r]);
  }
};

/// Of a table of the host, which lives as long as the view is used and keeps its size.
template <class Table>
StiffnessRows stiffness_rows(Table& of) {
  if (of.size() == 0) return {};
  KappaParts* const parts = of.parts.data();
  constexpr Index by = sizeof(KappaParts) / sizeof(double);
  return {static_cast<Index>(of.size()),
          of.pair.data(),
          of.d.data(),
          &parts->fixed,
          &parts->per_gap_sq,
          by,
          of.kappa.data(),
          of.kappa_before.data()};
}

}  // namespace bb
