// One end of the spectrum of B on its way from a Ritz value to an eigenvalue that a factor has proven to be the last.
#pragma once

#include <limits>

#include "core/linear/lanczos.hpp"
#include "core/linear/scaled_matrix.hpp"

namespace bb {

inline constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
inline constexpr double end_tolerance =
    2e-4;  // of an eigenvalue, relative; half of the 1e-3 promised is left to spare
inline constexpr int most_shifted_solves = 6;  // round a shifted factor, one of which polishes the vector

struct SpectrumEndPair {
  double lambda = not_known;
  VecXd vector;
  bool resolved = false;
  bool by_lanczos = false;           // our own, where Spectra ran first and did not converge
  bool shifted = false;              // found round a factorisation of its own
  bool proven = false;               // a factor shows that nothing lies further than 8e-4 beyond it
  double uncertainty = 0;            // residual relative to the eigenvalue of the operator in use
  double proven_inside = not_known;  // the end is known to lie beyond this; NaN when nothing is proven
};

/// Shifts just beyond the end that `end` approximates from inside and repeats Lanczos from its vector. A factor that
/// exists proves the shift to lie beyond the whole spectrum, one that does not exist that it lies inside.
/// @param sign +1 the small end, A - sigma D; -1 the large end, sigma D - A
/// @param largest lambda_max of B
void resolve_by_shift(ScaledMatrix& b, double sign, double largest, SpectrumEndPair& end);

/// A small residual may belong to a neighbour of the end. A factor of the matrix shifted by 8e-4 beyond it exists only
/// when nothing lies there (Sylvester's law of inertia); without one the end is looked for again. Not tested where the
/// shift is within the rounding of the factorisation: then `proven` stays false.
void prove_end(ScaledMatrix& b, double sign, double largest, SpectrumEndPair& end);

}  // namespace bb
