// The version of run.json and of the trace beside it, and what its fields meant before. Their present meaning is in
// their BB_FIELD lines.
#pragma once

namespace bb {

/// MODEL.REVISION.ADDITION. The first number counts fields that are gone, and readers refuse another one; the second
/// fields that mean something else (changed_in_run, changed_in_trace) or hold more words; the third those that were added.
inline constexpr const char* run_schema_name = "barrierbench.run";
inline constexpr const char* run_schema_version = "3.11.0";
static_assert(run_schema_version[0] == '3', "the pattern of SchemaId::version names the first number too");

/// A field whose values are not compared with those of records before `since`.
struct ChangedMeaning {
  const char* field;   // its place in the dictionary
  const char* since;   // the first version with the meaning that it has now
  const char* before;  // what it was
};

inline constexpr ChangedMeaning changed_in_run[] = {
    {"comparability.verdict", "3.5.0",
     "comparable: the smallest gap of the run, over all its pairs, within a factor max_ratio of the "
     "reference's"},
    {"comparability.max_ratio", "3.5.0", "of `ratio`, the smallest gaps"},
    {"audit.obstacle_queries", "3.5.0", "vertices alone, and their paths"},
    {"audit.crossings", "3.5.0", "without touches that no small displacement takes apart"},
    {"audit.touches", "3.5.0", "all pairs at distance 0"},
    {"summary.end_error_tolerances", "3.7.0", "as of the steps"},
    {"steps[].end_error_m", "3.7.0", "of the end of the last direction, also where a part of it was taken"},
    {"steps[].end_error_tolerances", "3.7.0", "of that"},
    {"summary.contacts", "3.6.0", "pairs with one closest feature counted once"},
    {"summary.stiffness.kappa_start_N_per_m", "3.6.0",
     "from masses of contacts with pairs with one closest feature counted once"},
    {"summary.stiffness.kappa_end_N_per_m", "3.6.0", "from that start"},
    {"steps[].contacts", "3.6.0", "pairs with one closest feature counted once"},
    {"steps[].kappa_min_N_per_m", "3.6.0", "of pairs with one closest feature their mean"},
    {"steps[].kappa_max_N_per_m", "3.6.0", "of pairs with one closest feature their mean"},
    {"matching.contacts_considered", "3.6.0", "pairs with one closest feature counted once"},
    {"matching.contacts_left_out", "3.6.0", "pairs with one closest feature counted once"},
};

inline constexpr ChangedMeaning changed_in_trace[] = {
    {"contraction", "3.5.0", "the ratio before counted as 0 where it is not known"},
    {"error_estimate_m", "3.5.0", "with that contraction; |dx| itself within rounding"},
    {"energy_change_J", "3.6.0", "0 or the change of E where an update was judged by feasibility alone"},
    {"cond[].tier", "3.5.0", "2: our Lanczos round the factor, which is tier 4 now"},
    {"contacts", "3.6.0", "pairs with one closest feature counted once"},
    {"kappa_min_N_per_m", "3.6.0", "of pairs with one closest feature their mean"},
    {"kappa_max_N_per_m", "3.6.0", "of pairs with one closest feature their mean"},
    {"contact_curvature_max_N_per_m", "3.6.0", "of pairs with one closest feature their sum"},
};

}  // namespace bb
