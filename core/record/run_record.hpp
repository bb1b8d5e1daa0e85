// What one run leaves behind, as plain values: run.json is exactly this struct (writer.hpp), the trace beside
// it holds one TraceRow a Newton iteration.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/record/made_by.hpp"
#include "core/record/outcome.hpp"
#include "core/record/step_record.hpp"

namespace bb {

/// Of run.json and of the trace beside it. MODEL.REVISION.ADDITION: removed or changed meaning, widened,
/// added. Readers refuse another first number.
inline constexpr const char* run_schema_name = "barrierbench.run";
inline constexpr const char* run_schema_version = "3.4.1";
static_assert(run_schema_version[0] == '3', "the pattern of SchemaId::version names the first number too");

using CountMap = std::map<std::string, int>;
using SampleMap = std::map<std::string, std::vector<double>>;

inline constexpr const char* sha256_or_empty = "^([0-9a-f]{64})?$";

/// A JSON object kept as its text.
struct JsonText {
  std::string text = "{}";
};

struct SchemaId {
  BB_RECORD(SchemaId, "what the file is");
  BB_FIELD(std::string, name, "always the same", "barrierbench.run") = run_schema_name;
  BB_FIELD(std::string, version, "model.revision.addition", "^3\\.[0-9]+\\.[0-9]+$") = run_schema_version;
  BB_RECORD_END;
};

struct Ids {
  BB_RECORD(Ids, "sha256 of what made the record");
  BB_FIELD(std::string, config_id,
           "of the canonical resolved config without threads; files by content and suffix", sha256_or_empty);
  BB_FIELD(std::string, run_id, "of all: config, executable, libraries, plugins, machine, threads",
           sha256_or_empty);
  BB_FIELD(std::string, build_id, "of the executable", sha256_or_empty);
  BB_FIELD(std::string, machine_id, "of processor model, core count, kernel of the system and card",
           sha256_or_empty);
  BB_FIELD(std::optional<std::string>, sweep_id, "of the sweep that the run is a case of");
  BB_FIELD(std::optional<std::string>, rerun_of, "run_id of the record that this run repeats",
           sha256_or_empty);
  BB_RECORD_END;
};

struct Status {
  BB_RECORD(Status, "how the run ended");
  BB_FIELD(Outcome, outcome, "of several that hold, the first in the order of this list") = Outcome::ok;
  BB_FIELD(std::string, detail, "one sentence; empty when ok");
  BB_FIELD(bool, valid, "every check of `validity` passed") = false;
  BB_FIELD(Number, resumed_from_step, "first step after the checkpoint that the run went on from",
           "whole") = Number::missing("whole");
  BB_FIELD(std::string, started_utc, "ISO 8601");
  BB_FIELD(std::string, ended_utc, "ISO 8601");
  BB_RECORD_END;
};

struct Labels {
  BB_RECORD(Labels, "what tables group by; derived from the config, never read back");
  BB_FIELD(std::string, scene, "name of the scene");
  BB_FIELD(std::string, formulation, "name of the preset, or the shape");
  BB_FIELD(std::string, shape, "b(d; d_hat)");
  BB_FIELD(std::string, argument, "what the shape is applied to");
  BB_FIELD(std::string, stiffness_policy, "how contacts get their kappa");
  BB_FIELD(std::string, integrator, "time integrator");
  BB_FIELD(std::string, step_solver, "order of events in a step");
  BB_FIELD(std::string, linear_solver, "of the Newton step");
  BB_FIELD(std::string, preconditioner, "of pcg; none for others");
  BB_FIELD(std::string, precision, "of the solver");
  BB_FIELD(double, d_hat_m, "width of the contact barrier") = 0;
  BB_FIELD(double, dt_s, "time step") = 0;
  BB_FIELD(std::string, note, "how a row of a table differs; empty: nothing");
  BB_FIELD(TextMap, swept, "of a case of a sweep: pointer -> value as JSON text, of its axes");
  BB_RECORD_END;
};

struct Passes {
  BB_RECORD(Passes, "what was asked for");
  BB_FIELD(bool, time, "a run of its own, timed") = false;
  BB_FIELD(bool, diagnose, "condition estimates and trace") = false;
  BB_FIELD(bool, audit, "exact checks of every state and motion") = false;
  BB_RECORD_END;
};

struct SceneSize {
  BB_RECORD(SceneSize, "sizes of the scene that was built");
  BB_FIELD(std::size_t, vertices, "given and free") = 0;
  BB_FIELD(std::size_t, free_dofs, "degrees of freedom of vertices that are not prescribed") = 0;
  BB_FIELD(std::size_t, triangles, "with a membrane") = 0;
  BB_FIELD(std::size_t, springs, "edges with a spring") = 0;
  BB_FIELD(std::size_t, hinges, "edges that resist bending") = 0;
  BB_FIELD(std::size_t, obstacles, "analytic surfaces") = 0;
  BB_FIELD(double, extent_m, "largest side of the start box") = 0;
  BB_FIELD(TextMap, mesh_sha256, "mesh file, relative to the folder of this record -> sha256");
  BB_RECORD_END;
};

struct PlanLine {
  BB_RECORD(PlanLine, "what the scene needs, and what is neither allocated nor run");
  BB_FIELD(std::string, item, "a part of the program");
  BB_FIELD(bool, active, "whether it runs") = false;
  BB_FIELD(std::string, reason, "why, or why not");
  BB_RECORD_END;
};

struct Skipped {
  BB_RECORD(Skipped, "a measure that the record lacks");
  BB_FIELD(std::string, metric, "time, cond, audit, trace");
  BB_FIELD(std::string, reason, "why", "not_requested build_not_valid");
  BB_RECORD_END;
};

struct MatchingRecord {
  BB_RECORD(MatchingRecord, "how stiffness was chosen (docs/design.md, Matching)");
  BB_FIELD(std::string, rule, "matching rule") = "as_given";
  BB_FIELD(std::string, load_source, "of load_N", "given pilot static_weight none") = "none";
  BB_FIELD(std::string, limit_load_source, "of limit_load_N_per_m",
           "given pilot static_weight none") = "none";
  BB_FIELD(std::string, pilot_config_id, "config_id of the pilot; empty: none", sha256_or_empty);
  BB_FIELD(std::string, pilot_note,
           "where the pilot stopped early; which policies stay as given for want of a measured load");
  BB_FIELD(std::string, contact,
           "the pilot's contact that asked for the most stiffness; empty: none was compared");
  BB_FIELD(Number, contact_step, "step of the pilot, from 0, at whose end it did");
  BB_FIELD(long long, contacts_considered,
           "contacts with a load, over all converged step ends of the pilot") = 0;
  BB_FIELD(Number, contact_answer,
           "d log force/d log stiffness of `contact`: 0 where the world makes the force, 1 where kappa does");
  BB_FIELD(long long, contacts_left_out,
           "contacts whose force follows kappa, so that it is no load, over the same step ends") = 0;
  BB_FIELD(std::string, left_out_contact, "that with the largest force of them; empty: none");
  BB_FIELD(Number, left_out_N, "its force, per unit multiplicity");
  BB_FIELD(std::string, limit_element, "the pilot's limited element that asked for the most; empty: none");
  BB_FIELD(Number, limit_step, "step of the pilot at whose end it did");
  BB_FIELD(long long, elements_considered, "limited elements with a load, over the same step ends") = 0;
  BB_FIELD(Number, limit_answer, "as contact_answer, of `limit_element`");
  BB_FIELD(long long, elements_left_out, "limited elements whose force follows their stiffness") = 0;
  BB_FIELD(std::string, left_out_element, "that with the largest force of them; empty: none");
  BB_FIELD(Number, left_out_N_per_m, "its force over its width");
  BB_FIELD(Number, theta, "fraction of d_hat at which equal_force matches");
  BB_FIELD(Number, load_N, "per unit multiplicity; of a pilot, the load of `contact`");
  BB_FIELD(Number, d_hat_m, "at which the load was matched: of `contact`, else the formulation's");
  BB_FIELD(Number, limit_load_N_per_m, "of the strain limit; of a pilot, the load of `limit_element`");
  BB_FIELD(Number, curvature_N_per_m, "that equal_curvature matched");
  BB_FIELD(Number, limit_curvature, "the same of the strain limit");
  BB_FIELD(Number, kappa_N_per_m, "chosen; absent where the policy makes its own");
  BB_FIELD(Number, limit_stiffness_N_per_m, "k_s chosen");
  BB_FIELD(Number, scale, "factor on a contact policy that makes its own kappa; absent: as given");
  BB_FIELD(Number, limit_scale, "factor on a limit policy that makes its own kappa_e; absent: as given");
  BB_FIELD(Number, capacity_N, "largest load of the shape at that kappa; absent: unbounded");
  BB_RECORD_END;
};

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
  BB_RECORD(
      PairGaps,
      "d / d_hat of the contacts between two bodies at converged step ends, each with the weight m kappa "
      "|b'| times the length of its step");
  BB_FIELD(double, load_N, "sum of m kappa |b'|, mean over the time of all converged steps") = 0;
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
  BB_FIELD(Number, dt_min_s, "shortest step");
  BB_FIELD(long long, newton_iterations, "over all steps") = 0;
  BB_FIELD(Stats, newton_per_step, "Newton iterations of a step");
  BB_FIELD(std::string, convergence,
           "not_asked: the step solver stops by another rule, so that a step that is over need not be near a "
           "solution",
           "asked not_asked") = "asked";
  BB_FIELD(Stats, end_error_tolerances, "end_error_tolerances of the steps that ended as they should");
  BB_FIELD(CountMap, end_proofs, "end_proof -> steps that ended as they should");
  BB_FIELD(Number, saddle_curvature_N_per_m, "smallest of the steps", "none_found");
  BB_FIELD(Stats, linear_per_solve, "iterations of the linear solver");
  BB_FIELD(Stats, probe_pcg, "probe_pcg_iterations of the trace");
  BB_FIELD(Stats, contacts, "rows at the end of a step");
  BB_FIELD(Stats, gap_min_rel, "smallest d / d_hat of each converged step end");
  BB_FIELD(Number, gap_min_m, "smallest gap over converged step ends");
  BB_FIELD(Number, gap_min_ulps,
           "smallest over converged step ends, in units of the last place of the largest coordinate");
  BB_FIELD(Number, gap_min_iterates_m, "smallest gap over all iterates");
  BB_FIELD(Number, gap_min_iterates_rel, "smallest d / d_hat over all iterates");
  BB_FIELD(GapMap, contact_gaps,
           "body|body or body|obstacle -> at what gaps their load was carried; pairs with load alone, rows "
           "without mollifier");
  BB_FIELD(CountMap, first_contact,
           "body|body or body|obstacle -> step at whose end they first had an active contact row");
  BB_FIELD(Number, max_stretch, "largest sigma - 1 of a limited element over step ends");
  BB_FIELD(Number, contact_load_max_N, "largest of the steps");
  BB_FIELD(Number, limit_load_max_N_per_m, "largest of the steps");
  BB_FIELD(StiffnessRecord, stiffness, "policies with one global kappa");
  BB_FIELD(CondMap, cond,
           "stage/scaling -> condition numbers of clamped matrices, solved/stage/scaling of those that were "
           "solved where they differ");
  BB_FIELD(
      double, start_check_s,
      "what looking for crossings at the start and along the given motions took, before the pilot and the "
      "first step; in no phase") = 0;
  BB_FIELD(Number, wall_s, "of the steps of the pass `time`", "not_requested build_not_valid");
  BB_FIELD(Number, solve_s, "sum of all phases but output", "not_requested build_not_valid");
  BB_FIELD(Number, unaccounted_s, "wall_s minus the sum of all phases", "not_requested build_not_valid");
  BB_FIELD(PhaseTimes, time, "sums over the steps of the pass `time`; empty without it");
  BB_FIELD(std::uint64_t, peak_rss_bytes, "resident memory of the process") = 0;
  BB_FIELD(std::string, state_hash, "sha256 of the final positions, little-endian float64", sha256_or_empty);
  BB_RECORD_END;
};

struct AuditRecord {
  BB_RECORD(AuditRecord, "what the audit judged and found");
  BB_FIELD(bool, enabled, "whether the pass `audit` ran") = false;
  BB_FIELD(long long, edges, "of the surface; planar: boundary edges and rods") = 0;
  BB_FIELD(long long, triangles, "of the surface; planar: elements, judged for inversion") = 0;
  BB_FIELD(long long, vertices, "of the surface") = 0;
  BB_FIELD(long long, obstacles, "analytic surfaces") = 0;
  BB_FIELD(long long, states, "that were checked") = 0;
  BB_FIELD(long long, motions, "that were checked") = 0;
  BB_FIELD(long long, state_pairs, "met in the broad phase of states, judged one by one") = 0;
  BB_FIELD(long long, motion_pairs, "met in the broad phase of motions, judged one by one") = 0;
  BB_FIELD(long long, obstacle_queries, "primitives compared with an obstacle, in states and in motions") = 0;
  BB_FIELD(long long, obstacle_vertices,
           "those of obstacle_queries that are vertices: at planes and inside, or alone") = 0;
  BB_FIELD(long long, obstacle_edges, "those that are edges: of rods, outside of spheres and cylinders") = 0;
  BB_FIELD(long long, obstacle_triangles, "those that are triangles, outside of spheres and cylinders") = 0;
  BB_FIELD(long long, judged,
           "primitives compared with all that they may meet, boxes included; 0: never ok") = 0;
  BB_FIELD(long long, crossings,
           "edges through triangles, in states; touches that no small displacement takes apart among them") =
      0;
  BB_FIELD(long long, touches, "other pairs at distance 0, in states") = 0;
  BB_FIELD(long long, violations, "motions through each other, and primitives in or through obstacles") = 0;
  BB_FIELD(long long, unproven, "motions past each other and past obstacles that could not be certified") = 0;
  BB_FIELD(long long, inverted, "planar elements, summed over states") = 0;
  BB_FIELD(long long, obstacle_violations, "those of violations that an obstacle is part of") = 0;
  BB_FIELD(long long, scene_faults,
           "prescribed primitives that cross or cannot be certified; in no other count") = 0;
  BB_FIELD(int, first_bad_step, "-1: none", "-1") = -1;
  BB_FIELD(double, time_s, "what the checks took") = 0;
  BB_FIELD(long long, surface_gaps, "converged step ends at which surface gaps were measured") = 0;
  BB_FIELD(Number, surface_gap_obstacles_m,
           "smallest of the steps' surface_gap_obstacles_m; below 0: thick surfaces are in an obstacle",
           no_surface_gap) = Number::missing("not_requested");
  BB_FIELD(Number, surface_gap_between_m, "smallest of the steps' surface_gap_between_m",
           no_surface_gap) = Number::missing("not_requested");
  BB_FIELD(double, surface_gap_time_s, "what measuring them took; not in time_s") = 0;
  BB_RECORD_END;
};

struct Check {
  BB_RECORD(Check, "one check of a run");
  BB_FIELD(std::string, name, "what is checked");
  BB_FIELD(Number, value, "found");
  BB_FIELD(Number, bound, "allowed");
  BB_FIELD(bool, pass, "whether the value keeps the bound") = false;
  BB_RECORD_END;
};

struct BuildValidity {
  BB_RECORD(BuildValidity, "the validity block of the build (docs/design.md, Validity)");
  BB_FIELD(bool, valid, "every check of the block passed; else the record has no times") = false;
  BB_FIELD(int, checks, "that were made") = 0;
  BB_FIELD(std::string, failed, "names of those that failed; empty: none");
  BB_FIELD(std::string, report_sha256, "of the report; empty: the block was not computed", sha256_or_empty);
  BB_RECORD_END;
};

struct Validity {
  BB_RECORD(Validity, "whether the run counts");
  BB_FIELD(bool, valid, "every check passed") = false;
  BB_FIELD(std::vector<Check>, checks, "one by one");
  BB_FIELD(BuildValidity, build, "of the program that ran");
  BB_RECORD_END;
};

/// Filled by one function, judge_comparability(); readers never compute it again.
struct Comparability {
  BB_RECORD(Comparability, "whether the run may be compared with the others of its sweep");
  BB_FIELD(std::string, verdict, "docs/design.md, Comparability",
           "comparable not_comparable no_reference not_valid") = "no_reference";
  BB_FIELD(std::string, reason, "one sentence");
  BB_FIELD(std::string, reference_run, "folder of the reference, beside this run's; empty: none");
  BB_FIELD(std::string, reference_run_id, "its run_id", sha256_or_empty);
  BB_FIELD(Number, gap_rel, "smallest d / d_hat over converged step ends", "no_contacts");
  BB_FIELD(Number, reference_gap_rel, "the same of the reference", "no_contacts no_reference");
  BB_FIELD(Number, ratio, "gap_rel / reference_gap_rel", "no_reference");
  BB_FIELD(std::string, pair,
           "pair of summary.contact_gaps that disagrees most; empty: nothing was compared");
  BB_FIELD(std::string, pair_quantile, "of its gaps, the one that disagrees most; empty: none",
           "^(gap_rel_(p05|median|p95))?$");
  BB_FIELD(Number, pair_gap_rel, "this quantile; 1 where the pair has no load", "no_contacts no_reference");
  BB_FIELD(Number, pair_reference_gap_rel, "the same of the reference", "no_contacts no_reference");
  BB_FIELD(Number, pair_ratio, "pair_gap_rel / pair_reference_gap_rel", "no_contacts no_reference");
  BB_FIELD(double, max_ratio,
           "comparable: pair_ratio within [1/max_ratio, max_ratio], so that of every pair with load is") = 2;
  BB_RECORD_END;
};

struct Artifact {
  BB_RECORD(Artifact, "a file of the run beside run.json");
  BB_FIELD(std::string, path, "relative to the folder of this record");
  BB_FIELD(std::string, kind, "what it is", "frame frame_scene matrix matrix_side_car trace");
  BB_FIELD(std::string, media_type, "of its format");
  BB_FIELD(std::string, sha256, "of its bytes", sha256_or_empty);
  BB_FIELD(std::uint64_t, bytes, "its size") = 0;
  BB_RECORD_END;
};

struct RunRecord {
  BB_RECORD(RunRecord, "run.json of one run; the version is that of the trace beside it too");
  BB_FIELD(SchemaId, schema, "what the file is");
  BB_FIELD(Ids, ids, "what made it, as hashes");
  BB_FIELD(Status, status, "how it ended");
  BB_FIELD(Labels, labels, "what tables group by");
  BB_FIELD(Passes, passes, "what was asked for");
  BB_FIELD(JsonText, config,
           "resolved, every default filled in, mesh files relative to the folder of this record: `bench run "
           "run.json` repeats the run");
  BB_FIELD(SceneSize, scene, "sizes");
  BB_FIELD(Provenance, provenance, "the program");
  BB_FIELD(Machine, machine, "where it ran");
  BB_FIELD(std::vector<PlanLine>, plan, "what ran and what did not");
  BB_FIELD(std::vector<Skipped>, skipped, "what the record lacks");
  BB_FIELD(MatchingRecord, matching, "how stiffness was chosen");
  BB_FIELD(Summary, summary, "the run in numbers");
  BB_FIELD(std::vector<StepRecord>, steps, "one by one");
  BB_FIELD(SampleMap, samples, "raw repetitions, name with its unit -> values");
  BB_FIELD(AuditRecord, audit, "what was judged");
  BB_FIELD(Validity, validity, "whether the run counts");
  BB_FIELD(Comparability, comparability, "whether it may be compared");
  BB_FIELD(std::vector<Artifact>, artifacts, "files beside it");
  BB_RECORD_END;
};

}  // namespace bb
