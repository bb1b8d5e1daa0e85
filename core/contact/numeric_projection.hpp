// Contact Hessians projected from their 12 x 12 numbers alone: directions and weights of the contact are not used.
#pragma once

#include <cstddef>

#include "core/contact/contact_terms.hpp"
#include "core/math/projection.hpp"

namespace bb {

/// Projects n stored Hessians [90 n, lower blocks of 4 points] on all 12 x 12 of each. The first and the last
/// allocate nothing; OpenBLAS takes its work space from a pool of its own.
///   projected_numeric   Eigen's SelfAdjointEigenSolver, as the IPC Toolkit does
///   projected_lapack    LAPACK's dsyev of the OpenBLAS that is linked; dsyevd and dsyevr are no quicker at this size
///   projected_low_rank  four at a time, by a reduction that stops at their rank (low_rank.hpp), fast up to 6 rows, which is
///                       what a contact's five directions leave; more rows cost what a full projection does
/// A Hessian that is not finite stays so. Errors: std::invalid_argument for another mode.
void project_numerically(HessianMode mode, Projection projection, std::size_t n, double* hess);

}  // namespace bb
