// Which Hessian a kernel computes at a blend factor of the step.
#pragma once

#include "core/energy/families/element_kernels.hpp"
#include "core/terms/step_hessian.hpp"

namespace bb::exec {

/// What hessian_at (core/newton/hessian_regularisation.hpp) gives. threshold: infinity where no vertex is compared. force: [n_vertices]
/// N, in the executor's memory.
HessianRequest hessian_request(StepHessian choice, double t, double threshold, const double* force);

}  // namespace bb::exec
