// L of D = L L^T, D the identity, the diagonal, or the diagonal vertex blocks of A. The block-Jacobi
// preconditioner and the scaled condition numbers are both made of it.
#pragma once

#include <vector>

#include "core/linear/condition.hpp"
#include "core/linear/linear_solver.hpp"

namespace bb {

class BlockScaling {
 public:
  /// @return ok | matrix_indefinite (a diagonal block, so A too, is not positive definite beyond rounding) |
  ///         preconditioner_indefinite (a block is singular within rounding) | non_finite
  /// Errors: ConfigError when block_start does not cut 0 .. n into blocks of 1 to 3.
  LinearStatus setup(const ReducedSystem& system, Scaling scaling);
  /// After a failed setup: a degree of freedom of the first block that is to blame.
  int bad_dof() const { return bad_dof_; }
  Scaling scaling() const { return scaling_; }

  void multiply_lower(VecXd& x) const;  // x <- L x
  void multiply_upper(VecXd& x) const;  // x <- L^T x
  void solve_lower(VecXd& x) const;     // x <- L^-1 x
  void solve_upper(VecXd& x) const;     // x <- L^-T x
  /// x = D^-1 b, with the bits of solve_lower() and solve_upper() of b, four blocks abreast. x is resized and must not be b.
  void solve(const VecXd& b, VecXd& x) const;
  /// u^T D u in long double.
  long double quadratic(const VecXd& u) const;
  /// matrix <- scale * matrix + shift * D. Every entry of D must be stored, which one of A's own is.
  void add_to(Eigen::SparseMatrix<double>& matrix, double scale, double shift) const;

 private:
  void read_blocks(const ReducedSystem& system);
  LinearStatus factorize_block(std::size_t block);
  void place_abreast();
  void solve_four(std::size_t group, const VecXd& b, VecXd& x) const;

  Scaling scaling_ = Scaling::none;
  int bad_dof_ = -1;
  std::vector<int> start_;    // [n_blocks + 1]
  std::vector<Mat3d> d_, l_;  // identity beyond the size of the block
  std::vector<double>
      fours_;  // L of four blocks after one another: 00, 11, 22, 10, 20, 21 of each; identity beyond the last
};

}  // namespace bb
