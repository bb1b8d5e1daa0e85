// The largest eigenvalue of a symmetric operator by Lanczos with full reorthogonalisation: for a given number
// of products nothing with short recurrences or restarts does better.
#pragma once

#include <cstdint>
#include <functional>

#include "core/math/types.hpp"

namespace bb {

/// y = C x, C symmetric; y is resized.
using SymmetricOperator = std::function<void(const VecXd& x, VecXd& y)>;

struct LanczosEnd {
  double value = 0;     // largest Ritz value: not above the largest eigenvalue, barring rounding
  double smallest = 0;  // smallest Ritz value
  double residual = 0;  // |C v - value v|, |v| = 1
  VecXd vector;         // the Ritz vector v
  int steps = 0;        // products used
  /// The residual alone, relative to |value|. The gap to the second Ritz value would allow a larger one, but
  /// it shows nothing about an eigenvalue that the start vector has next to nothing of.
  bool converged(double tol) const;
};

/// @param start  any vector that is not orthogonal to the wanted one; not zero
/// @param n_max  steps at most; ends early once converged(tol) four times in a row
/// Cost: steps products and O(n steps^2) flops; a basis of n x (steps + 1) doubles.
LanczosEnd lanczos_largest(const SymmetricOperator& op, const VecXd& start, int n_max, double tol);

/// Entries uniform in [-1, 1) from mt19937_64: the same on every platform.
VecXd seeded_vector(Eigen::Index n, std::uint64_t seed);

}  // namespace bb
