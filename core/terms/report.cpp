#include "core/terms/report.hpp"

#include <algorithm>
#include <cstdio>

namespace bb {
namespace {

constexpr double settled_kappa = 0.01;    // a change below it leaves Newton alone
constexpr int unsettled_iterations = 10;  // that many above it in a row are a cycle, not a transient

bool cycles(int unsettled) { return unsettled >= unsettled_iterations; }

std::string unsettled(const char* whose, double change, int iterations) {
  char text[180];
  std::snprintf(
      text, sizeof text,
      "%s kappa does not settle: refreshed in every iteration, it still changes by a factor of %.3g "
      "after %d iterations",
      whose, 1 + change, iterations);
  return text;
}

/// Counts on or starts again; returns the change, 0 where there is none.
double follow(const Number& change, int& unsettled) {
  const double value = change.finite() ? change.value : 0;
  unsettled = in_a_row(unsettled, value > settled_kappa);
  return value;
}

}  // namespace

IterateNumbers::IterateNumbers() {
  gap_min_iterates_m = gap_min_iterates_rel = kappa_min_N_per_m = kappa_max_N_per_m =
      contact_curvature_max_N_per_m = contact_load_max_N = Number::missing("no_contacts");
  contraction = error_estimate_m = Number::missing("not_estimated");
  kappa_change_rel = 0;
  limit_kappa_change_rel = limit_gap_min_rel = max_stretch = limit_load_max_N_per_m =
      solid_limit_load_max_Pa = Number::missing("no_limit");
}

void IterateNumbers::forget_changes() {
  kappa_change_rel = Number::missing("first_iteration");
  if (limit_kappa_change_rel.finite()) limit_kappa_change_rel = Number::missing("first_iteration");
}

StepNumbers::StepNumbers() {
  gap_min_m = gap_min_rel = gap_min_ulps = gap_min_iterates_m = gap_min_iterates_rel = kappa_min_N_per_m =
      kappa_max_N_per_m = contact_load_max_N = contact_load_sum_N = Number::missing("no_contacts");
  friction_dissipation_J = Number::missing("no_friction");
  restitution_dissipation_J = Number::missing("no_restitution");
  max_stretch = limit_load_max_N_per_m = solid_limit_load_max_Pa = Number::missing("no_limit");
  saddle_curvature_N_per_m = Number::missing("none_found");
  end_error_m = end_error_tolerances = Number::missing("not_estimated");
}

void StepNumbers::add(const IterateNumbers& iterate) {
  *this += iterate;
  kappa_change = follow(iterate.kappa_change_rel, kappa_unsettled);
  limit_kappa_change = follow(iterate.limit_kappa_change_rel, limit_kappa_unsettled);
  alpha_ccd_min = std::min(alpha_ccd_min, iterate.alpha_ccd);
  keep_smaller(gap_min_iterates_m, iterate.gap_min_iterates_m);
  keep_smaller(gap_min_iterates_rel, iterate.gap_min_iterates_rel);
}

void StepNumbers::close() {
  keep_smaller(gap_min_iterates_m, gap_min_m);
  keep_smaller(gap_min_iterates_rel, gap_min_rel);
  const bool converged = status == StepStatus::converged;
  if (!converged) {
    end_proof = EndProof::not_checked;
    cusps = 0;
    first_cusp.clear();
    end_error_m = end_error_tolerances = Number::missing("not_converged");
  }
  if (!converged) gap_min_m = gap_min_rel = gap_min_ulps = Number::missing("not_converged");
  contact_overload = limit_overload = Number::missing(converged ? "converged" : "not_measured");
}

std::string StepNumbers::describe_unsettled() const {
  std::string text;
  if (cycles(kappa_unsettled)) text = unsettled("the contacts'", kappa_change, newton_iterations);
  if (!cycles(limit_kappa_unsettled)) return text;
  return text + (text.empty() ? "" : "; ") +
         unsettled("the strain limit's", limit_kappa_change, newton_iterations);
}

}  // namespace bb
