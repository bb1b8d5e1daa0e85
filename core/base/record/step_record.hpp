// One time step as the record keeps it.
#pragma once

#include <string>

#include "core/base/record/solver_counts.hpp"
#include "core/base/record/step_status.hpp"
#include "core/base/record/trace_row.hpp"

namespace bb {

inline constexpr const char* no_load_measured = "converged kappa_unsettled";
inline constexpr const char* no_surface_gap = "not_requested not_converged no_obstacles none_within_d_hat";

struct StepRecord : WorkCounts {
  using BaseRecord = WorkCounts;
  BB_RECORD(StepRecord, "one time step");
  BB_FIELD(int, step, "from 0") = 0;
  BB_FIELD(double, t_s, "simulated time at its end") = 0;
  BB_FIELD(double, dt_s, "length; of accumulated_toi, the part that was reached") = 0;
  BB_FIELD(int, retries, "attempts before this one, from the same start with twice the length each") = 0;
  BB_FIELD(
      int, redone_audited,
      "attempts before this one, from the same start and as long, after which the straight motion of the "
      "step was not proven free of contact for pairs that collide as audited; from there on every motion "
      "was bounded") = 0;
  BB_FIELD(long long, audited_queries, "those of ccd_queries that such proofs made") = 0;
  BB_FIELD(StepStatus, status, "how it ended") = StepStatus::converged;
  BB_FIELD(std::string, detail,
           "what held it: the pin, the pair, the linear status; empty when it converged");
  BB_FIELD(EndProof, end_proof,
           "what shows that it ended in a minimum of E: a property of the exact matrix at the last iterate, "
           "and of elements at a "
           "cusp of their energy, where there is none") = EndProof::not_checked;
  BB_FIELD(int, cusps,
           "elements at a cusp of their energy where the step was looked at last (a spring whose ends "
           "coincide, a rod folded "
           "back on itself)") = 0;
  BB_FIELD(std::string, first_cusp, "the first of them with its vertices; empty without one");
  BB_FIELD(Number, saddle_curvature_N_per_m,
           "smallest v^T H v / v^T v that was found, at its end or at a saddle that it left; the smallest "
           "eigenvalue of "
           "the exact matrix is not larger",
           "none_found");
  BB_FIELD(Number, end_error_m,
           "how far its end is from the solution: error_estimate_m of the last iteration and what was not "
           "taken of its "
           "direction; of a step that is "
           "not asked to "
           "converge, |dx|_inf of one more Newton direction with its own matrix, which is less than the "
           "error where "
           "that matrix is clamped",
           "not_converged not_estimated");
  BB_FIELD(Number, end_error_tolerances, "end_error_m over dt_s tol_velocity", "not_converged not_estimated");
  BB_FIELD(int, newton_iterations, "Newton iterations") = 0;
  BB_FIELD(SolverCounts, solver, "what its step solver counts beside that");
  BB_FIELD(ContactCounts, contacts, "at its end");
  BB_FIELD(Number, gap_min_m, "smallest gap at its end", "no_contacts not_converged");
  BB_FIELD(Number, gap_min_rel, "smallest d / d_hat of that state", "no_contacts not_converged");
  BB_FIELD(Number, gap_min_ulps,
           "gap_min_m in units of the last place of the largest coordinate, in the run's precision",
           "no_contacts not_converged");
  BB_FIELD(Number, gap_min_iterates_m, "smallest gap of its iterates and its end", "no_contacts");
  BB_FIELD(Number, gap_min_iterates_rel, "smallest d / d_hat of the same states", "no_contacts");
  BB_FIELD(double, alpha_ccd_min, "smallest bound of ACCD") = 1;
  BB_FIELD(Number, max_stretch, "largest sigma - 1 of a limited element at its end", "no_limit");
  BB_FIELD(Number, kappa_min_N_per_m, "smallest kappa of a pair at its end", "no_contacts");
  BB_FIELD(Number, kappa_max_N_per_m, "largest kappa of a pair at its end", "no_contacts");
  BB_FIELD(Number, contact_load_max_N, "largest kappa |b'| of a pair at its end", "no_contacts");
  BB_FIELD(Number, contact_load_sum_N, "sum of kappa |b'| at its end, without mollified rows", "no_contacts");
  BB_FIELD(int, friction_sticking, "contacts with friction that slid by less than eps_v dt in it") = 0;
  BB_FIELD(int, friction_sliding, "contacts with friction that slid farther") = 0;
  BB_FIELD(Number, friction_dissipation_J, "sum over these of friction force times slide", "no_friction");
  BB_FIELD(Number, restitution_dissipation_J,
           "sum over contacts of what restitution takes of the speed of their gaps, force times way",
           "no_restitution");
  BB_FIELD(long long, broken_stitches,
           "stitches that are broken once it is over, those of earlier steps too") = 0;
  BB_FIELD(Number, limit_load_max_N_per_m, "largest (1/area) dS_e/dsigma of triangles at its end",
           "no_limit");
  BB_FIELD(Number, solid_limit_load_max_Pa, "largest (1/volume) dS_e/dsigma of tetrahedra at its end",
           "no_limit");
  BB_FIELD(
      Number, contact_overload,
      "largest load / capacity of a contact where no progress was made; 0: unbounded capacity, or no load",
      no_load_measured);
  BB_FIELD(Number, limit_overload, "the same of a limited element", no_load_measured);
  BB_FIELD(double, kinetic_J, "kinetic energy at its end") = 0;
  BB_FIELD(double, elastic_J, "elastic energy at its end") = 0;
  BB_FIELD(double, limit_J, "S at its end") = 0;
  BB_FIELD(double, contact_J, "B at its end") = 0;
  BB_FIELD(double, gravity_J, "potential of gravity at its end") = 0;
  BB_FIELD(long long, crossings, "that the audit found in its states") = 0;
  BB_FIELD(long long, violations, "that the audit found in its motions and at obstacles") = 0;
  BB_FIELD(long long, unproven, "motions that the audit could not certify") = 0;
  BB_FIELD(long long, inverted, "planar elements, summed over its states") = 0;
  BB_FIELD(Number, surface_gap_obstacles_m,
           "smallest gap of the whole surface to the obstacles at its end, thickness taken off, by the audit",
           no_surface_gap) = Number::missing("not_requested");
  BB_FIELD(Number, surface_gap_between_m,
           "smallest gap between surfaces that is below d_hat at its end, thickness taken off, by the audit",
           no_surface_gap) = Number::missing("not_requested");
  BB_FIELD(Number, wall_s, "in the pass `time`, on a clock of its own",
           "not_reached not_requested build_not_valid");
  BB_FIELD(Number, unaccounted_s, "wall_s minus the sum of all phases",
           "not_reached not_requested build_not_valid");
  BB_FIELD(PhaseTimes, time, "of the pass `time`; empty without it");
  BB_RECORD_END;
};

}  // namespace bb
