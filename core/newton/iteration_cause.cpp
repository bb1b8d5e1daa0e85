#include "core/newton/iteration_cause.hpp"

#include <algorithm>
#include <cmath>

namespace bb {
namespace {

constexpr double rounding = 1e-12;  // of a part of the direction that is a product of two others

bool has_direction(const IterationReport& report) {
  return report.solve.linear.status == LinearStatus::ok && std::isfinite(report.dx_inf_m) &&
         std::isfinite(report.decrement_J);
}

}  // namespace

std::string_view to_string(IterationCause cause) {
  constexpr std::string_view words[] = {"full",   "indefinite", "contact", "limit",
                                        "armijo", "noise",      "failed"};
  return words[static_cast<std::size_t>(cause)];
}

bool is_regularised(const IterationReport& report) {
  return report.solve.t > 0 || report.solve.fallbacks() > 0;
}

IterationCause cause_of(const IterationReport& report, double cap_fraction) {
  if (!has_direction(report)) return IterationCause::failed;
  if (report.escapes > 0) return IterationCause::indefinite;
  if (report.rounding_accepts > 0) return IterationCause::noise;
  const double bound = std::min({1.0, report.alpha_ccd, report.alpha_strain});
  const double allowed = bound < 1 ? cap_fraction * bound : 1;
  if (report.alpha < allowed * (1 - rounding)) return IterationCause::armijo;
  if (report.detours > 0 || (bound < 1 && report.alpha_ccd <= report.alpha_strain))
    return IterationCause::contact;
  if (bound < 1) return IterationCause::limit;
  return is_regularised(report) ? IterationCause::indefinite : IterationCause::full;
}

}  // namespace bb
