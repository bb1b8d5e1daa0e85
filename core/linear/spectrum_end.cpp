#include "core/linear/spectrum_end.hpp"

#include <algorithm>
#include <cmath>

namespace bb {
namespace {

constexpr double kProof = 8e-4;      // of an eigenvalue, relative: distance of a shift that certifies it
constexpr double kProvable = 1e-13;  // of lambda_max: a shift below it is decided by rounding
constexpr int kMaxShifts = 6;        // from the narrowest interval to the widest in steps of six
constexpr int kMaxProofs = 12;  // factorisations that certify one end: from the widest interval to kProof

/// Where a factor proves the end of the spectrum to lie: between `outside` (the factor exists) and `inside`.
/// Halved until it is kProof wide, first tried right beyond `inside`, where a Ritz value usually sits.
void certify(ScaledMatrix& b, double sign, double outside, SpectrumEndPair& end) {
  // A failed shift may have proven more than the Ritz value.
  const bool known = sign * (end.lambda - end.proven_inside) > 0;
  double inside = known ? end.proven_inside : end.lambda;
  const auto wide = [&] { return std::abs(inside - outside) > kProof * std::abs(inside); };
  const double close = inside * (1 - 0.99 * sign * kProof);
  for (int test = 0; test < kMaxProofs && wide(); ++test) {
    const double sigma = test == 0 ? close : inside + (outside - inside) / 2;
    (b.factorize_shifted(sign, sigma) ? outside : inside) = sigma;
  }
  end.resolved = !wide();
  if (inside == end.lambda) return;
  end.proven_inside = inside;
  // An end that is not resolved is a bound: it may not lie beyond the eigenvalue.
  end.lambda = end.resolved ? inside + (outside - inside) / 2 : inside;
}

/// Whether the shift that proves an end is above the rounding of its factorisation.
bool provable(const SpectrumEndPair& end, double largest) {
  return kProof * std::abs(end.lambda) > kProvable * largest;
}

}  // namespace

void resolve_by_shift(ScaledMatrix& b, double sign, double largest, SpectrumEndPair& end) {
  end.shifted = true;
  // Where eigenvalues lie dense the error is about a third of the residual; a failed factorisation shows if
  // not: the start vector had next to nothing of the last eigenvector.
  double width = std::clamp(end.uncertainty, 5e-4, 0.3);
  const double start = end.lambda;
  double sigma = start * (1 - sign * width);
  for (int shift = 1; !b.factorize_shifted(sign, sigma); ++shift) {
    if (shift == kMaxShifts) return;
    end.proven_inside = sigma;
    width = std::min(6 * width, 0.9);
    sigma = start * (1 - sign * width);
  }
  const auto op = [&b](const VecXd& x, VecXd& y) { b.solve(b.matrix().shifted, x, y); };
  // d lambda / lambda = width * d theta / theta, so the operator's own tolerance may be wider by 1 / width.
  const double tol = std::min(end_tolerance / width, 0.05);
  const LanczosEnd ritz = lanczos_largest(op, end.vector, most_shifted_solves - 1, tol);
  if (!(ritz.value > 0)) return;
  b.solve(b.matrix().shifted, ritz.vector, end.vector);
  end.lambda = sigma + sign / ritz.value;
  const bool disproven = sign * (end.lambda - end.proven_inside) > 0;
  end.resolved = ritz.converged(tol) && !disproven;
  if (!end.resolved || provable(end, largest)) certify(b, sign, sigma, end);
  end.proven = end.resolved && provable(end, largest);
}

void prove_end(ScaledMatrix& b, double sign, double largest, SpectrumEndPair& end) {
  if (!provable(end, largest)) return;
  const double sigma = end.lambda * (1 - sign * kProof);
  end.proven = b.factorize_shifted(sign, sigma);
  if (end.proven) return;
  end.resolved = false;
  end.proven_inside = sigma;
  end.uncertainty = 6 * kProof;
  resolve_by_shift(b, sign, largest, end);
}

}  // namespace bb
