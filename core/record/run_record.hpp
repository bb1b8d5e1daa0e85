// What one run leaves behind, as plain values: run.json is exactly this struct (writer.hpp), the trace beside
// it holds one TraceRow a Newton iteration. Keys and units: configs/schema/run.schema.json.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/record/number.hpp"
#include "core/record/outcome.hpp"
#include "core/record/phase_times.hpp"
#include "core/record/trace_row.hpp"

namespace bb {

/// Of run.json and of the trace beside it. MODEL.REVISION.ADDITION: removed or changed meaning, widened,
/// added. Readers check the first number; what an earlier version of the same model lacks is optional in the
/// schemas.
inline constexpr const char* kRunSchemaVersion = "2.0.0";

struct Ids {
  std::string config_id;   // sha256 of the canonical resolved config
  std::string run_id;      // sha256 of all that made the record (fill_ids)
  std::string build_id;    // sha256 of the executable
  std::string machine_id;  // sha256 of processor model, core count, kernel
  std::string sweep_id;    // empty: none
  std::string rerun_of;    // run_id of the record that this run repeats; empty: none
  int repetition = 0;
  std::vector<std::string> parent_ids;  // runs this one was calibrated from (pilot)
};

struct Status {
  Outcome outcome = Outcome::ok;
  std::string detail;  // one sentence; empty when ok
  int exit_code = 0;
  std::string started_utc, ended_utc;  // ISO 8601
};

/// What tables group by; every value is derived from the config and never read back.
struct Labels {
  std::string scene, formulation, shape, argument, stiffness_policy, matching_rule;
  std::string integrator, step_solver, linear_solver, preconditioner, precision;
  double d_hat_m = 0, dt_s = 0;
  std::string note;  // how the row of a table differs ("as_given", "scaled"), empty: nothing
};

/// Sizes of the scene after it was built.
struct SceneSize {
  std::size_t vertices = 0, free_dofs = 0, triangles = 0, springs = 0, hinges = 0, obstacles = 0;
  double extent_m = 0;                             // largest side of the start box
  std::map<std::string, std::string> mesh_sha256;  // file, relative to the record's folder -> sha256
};

/// A plugin that was loaded. In a record `file` is relative to the folder of the record.
struct PluginFile {
  std::string name, file, sha256;
};

/// The BLAS behind the factorisations: another kernel adds in another order and gives other bits.
struct BlasRecord {
  std::string kernel;     // the one that ran, in OpenBLAS's words: "Haswell", "SkylakeX"
  std::string requested;  // OPENBLAS_CORETYPE; "native" without: OpenBLAS chose by the processor
  std::string config;     // openblas_get_config()
  std::string library;    // file that holds dgemm
  int threads = 1;
};

struct Provenance {
  std::string tool_version, git_commit;
  bool git_dirty = false;
  std::string compiler, flags, build_type;
  bool fast_math = false;
  std::string fp_contract;
  std::map<std::string, std::string> libraries;  // name -> version
  std::vector<PluginFile> plugins;
  std::vector<std::string> argv;
  std::map<std::string, std::string> env;  // thread counts and the like
  int threads = 1;
  BlasRecord blas;
};

struct Machine {
  std::string cpu_model, governor, os, kernel;
  int cores = 0;
  std::uint64_t mem_bytes = 0;
  double load_avg[3] = {0, 0, 0};
  bool virtualised = false;
};

/// Order statistics of a sample; everything missing when n = 0.
struct Stats {
  std::size_t n = 0;
  Number min, p05, median, p95, max, sum;
};
/// Linear interpolation between order statistics. Non-finite entries are left out. Cost O(n log n).
Stats summarize(std::vector<double> sample);

struct StepRecord {
  int step = 0;
  double t_s = 0;           // at the end of the step
  std::string status;       // StepStatus word
  std::string stop_reason;  // why Newton stopped
  int newton_iterations = 0, linear_iterations = 0, linear_solves = 0, factorizations = 0, analyses = 0;
  int line_search_trials = 0, rounding_accepts = 0, not_pd = 0;
  long long ccd_queries = 0, ccd_probes = 0, ccd_capped = 0, ccd_zero = 0;
  ContactCounts contacts;  // at the end of the step
  Number gap_min_m;        // smallest at the end of the step; missing where the step did not converge
  Number gap_min_rel;      // smallest d / d_hat of that state
  Number gap_min_iterates_m, gap_min_iterates_rel;  // the same over the iterates of the step and its end
  Number toi_min;                                   // smallest ACCD bound of the step
  Number max_stretch;                               // largest sigma - 1 over the accepted states
  Number kappa_min_N_per_m, kappa_max_N_per_m;
  Number contact_load_max_N, limit_load_max_N_per_m, contact_load_sum_N;
  Number contact_overload, limit_overload;  // load / capacity of a step that made no progress
  Number kinetic_J, elastic_J, limit_J, contact_J, gravity_J;  // at the end of the step
  long long crossings = 0, violations = 0, unproven = 0, inverted = 0;
  /// Of the pass `time`, empty without it: seconds of the step on a clock of its own, seconds of every phase,
  /// and what the step took beyond their sum.
  Number wall_s, unaccounted_s;
  PhaseTimes time;
};

/// How kappa was chosen (docs/design.md, Matching).
struct MatchingRecord {
  std::string rule = "as_given";
  Number theta;
  Number load_N;              // per unit multiplicity; of a pilot, the load of `contact`
  Number d_hat_m;             // at which it was matched: of `contact`
  Number limit_load_N_per_m;  // the strain limit's; of a pilot, that of `limit_element`
  Number curvature_N_per_m, limit_curvature;
  Number kappa_N_per_m;            // chosen; missing when the policy makes its own
  Number limit_stiffness_N_per_m;  // k_s chosen
  Number scale;                    // s applied to a policy that makes its own kappa
  Number limit_scale;              // s applied to a limit policy that makes its own kappa_e
  Number capacity_N;               // largest load the shape carries at that kappa; missing when unbounded
  // of load_N and limit_load_N_per_m: given, pilot, static_weight (the pilot met none), none
  std::string load_source = "none", limit_load_source = "none";
  // the pilot's contact and limited element that asked for the most stiffness, the steps at whose ends they
  // did, and how many of all steps were compared; missing where the pilot was not asked or met none
  std::string contact, limit_element;
  Number contact_step, limit_step;
  long long contacts_considered = 0, elements_considered = 0;
  // the note says where a pilot stopped early, and which policies stay as given for want of a measured load
  std::string pilot_config_id, pilot_note;
};

struct AuditRecord {
  bool enabled = false;
  long long edges = 0, triangles = 0, vertices = 0, obstacles = 0;  // the surface that there is to judge
  long long states = 0, motions = 0;                                // checked
  long long state_pairs = 0, motion_pairs = 0;  // that met in the broad phase and were judged one by one
  long long obstacle_queries = 0;               // signs of vertices, and of their paths, to an obstacle
  long long judged = 0;  // primitives compared with all that they may meet, boxes included; 0: never ok
  long long crossings = 0, touches = 0, violations = 0, unproven = 0, inverted = 0;
  long long obstacle_violations = 0;  // those of `violations` that an obstacle is part of
  long long scene_faults = 0;  // prescribed primitives that cross or cannot be certified; in no other count
  int first_bad_step = -1, first_bad_iteration = -1;
  std::vector<std::string> examples;  // the first few, in words
  double seconds = 0;
};

struct Check {
  std::string name;
  Number value, bound;
  bool pass = false;
};
struct Validity {
  bool valid = false;  // every check passed
  std::vector<Check> checks;
};

/// One line of the plan: what the scene needs, and what is neither allocated nor run.
struct PlanLine {
  std::string item;
  bool active = false;
  std::string reason;
};
struct Skipped {
  std::string metric, reason;  // reason: not_applicable, not_requested, budget, dominated
};

/// What the stiffness policy did over the run.
struct StiffnessRecord {
  Number kappa_start_N_per_m, kappa_end_N_per_m;
  int doublings = 0;
  bool saturated = false;
};

/// Whether a run may be compared with the others of its sweep (docs/design.md, Comparability). Filled by
/// one function, judge_comparability(); readers never compute it again.
struct Comparability {
  std::string verdict = "no_reference";  // comparable, not_comparable, no_reference, not_valid
  std::string reason;                    // one sentence, never empty in a record
  std::string reference_run;             // folder of the reference beside this run's; empty: none
  std::string reference_run_id;
  Number gap_rel, reference_gap_rel;  // smallest d/d_hat over converged step ends
  Number ratio;                       // gap_rel / reference_gap_rel
  double max_ratio = 2;               // comparable: ratio within [1/max_ratio, max_ratio]
};

struct Summary {
  int steps = 0, steps_capped = 0;
  long long newton_iterations = 0, linear_iterations = 0, linear_solves = 0, factorizations = 0, analyses = 0;
  long long line_search_trials = 0, ccd_queries = 0, ccd_probes = 0, ccd_capped = 0, not_pd = 0;
  Stats newton_per_step, linear_per_solve, probe_pcg, contacts, gap_min_rel;
  Number gap_min_m;                                 // over converged step ends, as gap_min_rel
  Number gap_min_iterates_m, gap_min_iterates_rel;  // over all iterates
  Number max_stretch, contact_load_max_N, limit_load_max_N_per_m;
  StiffnessRecord stiffness;
  std::map<std::string, int>
      first_contact;  // "body|body" or "body|obstacle" -> step at whose end it first touched
  /// Over all samples of the run, key "<stage>/<scaling>". log10_cond: a lower bound stands for its cond, and
  /// a matrix that is singular or not positive definite has the bound 1e14; only an estimate that did not
  /// converge has no number. The eigenvalues are those that are known. `statuses` counts every sample.
  struct Conditioning {
    Stats log10_cond, log10_lambda_min, log10_lambda_max;
    std::map<std::string, int> statuses;
  };
  std::map<std::string, Conditioning> cond;
  /// Of the pass `time`, sums over its steps: wall_s = sum of all phases + unaccounted_s; solve_s: of all
  /// phases but output.
  Number wall_s, solve_s, unaccounted_s;
  PhaseTimes time;
  std::uint64_t peak_rss_bytes = 0;
  std::string state_hash;  // sha256 of the final positions, little-endian float64
};

struct Artifact {
  std::string path, kind, media_type, sha256;
  std::uint64_t bytes = 0;
};

struct Passes {
  bool time = false, diagnose = false, audit = false;
};

struct RunRecord {
  Ids ids;
  Status status;
  Labels labels;
  Passes passes;
  std::string config_json = "{}";  // resolved, every default filled in
  SceneSize scene;
  Provenance provenance;
  Machine machine;
  std::vector<PlanLine> plan;
  std::vector<Skipped> skipped;
  MatchingRecord matching;
  Summary summary;
  std::vector<StepRecord> steps;
  std::map<std::string, std::vector<double>> samples;  // raw repetitions, name with its unit
  AuditRecord audit;
  Validity validity;
  Comparability comparability;
  std::vector<Artifact> artifacts;
};

}  // namespace bb
