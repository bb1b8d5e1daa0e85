// What was judged of a run: its audit, its checks, its build, and whether it may be compared with others.
#pragma once

#include <string>
#include <vector>

#include "core/base/record/run_identity.hpp"
#include "core/base/record/step_record.hpp"

namespace bb {

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
  BB_FIELD(long long, overlaps,
           "primitives beyond an obstacle at the end of a step by no more than the step solver promises, "
           "summed over "
           "steps; in no other count") = 0;
  BB_FIELD(Number, overlap_max_m, "deepest of them", "none") = Number::missing("none");
  BB_FIELD(Number, promised_m,
           "what the step solver promises to stay within at the end of a step, beyond an obstacle: there "
           "obstacles are judged, with this tolerance; none: in every state and motion, with none",
           "none") = Number::missing("none");
  BB_FIELD(long long, corners_cut,
           "with a promise: primitives whose straight way over a step goes beyond a sphere or a cylinder, "
           "and stays out of half of its radius, summed over steps") = 0;
  BB_FIELD(std::string, obstacles_judge,
           "surface: all of the surface; points: its vertices, since /contact/model is points; then "
           "surface_gap_obstacles_m reports how deep the surface between them is in an obstacle, and "
           "crossings and "
           "violations among surfaces decide nothing") = "surface";
  BB_FIELD(long long, scene_faults,
           "prescribed primitives that cross or cannot be certified; in no other count") = 0;
  BB_FIELD(int, first_bad_step, "-1: none", "-1") = -1;
  BB_FIELD(long long, step_end_crossings_max,
           "most crossings and primitives beyond an obstacle in the state at the end of a step") = 0;
  BB_FIELD(long long, step_end_crossings_last, "those at the end of the last step") = 0;
  BB_FIELD(int, recovered_step,
           "last step that ended without any after one that ended with some: the run freed itself; -1: none",
           "-1") = -1;
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
  BB_RECORD(BuildValidity, "the validity block of the build (docs/theory/audit.md, Validity)");
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
  BB_FIELD(std::string, verdict, "docs/theory/audit.md, Comparability",
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
  BB_FIELD(Number, pair_ratio, "pair_gap_rel / pair_reference_gap_rel; overlap: one of them is not above 0",
           "no_contacts no_reference overlap");
  BB_FIELD(double, max_ratio,
           "comparable: pair_ratio within [1/max_ratio, max_ratio], so that of every pair with load is") = 2;
  BB_RECORD_END;
};

}  // namespace bb
