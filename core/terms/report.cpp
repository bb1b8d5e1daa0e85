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

}  // namespace

void StepNumbers::add(const IterateNumbers& iterate) {
  kappa_unsettled = in_a_row(kappa_unsettled, iterate.kappa_change > settled_kappa);
  kappa_change = iterate.kappa_change;
  limit_kappa_unsettled = in_a_row(limit_kappa_unsettled, iterate.limit_kappa_change > settled_kappa);
  limit_kappa_change = iterate.limit_kappa_change;
  alpha_ccd_min = std::min(alpha_ccd_min, iterate.alpha_ccd);
  ccd_queries += iterate.bound.queries;
  ccd_probes += iterate.bound.probes;
  ccd_capped += iterate.bound.capped;
  ccd_zero += iterate.bound.zero;
}

std::string StepNumbers::describe_unsettled(int iterations) const {
  std::string text;
  if (cycles(kappa_unsettled)) text = unsettled("the contacts'", kappa_change, iterations);
  if (!cycles(limit_kappa_unsettled)) return text;
  return text + (text.empty() ? "" : "; ") + unsettled("the strain limit's", limit_kappa_change, iterations);
}

}  // namespace bb
