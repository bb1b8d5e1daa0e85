// The last eigenvalue of a symmetric operator by the solvers of Spectra (Qiu, spectralib.org): Lanczos with implicit
// restarts, which looks at convergence whenever its basis is full.
#pragma once

#include "core/linear/lanczos.hpp"

namespace bb {

struct SpectraEnd {
  bool converged =
      false;  // residual at most tol times |value|, by Spectra's own estimate; else nothing below is known
  double value = 0;  // of the operator C
  VecXd vector;      // |vector| = 1
};

/// The largest eigenvalue of C (SymEigsSolver).
/// @param op  C, symmetric; scaled inside, since Spectra compares small numbers with a fixed one
/// @param start  of the first basis; not zero
/// @param most  applications of C at most; a restart that would need more ends the search without a result
/// Cost: at most `most` applications; a basis of 20 vectors.
SpectraEnd spectra_largest(const SymmetricOperator& op, const VecXd& start, int most, double tol);

/// The same for C = B^-1, given by solves with the factor of B, in the shift-invert mode at shift 0 (SymEigsShiftSolver):
/// value is the largest eigenvalue of B^-1, one over the smallest of B. Cost: as above with a basis of 10 vectors.
SpectraEnd spectra_smallest_inverted(const SymmetricOperator& solve, const VecXd& start, int most,
                                     double tol);

}  // namespace bb
