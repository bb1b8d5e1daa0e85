#include "core/contact/numeric_projection.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "core/math/lanes.hpp"
#include "core/math/low_rank.hpp"
#include "core/math/lower_blocks.hpp"

extern "C" void dsyev_(const char* job, const char* triangle, const int* n, double* a, const int* lda,
                       double* values, double* work, const int* n_work, int* info);

namespace bb {
namespace {

using Matrix = Mat<double, 12, 12>;
constexpr std::size_t n_numbers = n_lower_numbers(4);

/// Calls entry(i, j, k) for the lower triangle: (i, j) of the matrix is number k of its blocks.
template <class Entry>
void for_each_lower(const Entry& entry) {
  int k = 0;
  for (int b = 0; b < 4; ++b) {
    for (int a = b; a < 4; ++a, k += 9) {
      for (int c = 0; c < 3; ++c) {
        for (int r = a == b ? c : 0; r < 3; ++r) entry(3 * a + r, 3 * b + c, k + 3 * c + r);
      }
    }
  }
}

Matrix lower_triangle(const double* hess) {
  Matrix out = Matrix::Zero();
  for_each_lower([&](int i, int j, int k) { out(i, j) = hess[k]; });
  return out;
}

/// Stores the matrix of these eigenvalues, the least first, unless none of them has to change.
void store(Vec<double, 12> values, const Matrix& vectors, Projection projection, double* hess) {
  if (values[0] >= 0) return;
  for (double& value : values) value = project_eigenvalue(value, projection);
  const Matrix scaled = vectors * values.asDiagonal();
  Matrix full;
  full.noalias() = scaled * vectors.transpose();
  store_lower_blocks(4, full, hess);
}

void project_by_eigen(Projection projection, double* hess) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(lower_triangle(hess));
  store(eigen.eigenvalues(), eigen.eigenvectors(), projection, hess);
}

void project_by_lapack(Projection projection, double* hess) {
  constexpr int n = 12, n_work = 408;  // 34 n: what dsyev requests with blocks of 32
  double work[n_work];
  Vec<double, 12> values;
  Matrix a = lower_triangle(hess);
  int info = 0;
  dsyev_("V", "L", &n, a.data(), &n, values.data(), work, &n_work, &info);
  if (info != 0) values.setConstant(std::numeric_limits<double>::quiet_NaN());
  store(values, a, projection, hess);
}

/// Four Hessians; what is missing to four is made up by the first of them.
void project_by_rank(Projection projection, std::size_t n, double* hess) {
  using L = Lanes<double, 4>;
  constexpr int rows =
      6;  // a contact's Hessian is zero but in five directions; any other is right too, and slower
  Mat<L, 12, 12> full;
  for_each_lower([&](int i, int j, int k) {
    L entry;
    for (std::size_t lane = 0; lane < 4; ++lane) {
      entry.v[lane] = hess[n_numbers * (lane < n ? lane : 0) + static_cast<std::size_t>(k)];
    }
    full(i, j) = full(j, i) = entry;
  });
  full = project_low_rank<rows>(full, projection);
  for (std::size_t lane = 0; lane < n; ++lane) {
    store_lower_blocks(4, full, hess + n_numbers * lane,
                       [lane](const L& number) { return number[static_cast<int>(lane)]; });
  }
}

}  // namespace

void project_numerically(HessianMode mode, Projection projection, std::size_t n, double* hess) {
  if (!is_numeric(mode)) throw std::invalid_argument("project_numerically: no mode of its own");
  if (mode == HessianMode::projected_low_rank) {
    for (std::size_t r = 0; r < n; r += 4)
      project_by_rank(projection, std::min<std::size_t>(4, n - r), hess + n_numbers * r);
    return;
  }
  const auto project_one = mode == HessianMode::projected_lapack ? project_by_lapack : project_by_eigen;
  for (std::size_t r = 0; r < n; ++r) project_one(projection, hess + n_numbers * r);
}

}  // namespace bb
