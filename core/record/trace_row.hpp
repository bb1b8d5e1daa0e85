// One Newton iteration as the trace keeps it. Units in the names; `cond` is a condition number, `kappa` a
// contact stiffness.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/linear/condition.hpp"
#include "core/record/number.hpp"
#include "core/record/phase_times.hpp"

namespace bb {

/// Which terms the matrix of a condition estimate holds.
enum class MatrixStage { full, no_contact, no_contact_no_limit };
inline std::string_view to_string(MatrixStage stage) {
  if (stage == MatrixStage::full) return "full";
  return stage == MatrixStage::no_contact ? "no_contact" : "no_contact_no_limit";
}

struct ConditionSample {
  MatrixStage stage = MatrixStage::full;
  Scaling scaling = Scaling::none;
  int tier = 2;
  ConditionEstimate estimate;
};

struct ContactCounts {
  std::size_t point_point = 0, point_edge = 0, point_triangle = 0, edge_edge = 0, obstacle = 0, mollified = 0;
  std::size_t total() const {
    return point_point + point_edge + point_triangle + edge_edge + obstacle + mollified;
  }
};

struct TraceRow {
  int step = 0, iteration = 0;  // both from 0
  double t_s = 0;               // simulated time at the end of the step

  Number energy_J;         // E before the update
  Number energy_change_J;  // accepted, compared as a difference
  Number grad_inf_N;
  Number dx_inf_m;     // full Newton direction, before alpha
  Number decrement_J;  // -g^T dx / 2

  Number alpha;         // accepted
  Number alpha_ccd;     // ACCD bound
  Number alpha_strain;  // bound of the strain limit
  int line_search_trials = 0;
  bool rounding_accept = false;  // accepted because the change was below rounding

  std::string linear_status = "ok";
  int linear_iterations = 0;
  Number residual_true, residual_recurrence;  // |b - A x| / |b|
  Number probe_pcg_iterations;                // of block-Jacobi PCG on this matrix, fixed right-hand side
  Number ritz_min, ritz_max;                  // of the preconditioned matrix
  std::size_t n_free = 0, nnz = 0;            // degrees of freedom, entries of the lower triangle
  bool analyzed = false;                      // a symbolic analysis was done here

  std::vector<ConditionSample> cond;  // empty when not due

  ContactCounts contacts;
  Number gap_min_iterates_m, gap_min_iterates_rel;  // smallest d (m) and d / d_hat of this iterate
  Number kappa_min_N_per_m, kappa_max_N_per_m;
  Number kappa_change_rel;        // largest max/min - 1 of a contact's kappa since the line search before
  Number limit_kappa_change_rel;  // the same of an active limited element's
  Number limit_gap_min_rel;       // smallest distance of an element to its limit, over the width
  Number contact_curvature_max_N_per_m;  // max m kappa b''
  Number contact_load_max_N;             // max kappa |b'| per unit multiplicity
  Number max_stretch;                    // max sigma - 1
  Number limit_load_max_N_per_m;         // max (1/area) dS_e/dsigma

  PhaseTimes time;  // of the same iteration in the pass `time`; empty without it
};

}  // namespace bb
