// The eigenvectors at both ends of the spectrum of a scaled matrix: which unknowns make it ill-conditioned.
#pragma once

#include <cstdint>
#include <optional>

#include "core/linear/condition.hpp"

namespace bb {

/// Of B = L^-1 A L^-T, L L^T the scaling. `vector` has length 1; `unscaled` = L^-T vector, so that unscaled^T A
/// unscaled = lambda.
struct EndVector {
  VecXd vector, unscaled;
  double lambda = 0;
};
struct EndVectors {
  EndVector smallest, largest;
};

/// By Lanczos on B^-1 round the Cholesky factor of A, and on B.
/// @param seed  of the start vectors
/// @return nothing when A or its scaling is not positive definite, or when a Ritz vector leaves a residual above 1e-2 of
///         its eigenvalue: then no vector says where the end lives
/// Errors: as ConditionEstimator.   Cost: one factorisation, at most 60 solves and 300 products.
std::optional<EndVectors> end_vectors(const ReducedSystem& system, Scaling scaling, std::uint64_t seed);

}  // namespace bb
