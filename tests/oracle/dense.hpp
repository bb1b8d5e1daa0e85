// Dense linear algebra by Eigen's own solvers in long double, for matrices of any size; no
// algorithm of core/.
#pragma once

#include <optional>

#include "core/math/types.hpp"

namespace bb::test {

using Long = long double;
using MatXd = Eigen::MatrixXd;
using VecXl = Eigen::Matrix<Long, Eigen::Dynamic, 1>;
using MatXl = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

/// The columns of a matrix below each other.
template <class M>
Vec<typename M::Scalar, Eigen::Dynamic> stacked(const M& matrix) {
  const typename M::PlainObject plain = matrix;
  return Eigen::Map<const Vec<typename M::Scalar, Eigen::Dynamic>>(plain.data(), plain.size());
}
/// The matrix whose stacked() columns are v.
template <int R, int C, class T>
Mat<T, R, C> unstacked(const Vec<T, Eigen::Dynamic>& v) {
  return Eigen::Map<const Mat<T, R, C>>(v.data(), R, v.size() / R);
}

/// Eigenvalues of a symmetric matrix, ascending.
VecXd eigenvalues(const MatXd& a);
VecXl eigenvalues(const MatXl& a);
/// Those of a x = lambda d x, d symmetric positive definite.
VecXd eigenvalues(const MatXd& a, const MatXd& d);
/// Values ascending, vectors in columns: a v = value v, or of two matrices a v = value d v with v^T d v = 1.
struct Spectrum {
  VecXl values;
  MatXl vectors;
};
Spectrum spectrum(const MatXl& a);
Spectrum spectrum(const MatXl& a, const MatXl& d);
/// Descending.
VecXl singular_values(const MatXl& a);
Long determinant(const MatXl& a);

/// Negative eigenvalues of a symmetric matrix set to zero.
MatXd clamped(const MatXd& a);
/// a x = b, a symmetric.
VecXd solve(const MatXd& a, const VecXd& b);
/// The x with a x = b, a square; none where a is singular.
std::optional<VecXl> only_solution(const MatXl& a, const VecXl& b);
MatXd inverse(const MatXd& a);
/// The x of least |a x - b|; a of any rank and shape.
VecXl least_squares(const MatXl& a, const VecXl& b);

/// u diag(s) v^T.
MatXl compose(const MatXl& u, const VecXl& s, const MatXl& v);
/// |q^T q - 1|, Frobenius.
Long orthonormality_error(const MatXl& q);
/// Orthonormal columns that span those of a.
MatXl orthonormal_basis(const MatXl& a);

}  // namespace bb::test
