// The spectrum that a condition estimate of a scaled matrix has to find, by dense algebra.
#pragma once

#include "core/linear/condition.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::test {

/// Eigenvalues of L^-1 A L^-T, ascending: x with A x = lambda D x, D = L L^T the blocks of the scaling.
inline VecXd scaled_spectrum(const ReducedSystem& system, Scaling scaling) {
  const MatXd a = MatXd(system.lower).selfadjointView<Eigen::Lower>();
  MatXd d = MatXd::Identity(a.rows(), a.cols());
  if (scaling == Scaling::jacobi) d = a.diagonal().asDiagonal();
  if (scaling == Scaling::block_jacobi) {
    for (std::size_t b = 0; b + 1 < system.block_start.size(); ++b) {
      const int begin = system.block_start[b], size = system.block_start[b + 1] - begin;
      d.block(begin, begin, size, size) = a.block(begin, begin, size, size);
    }
  }
  return eigenvalues(a, d);
}

}  // namespace bb::test
