// Extreme Ritz values that conjugate gradients leave behind for free.
#pragma once

#include <vector>

namespace bb {

struct RitzExtremes {
  double min = 0, max = 0;
};

/// Extreme eigenvalues of the Lanczos matrix of k CG steps, T = L D L^T with D_j = 1/alpha_j and
/// L_{j+1,j}^2 = beta_j; of the preconditioned matrix when CG was preconditioned.
/// @param alpha [k] step lengths, > 0
/// @param beta  [k - 1] or more, ratios of successive r^T M^-1 r
/// @return      both to 1e-12 relative, the smallest too: the factored form keeps it. 0, 0 when k = 0.
/// Cost: about 100 passes over k.   Source: Golub, Van Loan 2013, 11.3.4; Dhillon, Parlett 2004 (stationary
/// qds).
RitzExtremes cg_ritz_extremes(const std::vector<double>& alpha, const std::vector<double>& beta);

}  // namespace bb
