#include "core/terms/executor/hessian_request.hpp"

#include <cmath>

namespace bb::exec {

HessianRequest hessian_request(StepHessian choice, double t, double threshold, const double* force) {
  HessianRequest out;
  out.first = first_projection(choice);
  if (choice == StepHessian::progressive && threshold == 0) out.first = Projection::psd;
  if (choice == StepHessian::progressive && threshold > 0 && std::isfinite(threshold)) {
    out.threshold = threshold;
    out.force = force;
  }
  const bool blends = choice == StepHessian::blend || choice == StepHessian::exact_or_clamped;
  if (!blends || t == 0) return out;
  if (choice == StepHessian::exact_or_clamped || t == 1) {
    out.first = Projection::psd;
  } else {
    out.t = t;
  }
  return out;
}

}  // namespace bb::exec
