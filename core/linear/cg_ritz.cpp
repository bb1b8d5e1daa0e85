#include "core/linear/cg_ritz.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace bb {
namespace {

/// Number of eigenvalues of L D L^T below sigma: negative pivots of L D L^T - sigma I.
std::size_t count_below(const std::vector<double>& alpha, const std::vector<double>& beta, double sigma) {
  std::size_t n_negative = 0;
  double s = -sigma;
  for (std::size_t j = 0; j < alpha.size(); ++j) {
    const double d = 1 / alpha[j];
    double pivot = s + d;
    if (pivot == 0) pivot = -std::numeric_limits<double>::min();
    n_negative += pivot < 0;
    if (j + 1 < alpha.size()) s = beta[j] * s * (d / pivot) - sigma;
  }
  return n_negative;
}

/// Where the count first exceeds `below`, in (0, hi].
double bisect(const std::vector<double>& alpha, const std::vector<double>& beta, std::size_t below,
              double hi) {
  double lo = hi * 1e-40;
  for (int i = 0; i < 200 && hi > lo * (1 + 1e-13); ++i) {
    const double mid = hi > 2 * lo ? std::sqrt(lo) * std::sqrt(hi) : lo + (hi - lo) / 2;
    (count_below(alpha, beta, mid) > below ? hi : lo) = mid;
  }
  return lo + (hi - lo) / 2;
}

}  // namespace

RitzExtremes cg_ritz_extremes(const std::vector<double>& alpha, const std::vector<double>& beta) {
  if (alpha.empty()) return {};
  double bound = 0;  // Gershgorin
  for (std::size_t j = 0; j < alpha.size(); ++j) {
    const double left = j > 0 ? (std::sqrt(beta[j - 1]) + beta[j - 1]) / alpha[j - 1] : 0;
    const double right = j + 1 < alpha.size() ? std::sqrt(beta[j]) / alpha[j] : 0;
    bound = std::max(bound, 1 / alpha[j] + left + right);
  }
  bound *= 1 + 1e-12;
  return {bisect(alpha, beta, 0, bound), bisect(alpha, beta, alpha.size() - 1, bound)};
}

}  // namespace bb
