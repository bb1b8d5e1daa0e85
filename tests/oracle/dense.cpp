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

Spectrum spectrum(const MatXl& a) {
  const Eigen::SelfAdjointEigenSolver<MatXl> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}
Spectrum spectrum(const MatXl& a, const MatXl& d) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatXl> solver(a, d);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VecXl singular_values(const MatXl& a) { return Eigen::JacobiSVD<MatXl>(a).singularValues(); }

Long determinant(const MatXl& a) { return a.determinant(); }

MatXd clamped(const MatXd& a) {
  const Spectrum own = spectrum(a.cast<Long>());
  return compose(own.vectors, own.values.cwiseMax(0.0L), own.vectors).cast<double>();
}

VecXd solve(const MatXd& a, const VecXd& b) {
  return a.cast<Long>().ldlt().solve(b.cast<Long>()).cast<double>();
}

std::optional<VecXl> only_solution(const MatXl& a, const VecXl& b) {
  const Eigen::FullPivLU<MatXl> lu(a);
  return lu.isInvertible() ? std::optional<VecXl>(lu.solve(b)) : std::nullopt;
}

MatXd inverse(const MatXd& a) { return MatXl(a.cast<Long>()).inverse().cast<double>(); }

VecXl least_squares(const MatXl& a, const VecXl& b) { return a.colPivHouseholderQr().solve(b); }

MatXl compose(const MatXl& u, const VecXl& s, const MatXl& v) { return u * s.asDiagonal() * v.transpose(); }

Long orthonormality_error(const MatXl& q) {
  return (q.transpose() * q - MatXl::Identity(q.cols(), q.cols())).norm();
}

MatXl orthonormal_basis(const MatXl& a) {
  return Eigen::HouseholderQR<MatXl>(a).householderQ() * MatXl::Identity(a.rows(), a.cols());
}

}  // namespace bb::test
