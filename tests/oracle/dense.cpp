#include "tests/oracle/dense.hpp"

#include <Eigen/Dense>

namespace bb::test {

VecXl eigenvalues(const MatXl& a) {
  return Eigen::SelfAdjointEigenSolver<MatXl>(a, Eigen::EigenvaluesOnly).eigenvalues();
}
VecXd eigenvalues(const MatXd& a) { return eigenvalues(MatXl(a.cast<Long>())).cast<double>(); }

VecXd eigenvalues(const MatXd& a, const MatXd& d) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatXl> solver(a.cast<Long>(), d.cast<Long>(),
                                                               Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cast<double>();
}

VecXl singular_values(const MatXl& a) { return Eigen::JacobiSVD<MatXl>(a).singularValues(); }

Long determinant(const MatXl& a) { return a.determinant(); }

MatXd clamped(const MatXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatXl> solver(a.cast<Long>());
  const VecXl values = solver.eigenvalues().cwiseMax(0.0L);
  return compose(solver.eigenvectors(), values, solver.eigenvectors()).cast<double>();
}

VecXd solve(const MatXd& a, const VecXd& b) {
  return a.cast<Long>().ldlt().solve(b.cast<Long>()).cast<double>();
}

VecXl least_squares(const MatXl& a, const VecXl& b) { return a.colPivHouseholderQr().solve(b); }

MatXl compose(const MatXl& u, const VecXl& s, const MatXl& v) { return u * s.asDiagonal() * v.transpose(); }

Long orthonormality_error(const MatXl& q) {
  return (q.transpose() * q - MatXl::Identity(q.cols(), q.cols())).norm();
}

MatXl orthonormal_basis(const MatXl& a) {
  return Eigen::HouseholderQR<MatXl>(a).householderQ() * MatXl::Identity(a.rows(), a.cols());
}

}  // namespace bb::test
