// A run in numbers: sums, order statistics and extremes over its steps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/record/run_identity.hpp"
#include "core/base/record/step_record.hpp"

namespace bb {

using CountMap = std::map<std::string, int>;

struct Stats {
  BB_RECORD(Stats, "order statistics of the finite values of a sample");
  BB_FIELD(std::size_t, n, "number of values") = 0;
  BB_FIELD(Number, min, "smallest", "empty");
  BB_FIELD(Number, p05, "5th percentile, interpolated", "empty");
  BB_FIELD(Number, median, "50th percentile", "empty");
  BB_FIELD(Number, p95, "95th percentile", "empty");
  BB_FIELD(Number, max, "largest", "empty");
  BB_FIELD(Number, sum, "sum", "empty");
  BB_RECORD_END;
};
/// Linear interpolation between order statistics. Non-finite entries are left out. Cost O(n log n).
Stats summarize(std::vector<double> sample);

struct StiffnessRecord {
  BB_RECORD(StiffnessRecord, "what the stiffness policy did over the run");
  BB_FIELD(Number, kappa_start_N_per_m, "of a policy with one global kappa: its first");
  BB_FIELD(Number, kappa_end_N_per_m, "its last");
  BB_FIELD(int, doublings, "times it doubled kappa") = 0;
  BB_FIELD(bool, saturated, "whether it ran into its upper bound") = false;
  BB_RECORD_END;
};

struct Conditioning {
  BB_RECORD(Conditioning, "condition estimates of one stage and scaling over the run");
  BB_FIELD(Stats, log10_cond,
           "1e14 for a matrix that is singular or not positive definite; lower bounds count");
  BB_FIELD(Stats, log10_lambda_min, "of the eigenvalues that are known");
  BB_FIELD(Stats, log10_lambda_max, "of the eigenvalues that are known");
  BB_FIELD(CountMap, statuses, "status -> number of samples, all of them");
  BB_RECORD_END;
};
using CondMap = std::map<std::string, Conditioning>;

struct PairGaps {
  BB_RECORD(PairGaps,
            "d / d_hat of the contacts between two bodies at converged step ends, each with the weight kappa "
            "|b'| times the length of its step");
  BB_FIELD(double, load_N, "sum of kappa |b'|, mean over the time of all converged steps") = 0;
  BB_FIELD(double, load_share, "of the load of all pairs") = 0;
  BB_FIELD(double, time_share, "of the time of converged steps, those at whose end there was load") = 0;
  BB_FIELD(double, gap_rel_p05, "5 % of the load is carried at smaller gaps; right to 1.1 %") = 0;
  BB_FIELD(double, gap_rel_median, "half of it is") = 0;
  BB_FIELD(double, gap_rel_p95, "95 % of it is") = 0;
  BB_RECORD_END;
};
using GapMap = std::map<std::string, PairGaps>;

struct Summary : WorkCounts {
  using BaseRecord = WorkCounts;
  BB_RECORD(Summary, "the run in numbers");
  BB_FIELD(int, steps, "that were run") = 0;
  BB_FIELD(int, steps_capped, "that ended at their iteration cap") = 0;
  BB_FIELD(int, retries, "attempts at steps that failed and were repeated with half their length") = 0;
  BB_FIELD(
      int, redone_audited,
      "steps that were done again with every motion bounded, since they were not proven free of contact for "
      "pairs that collide as audited") = 0;
  BB_FIELD(long long, audited_queries, "those of ccd_queries that such proofs made") = 0;
  BB_FIELD(Number, dt_min_s, "shortest step");
  BB_FIELD(long long, newton_iterations, "over all steps") = 0;
  BB_FIELD(Stats, newton_per_step, "Newton iterations of a step");
  BB_FIELD(SolverCounts, solver, "what the step solver counts beside that, over the steps");
  BB_FIELD(std::string, convergence,
           "not_asked: the step solver stops by another rule, so that a step that is over need not be near a "
           "solution",
           "asked not_asked") = "asked";
  BB_FIELD(Stats, end_error_tolerances, "end_error_tolerances of the steps that ended as they should");
  BB_FIELD(CountMap, end_proofs, "end_proof -> steps that ended as they should");
  BB_FIELD(Number, saddle_curvature_N_per_m, "smallest of the steps", "none_found");
  BB_FIELD(Stats, linear_per_solve, "iterations of the linear solver");
  BB_FIELD(Stats, probe_pcg, "probe_pcg_iterations of the trace");
  BB_FIELD(Stats, contacts, "pairs in contact at the end of a step");
  BB_FIELD(Stats, gap_min_rel, "smallest d / d_hat of each converged step end");
  BB_FIELD(Number, gap_min_m, "smallest gap over converged step ends", "no_contacts not_converged");
  BB_FIELD(Number, gap_min_ulps,
           "smallest over converged step ends, in units of the last place of the largest coordinate",
           "no_contacts not_converged");
  BB_FIELD(Number, gap_min_iterates_m, "smallest gap over all iterates", "no_contacts");
  BB_FIELD(Number, gap_min_iterates_rel, "smallest d / d_hat over all iterates", "no_contacts");
  BB_FIELD(GapMap, contact_gaps,
           "body|body or body|obstacle -> at what gaps their load was carried; pairs with load alone, rows "
           "without mollifier");
  BB_FIELD(CountMap, first_contact,
           "body|body or body|obstacle -> step at whose end they first had an active contact row");
  BB_FIELD(Number, max_stretch, "largest sigma - 1 of a limited element over step ends", "no_limit");
  BB_FIELD(Number, contact_load_max_N, "largest of the steps", "no_contacts");
  BB_FIELD(long long, broken_stitches,
           "stitches that are broken at the end of the run, the largest of the steps") = 0;
  BB_FIELD(Number, limit_load_max_N_per_m, "largest of the steps", "no_limit");
  BB_FIELD(Number, solid_limit_load_max_Pa, "largest of the steps", "no_limit");
  BB_FIELD(StiffnessRecord, stiffness, "policies with one global kappa");
  BB_FIELD(CondMap, cond,
           "stage/scaling -> condition numbers of clamped matrices, solved/stage/scaling of those that were "
           "solved where they differ");
  BB_FIELD(double, start_check_s,
           "what looking for crossings at the start and along the given motions took, before the calibration "
           "run and the "
           "first step; in no phase") = 0;
  BB_FIELD(Number, wall_s, "of the steps of the pass `time`", "not_requested build_not_valid");
  BB_FIELD(Number, solve_s, "sum of all phases but output", "not_requested build_not_valid");
  BB_FIELD(Number, unaccounted_s, "wall_s minus the sum of all phases", "not_requested build_not_valid");
  BB_FIELD(PhaseTimes, time, "sums over the steps of the pass `time`; empty without it");
  BB_FIELD(std::uint64_t, peak_rss_bytes, "resident memory of the process") = 0;
  BB_FIELD(std::string, state_hash, "sha256 of the final positions, little-endian float64", sha256_or_empty);
  BB_RECORD_END;
};

}  // namespace bb
