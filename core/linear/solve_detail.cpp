#include "core/linear/solve_detail.hpp"

#include <cstdio>

namespace bb {

std::string solve_detail(const LinearReport& report) {
  char text[120] = "";
  if (report.status == LinearStatus::matrix_indefinite) {
    std::snprintf(text, sizeof text, "p^T A p is negative in iteration %d", report.iterations);
  } else if (report.status == LinearStatus::preconditioner_indefinite) {
    std::snprintf(text, sizeof text, "r^T M^-1 r is not positive in iteration %d", report.iterations);
  } else if (report.status == LinearStatus::iteration_cap ||
             report.status == LinearStatus::tolerance_below_rounding) {
    std::snprintf(text, sizeof text, "residual %.3g after %d iterations, tolerance %.3g",
                  report.residual_true, report.iterations, report.tolerance);
  }
  return text;
}

}  // namespace bb
