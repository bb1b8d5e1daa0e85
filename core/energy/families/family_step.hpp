// One time step, as families of elements see it.
#pragma once

namespace bb {

/// Columns are memory of the executor of the family, and valid for the step.
struct FamilyStep {
  const double *x_n = nullptr, *x_tilde = nullptr;   // [3 n_vertices] m, start of the step and prediction
  double dt = 0, c = 1, load_factor = 1, t_end = 0;  // as in StepColumns (core/terms/term.hpp)
  bool at_start = false;
  /// s, in the middle of the step: what acts then acts in the whole of it, whatever the ends of spans are rounded to.
  double middle() const { return at_start ? t_end + dt / 2 : t_end - dt / 2; }
};

}  // namespace bb
