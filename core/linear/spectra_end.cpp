#include "core/linear/spectra_end.hpp"

#include <Spectra/SymEigsShiftSolver.h>
#include <Spectra/SymEigsSolver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bb {
namespace {

// Bases that cost least on the Newton matrices of the drape: applications are the price, and Spectra looks only when a
// basis is full.
constexpr int product_basis = 20, solve_basis = 10;

struct BudgetSpent {};

/// C over a number near its largest eigenvalue: Spectra calls a pair converged by a residual below tol eps^(2/3) too,
/// which is no small number beside the eigenvalues of a stiff matrix's inverse.
class CountedOperator {
 public:
  using Scalar = double;
  CountedOperator(const SymmetricOperator& op, Eigen::Index n, int most) : op_(op), n_(n), left_(most) {}
  Eigen::Index rows() const { return n_; }
  Eigen::Index cols() const { return n_; }
  void set_shift(double) {}  // the factor is that of the matrix itself
  double scale() const { return scale_; }

  void perform_op(const double* x, double* y) const {
    if (left_-- <= 0) throw BudgetSpent();
    in_ = VecXd::Map(x, n_);
    op_(in_, out_);
    if (scale_ == 0) {
      scale_ = out_.norm() / in_.norm();
      if (!(scale_ > 0) || !std::isfinite(scale_))
        throw std::runtime_error("an operator that is 0 or not finite");
    }
    VecXd::Map(y, n_) = out_ / scale_;
  }

 private:
  const SymmetricOperator& op_;
  Eigen::Index n_;
  // Spectra applies a const operator.
  mutable int left_;
  mutable double scale_ = 0;
  mutable VecXd in_, out_;
};

/// Whether C v is value v up to `tol` of it. Spectra goes by estimates of residuals, and where a Krylov space is exhausted its
/// vector may be none of C's.
bool is_pair(const SymmetricOperator& c, double value, const VecXd& v, double tol) {
  if (!std::isfinite(value) || !v.allFinite()) return false;
  VecXd image;
  c(v, image);
  return (image - value * v).norm() <= tol * std::abs(value) * v.norm();
}

/// value(eigenvalue as Spectra gives it, scale): that of C.
template <class Solver, class Value>
SpectraEnd find(Solver& solver, const SymmetricOperator& c, const CountedOperator& op, const VecXd& start,
                Spectra::SortRule rule, double tol, const Value& value) {
  SpectraEnd end;
  try {
    solver.init(start.data());
    end.converged = solver.compute(rule, std::numeric_limits<int>::max(), tol, rule) == 1;
  } catch (const BudgetSpent&) {
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // of Spectra, on numbers that are not finite
  }
  if (!end.converged) return end;
  end.value = value(solver.eigenvalues()[0], op.scale());
  end.vector = solver.eigenvectors(1).col(0);
  end.converged = is_pair(c, end.value, end.vector, tol);
  return end;
}

}  // namespace

SpectraEnd spectra_largest(const SymmetricOperator& op, const VecXd& start, int most, double tol) {
  const Eigen::Index n = start.size();
  if (n < 2) return {};  // Spectra needs a space beside the eigenvector
  CountedOperator counted(op, n, most);
  Spectra::SymEigsSolver<CountedOperator> solver(counted, 1, std::min<Eigen::Index>(n, product_basis));
  return find(solver, op, counted, start, Spectra::SortRule::LargestAlge, tol,
              [](double nu, double scale) { return nu * scale; });
}

SpectraEnd spectra_smallest_inverted(const SymmetricOperator& solve, const VecXd& start, int most,
                                     double tol) {
  const Eigen::Index n = start.size();
  if (n < 2) return {};
  CountedOperator counted(solve, n, most);
  Spectra::SymEigsShiftSolver<CountedOperator> solver(counted, 1, std::min<Eigen::Index>(n, solve_basis),
                                                      0.0);
  return find(solver, solve, counted, start, Spectra::SortRule::LargestMagn, tol,
              [](double lambda, double scale) { return scale / lambda; });
}

}  // namespace bb
