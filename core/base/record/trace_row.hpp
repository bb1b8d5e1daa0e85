// One Newton iteration as the trace keeps it: one line of trace.jsonl. `cond` is a condition number, `kappa`
// a contact stiffness.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/record/field.hpp"
#include "core/base/record/number.hpp"
#include "core/base/record/phase_times.hpp"
#include "core/linear/condition.hpp"
#include "core/linear/linear_solver.hpp"

namespace bb {

/// Which terms the matrix of a condition estimate holds.
enum class MatrixStage { full, without_contact, without_limit, without_contact_and_limit };
constexpr std::string_view to_string(MatrixStage stage) {
  if (stage == MatrixStage::full) return "full";
  if (stage == MatrixStage::without_contact) return "without_contact";
  return stage == MatrixStage::without_limit ? "without_limit" : "without_contact_and_limit";
}
template <>
inline constexpr int n_words<MatrixStage> = 4;
template <>
inline constexpr int n_words<Scaling> = 3;
template <>
inline constexpr int n_words<ProvenEnds> = 4;
template <>
inline constexpr int n_words<ConditionStatus> = 5;
template <>
inline constexpr int n_words<LinearStatus> = 7;

/// Which Hessian of its terms it holds.
enum class MatrixForm { clamped, solved };
constexpr std::string_view to_string(MatrixForm form) {
  return form == MatrixForm::clamped ? "clamped" : "solved";
}
template <>
inline constexpr int n_words<MatrixForm> = 2;

inline constexpr const char* no_eigenvalue = "lower_bound singular not_pd not_converged";

/// Which end of a spectrum.
enum class SpectrumSide { smallest, largest };
constexpr std::string_view to_string(SpectrumSide side) {
  return side == SpectrumSide::smallest ? "smallest" : "largest";
}
template <>
inline constexpr int n_words<SpectrumSide> = 2;

/// Of an update that was judged by feasibility alone.
inline constexpr const char* no_energies_compared = "not_compared";

struct TermShare {
  BB_RECORD(TermShare, "the part of an eigenvalue that one term of E makes");
  BB_FIELD(std::string, term, "term of the registry");
  BB_FIELD(double, share, "v^T H_term v / lambda, v the unit eigenvector; all shares add up to 1") = 0;
  BB_RECORD_END;
};

struct SpectrumEnd {
  BB_RECORD(SpectrumEnd, "where the eigenvector v of one end of the spectrum lives");
  BB_FIELD(SpectrumSide, side, "which end") = SpectrumSide::smallest;
  BB_FIELD(double, lambda, "v^T A v of the scaled matrix") = 0;
  BB_FIELD(std::vector<TermShare>, terms, "all terms with elements, largest share first");
  BB_FIELD(std::string, element, "the element with the largest v^T H_element v, by term and vertices");
  BB_FIELD(double, element_share, "its part of lambda") = 0;
  BB_FIELD(std::string, body, "the body with the largest part of |v|^2");
  BB_FIELD(double, body_share, "that part") = 0;
  BB_FIELD(int, vertex, "the vertex with the largest |v_i|") = 0;
  BB_FIELD(double, vertices, "that v is spread over: 1/sum |v_i|^4, |v| = 1") = 0;
  BB_RECORD_END;
};

struct ConditionSample {
  BB_RECORD(ConditionSample, "an estimate of a condition number");
  BB_FIELD(MatrixForm, matrix,
           "clamped: of positive semi-definite elements, as papers compare it. solved: the one that was "
           "factorised, where it is another") = MatrixForm::clamped;
  BB_FIELD(MatrixStage, stage, "the terms that the matrix holds") = MatrixStage::full;
  BB_FIELD(Scaling, scaling, "of the matrix, before the estimate") = Scaling::none;
  BB_FIELD(int, tier, "number of the estimator: 0 ritz, 1 inverse_power, 2 spectra, 3 dense, 4 lanczos") = 2;
  BB_FIELD(Number, lambda_min, "smallest eigenvalue", no_eigenvalue);
  BB_FIELD(Number, lambda_max, "largest eigenvalue", no_eigenvalue);
  BB_FIELD(Number, cond, "lambda_max / lambda_min, at most 1e14", no_eigenvalue);
  BB_FIELD(ConditionStatus, status, "lower_bound: cond is at least that") = ConditionStatus::ok;
  BB_FIELD(std::string, method,
           "ritz, inverse_power+lanczos, spectra, lanczos, dense, and what an end took beside it: by "
           "lanczos, where Spectra "
           "did not converge in its budget; shifted to, round a factor of its own");
  BB_FIELD(
      ProvenEnds, proof,
      "which eigenvalues a factor of the shifted matrix proves to be the last, to 8e-4 of them; not computed "
      "where rounding would decide") = ProvenEnds::none;
  BB_FIELD(double, residual, "largest |A v - lambda v| / |A| of both pairs") = 0;
  BB_FIELD(int, solves, "triangular solves") = 0;
  BB_FIELD(int, products, "matrix products") = 0;
  BB_FIELD(int, factorizations, "beyond the first, which the scalings share") = 0;
  BB_FIELD(double, time_s, "what the estimate took") = 0;
  BB_FIELD(std::vector<SpectrumEnd>, ends, "where both eigenvectors live; empty when not requested");
  BB_RECORD_END;
};

struct ContactCounts {
  BB_RECORD(ContactCounts, "pairs in contact, by the feature that is closest");
  BB_FIELD(std::size_t, point_point, "two vertices") = 0;
  BB_FIELD(std::size_t, point_edge, "vertex and edge") = 0;
  BB_FIELD(std::size_t, point_triangle, "vertex and triangle") = 0;
  BB_FIELD(std::size_t, edge_edge, "two edges") = 0;
  BB_FIELD(std::size_t, obstacle, "analytic obstacle and a vertex, an edge or a triangle") = 0;
  BB_FIELD(std::size_t, mollified, "two nearly parallel edges, or an edge nearly parallel to a cylinder") = 0;
  BB_DERIVED(std::size_t, total, "all of them") {
    return point_point + point_edge + point_triangle + edge_edge + obstacle + mollified;
  }
  BB_RECORD_END;
};

/// Counted in an iteration, summed over a step and over a run.
struct WorkCounts {
  BB_RECORD(WorkCounts, "work that was done");
  BB_FIELD(long long, linear_solves, "linear systems solved, failed attempts included") = 0;
  BB_FIELD(
      long long, hessian_fallbacks,
      "attempts whose matrix was not positive definite, or whose direction did not descend, and that were "
      "followed by one nearer to the clamped Hessian") = 0;
  BB_FIELD(long long, linear_iterations, "iterations of the linear solver; a direct one has none") = 0;
  BB_FIELD(long long, factorizations, "numeric factorisations, of a matrix or a preconditioner") = 0;
  BB_FIELD(long long, factor_flop,
           "operations of the Cholesky factorisations that succeeded, as CHOLMOD counts them") = 0;
  BB_FIELD(long long, analyses, "symbolic analyses") = 0;
  BB_FIELD(long long, line_search_trials, "states that a line search tried") = 0;
  BB_FIELD(long long, rounding_accepts, "steps taken because the change of E was below rounding") = 0;
  BB_FIELD(long long, ccd_queries, "pairs that ACCD bounded") = 0;
  BB_FIELD(long long, ccd_probes, "distances that ACCD computed") = 0;
  BB_FIELD(long long, ccd_capped, "pairs that reached the probe cap") = 0;
  BB_FIELD(long long, ccd_zero, "pairs that allowed no motion") = 0;
  BB_FIELD(long long, end_checks,
           "states that were tested for being minima of E, factors at hand included") = 0;
  BB_FIELD(long long, end_check_factorizations, "factorisations that only these checks needed") = 0;
  BB_FIELD(long long, end_check_iterations, "iterations of conjugate gradients of these checks") = 0;
  BB_FIELD(
      long long, detours,
      "moves along the direction with a second-order correction, since curved gaps held it: alpha and its "
      "bounds are of that") = 0;
  BB_FIELD(long long, escapes,
           "moves along a direction of negative curvature, out of a saddle or away from a cusp") = 0;
  BB_RECORD_END;

  WorkCounts& operator+=(const WorkCounts& other) {
    for_each_field<WorkCounts>([&](const FieldText&, auto count) { this->*count += other.*count; });
    return *this;
  }
};

struct TraceRow : WorkCounts {
  using BaseRecord = WorkCounts;
  BB_RECORD(TraceRow, "one Newton iteration: a line of trace.jsonl, of the version of run.json beside it");
  BB_FIELD(int, step, "from 0") = 0;
  BB_FIELD(int, iteration, "of the step, from 0") = 0;
  BB_FIELD(double, t_s, "simulated time at the end of the step") = 0;
  BB_FIELD(double, energy_J, "E before the update, contact with the kappa of this iteration") = 0;
  BB_FIELD(Number, energy_change_J, "of the accepted update, compared as a difference; 0 without an update",
           no_energies_compared) = 0;
  BB_FIELD(double, grad_inf_N, "largest entry of the gradient, free degrees of freedom") = 0;
  BB_FIELD(double, dx_inf_m, "largest entry of the full Newton direction, before alpha") = 0;
  BB_FIELD(double, decrement_J, "-g . dx / 2") = 0;
  BB_FIELD(double, hessian_t, "of the matrix that was solved: 0 exact, 1 clamped, where a term blends") = 0;
  BB_FIELD(
      Number, contraction,
      "|dx| over that of the iteration before, at least the square of the ratio before (0.9 where that is "
      "not known)",
      "first_iteration shortened_step not_estimated");
  BB_FIELD(Number, error_estimate_m,
           "|dx| q/(1 - q), q the contraction: of the state after the full direction", "not_estimated");
  BB_FIELD(double, alpha, "accepted fraction of the direction") = 0;
  BB_FIELD(double, alpha_ccd, "bound of ACCD") = 1;
  BB_FIELD(double, alpha_strain, "bound of the strain limit") = 1;
  BB_FIELD(LinearStatus, linear_status, "of the linear solver") = LinearStatus::ok;
  BB_FIELD(Number, linear_tolerance, "on residual_true, as the forcing chose it", "direct_solver");
  BB_FIELD(double, residual_true, "|b - A x| / |b|") = 0;
  BB_FIELD(Number, residual_recurrence, "the same from the recurrence", "direct_solver");
  BB_FIELD(Number, ritz_min, "smallest Ritz value of the preconditioned matrix", "direct_solver");
  BB_FIELD(Number, ritz_max, "largest of them", "direct_solver");
  BB_FIELD(Number, probe_pcg_iterations,
           "of PCG with block Jacobi on this matrix and a fixed right-hand side",
           "not_due matrix_indefinite preconditioner_indefinite tolerance_below_rounding non_finite "
           "iteration_cap factor_too_large");
  BB_FIELD(std::size_t, n_free, "degrees of freedom of the matrix") = 0;
  BB_FIELD(std::size_t, nnz, "entries of its lower triangle") = 0;
  BB_FIELD(Number, factor_nnz, "entries of its Cholesky factor", "no_factor");
  BB_FIELD(ContactCounts, contacts, "of this iterate");
  BB_FIELD(Number, gap_min_iterates_m, "smallest gap of this iterate", "no_contacts");
  BB_FIELD(Number, gap_min_iterates_rel, "smallest d / d_hat of this iterate", "no_contacts");
  BB_FIELD(Number, kappa_min_N_per_m, "smallest kappa of a pair", "no_contacts");
  BB_FIELD(Number, kappa_max_N_per_m, "largest kappa of a pair", "no_contacts");
  BB_FIELD(Number, kappa_change_rel,
           "largest max/min - 1 of a contact's kappa since the line search before; above 0 for iterations on "
           "end: the refresh of kappa cycles",
           "first_iteration");
  BB_FIELD(Number, limit_kappa_change_rel, "the same of a limited element that is active",
           "first_iteration no_limit");
  BB_FIELD(Number, limit_gap_min_rel,
           "smallest distance of an element to its limit over its width; 1 or more: none is active",
           "no_limit");
  BB_FIELD(Number, contact_curvature_max_N_per_m, "largest kappa b'' of a pair", "no_contacts");
  BB_FIELD(Number, contact_load_max_N, "largest kappa |b'| of a pair", "no_contacts");
  BB_FIELD(Number, max_stretch, "largest sigma - 1 of a limited element", "no_limit");
  BB_FIELD(Number, limit_load_max_N_per_m, "largest (1/area) dS_e/dsigma of triangles", "no_limit");
  BB_FIELD(Number, solid_limit_load_max_Pa, "largest (1/volume) dS_e/dsigma of tetrahedra", "no_limit");
  BB_FIELD(std::vector<ConditionSample>, cond, "condition estimates; empty when not due");
  BB_FIELD(PhaseTimes, time, "of the same iteration in the pass `time`; empty without it");
  BB_RECORD_END;
};

}  // namespace bb
