// The estimator dense of the condition number: all eigenvalues of the dense matrix. For tests and small systems.
#pragma once

#include "core/linear/block_scaling.hpp"
#include "core/linear/condition.hpp"

namespace bb {

/// Eigenvalues of L^-1 A L^-T. n > 3000 is not_converged. Cost: O(n^3), n^2 doubles.
ConditionEstimate estimate_dense(const ReducedSystem& system, const BlockScaling& scaling);

}  // namespace bb
