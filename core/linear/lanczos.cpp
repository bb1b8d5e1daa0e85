#include "core/linear/lanczos.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace bb {
namespace {

/// Steps in a row that have to find the same end. A start vector with next to nothing of the last eigenvector
/// converges to its neighbour first; each further step magnifies what is missing.
constexpr int kHeld = 4;

/// Ritz pair at the top of the k x k tridiagonal matrix; beta is what couples it to the next vector.
void read_top(const VecXd& diagonal, const VecXd& off, int k, double beta, LanczosEnd& end, VecXd& weights) {
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
  eigen.computeFromTridiagonal(diagonal.head(k), off.head(k - 1));
  end.value = eigen.eigenvalues()[k - 1];
  end.smallest = eigen.eigenvalues()[0];
  weights = eigen.eigenvectors().col(k - 1);
  end.residual = std::abs(beta * weights[k - 1]);
}

}  // namespace

bool LanczosEnd::converged(double tol) const {
  const double scale = std::abs(value);
  return scale > 0 && residual <= tol * scale;
}

LanczosEnd lanczos_largest(const SymmetricOperator& op, const VecXd& start, int n_max, double tol) {
  const Eigen::Index n = start.size();
  n_max = static_cast<int>(std::min<Eigen::Index>(n_max, n));
  Eigen::MatrixXd basis(n, n_max);
  VecXd diagonal = VecXd::Zero(n_max), off = VecXd::Zero(n_max), weights, w, v = start.normalized();
  LanczosEnd end;
  int held = 0;
  for (int j = 0; j < n_max; ++j) {
    basis.col(j) = v;
    op(v, w);
    ++end.steps;
    diagonal[j] = v.dot(w);
    for (int pass = 0; pass < 2; ++pass) {  // twice is enough (Kahan, Parlett)
      const VecXd overlap = basis.leftCols(j + 1).transpose() * w;
      w.noalias() -= basis.leftCols(j + 1) * overlap;
    }
    double beta = w.norm();
    // Below this the new direction is rounding: the space is invariant.
    const bool exhausted = !(beta > 1e-14 * diagonal.head(j + 1).cwiseAbs().maxCoeff()) || j + 1 == n;
    if (exhausted) beta = 0;
    read_top(diagonal, off, j + 1, beta, end, weights);
    held = end.converged(tol) ? held + 1 : 0;
    if (exhausted || !std::isfinite(end.value) || held == kHeld) break;
    off[j] = beta;
    v = w / beta;
  }
  end.vector = basis.leftCols(end.steps) * weights.head(end.steps);
  return end;
}

VecXd seeded_vector(Eigen::Index n, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  VecXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = static_cast<double>(generator() >> 11) * 0x1p-52 - 1;
  return v;
}

}  // namespace bb
