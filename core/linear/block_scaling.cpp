#include "core/linear/block_scaling.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/linear/block_starts.hpp"
#include "core/linear/parallel.hpp"
#include "core/math/at.hpp"

namespace bb {
namespace {

/// x <- f(L_b) x_b for every block.
template <class F>
void for_blocks(const std::vector<int>& start, const std::vector<Mat3d>& l, VecXd& x, const F& f) {
  parallel_items(static_cast<int>(l.size()), 1024, [&](int b) {
    const int begin = start[at(b)], size = start[at(b) + 1] - begin;
    Vec3d v = Vec3d::Zero();
    for (int i = 0; i < size; ++i) v[i] = x[begin + i];
    f(l[at(b)], v);
    for (int i = 0; i < size; ++i) x[begin + i] = v[i];
  });
}

}  // namespace

LinearStatus BlockScaling::setup(const ReducedSystem& system, Scaling scaling) {
  scaling_ = scaling;
  const Eigen::Index n = system.lower.rows();
  d_.clear();
  l_.clear();
  if (scaling == Scaling::block_jacobi) {
    check_block_starts(system);
    start_ = system.block_start;
  } else {
    start_.resize(static_cast<std::size_t>(n) + 1);
    std::iota(start_.begin(), start_.end(), 0);
  }
  if (scaling == Scaling::none) return LinearStatus::ok;
  read_blocks(system);
  LinearStatus worst = LinearStatus::ok;
  for (std::size_t b = 0; b < d_.size(); ++b) {
    const LinearStatus status = factorize_block(b);
    if (status == LinearStatus::matrix_indefinite || status == LinearStatus::non_finite) return status;
    if (status == LinearStatus::ok || worst != LinearStatus::ok) continue;
    worst = status;
    bad_dof_ = start_[b];
  }
  return worst;
}

void BlockScaling::read_blocks(const ReducedSystem& system) {
  d_.assign(start_.size() - 1, Mat3d::Identity());
  l_.assign(d_.size(), Mat3d::Identity());
  for (std::size_t b = 0; b < d_.size(); ++b) {
    const int begin = start_[b], size = start_[b + 1] - begin;
    d_[b].topLeftCorner(size, size).setZero();
    for (int c = 0; c < size; ++c) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(system.lower, begin + c); it; ++it) {
        const int r = static_cast<int>(it.row()) - begin;
        if (r >= size) break;
        d_[b](r, c) += it.value();
        if (r != c) d_[b](c, r) += it.value();
      }
    }
  }
}

LinearStatus BlockScaling::factorize_block(std::size_t block) {
  const Mat3d& d = d_[block];
  Mat3d& l = l_[block];
  if (!d.allFinite()) return LinearStatus::non_finite;
  bool positive = true;
  for (int c = 0; c < 3 && positive; ++c) {
    for (int r = c; r < 3; ++r) {
      double sum = d(r, c);
      for (int k = 0; k < c; ++k) sum -= l(r, k) * l(c, k);
      if (r == c) {
        // A pivot below the rounding of its own subtraction says nothing.
        positive = sum > 4 * std::numeric_limits<double>::epsilon() * d(c, c) && sum > 0;
        if (!positive) break;
        l(c, c) = std::sqrt(sum);
      } else {
        l(r, c) = sum / l(c, c);
        l(c, r) = 0;
      }
    }
  }
  if (positive) return LinearStatus::ok;
  const Eigen::SelfAdjointEigenSolver<Mat3d> eigen(d, Eigen::EigenvaluesOnly);
  const Vec3d& lambda = eigen.eigenvalues();
  const double rounding = 32 * std::numeric_limits<double>::epsilon() * lambda.cwiseAbs().maxCoeff();
  return lambda[0] < -rounding ? LinearStatus::matrix_indefinite : LinearStatus::preconditioner_indefinite;
}

void BlockScaling::multiply_lower(VecXd& x) const {
  for_blocks(start_, l_, x, [](const Mat3d& l, Vec3d& v) { v = l.triangularView<Eigen::Lower>() * v; });
}
void BlockScaling::multiply_upper(VecXd& x) const {
  for_blocks(start_, l_, x,
             [](const Mat3d& l, Vec3d& v) { v = l.triangularView<Eigen::Lower>().transpose() * v; });
}
void BlockScaling::solve_lower(VecXd& x) const {
  for_blocks(start_, l_, x, [](const Mat3d& l, Vec3d& v) {
    v[0] /= l(0, 0);
    v[1] = (v[1] - l(1, 0) * v[0]) / l(1, 1);
    v[2] = (v[2] - l(2, 0) * v[0] - l(2, 1) * v[1]) / l(2, 2);
  });
}
void BlockScaling::solve_upper(VecXd& x) const {
  for_blocks(start_, l_, x, [](const Mat3d& l, Vec3d& v) {
    v[2] /= l(2, 2);
    v[1] = (v[1] - l(2, 1) * v[2]) / l(1, 1);
    v[0] = (v[0] - l(1, 0) * v[1] - l(2, 0) * v[2]) / l(0, 0);
  });
}

long double BlockScaling::quadratic(const VecXd& u) const {
  long double sum = 0;
  if (scaling_ == Scaling::none) {
    for (const double v : u) sum += static_cast<long double>(v) * v;
    return sum;
  }
  for (std::size_t b = 0; b < d_.size(); ++b) {
    for (int c = 0; c < start_[b + 1] - start_[b]; ++c) {
      for (int r = 0; r < start_[b + 1] - start_[b]; ++r) {
        sum += static_cast<long double>(d_[b](r, c)) * u[start_[b] + r] * u[start_[b] + c];
      }
    }
  }
  return sum;
}

void BlockScaling::add_to(Eigen::SparseMatrix<double>& matrix, double scale, double shift) const {
  matrix.coeffs() *= scale;
  for (std::size_t b = 0; b + 1 < start_.size(); ++b) {
    const int begin = start_[b], end = start_[b + 1];
    for (int c = begin; c < end; ++c) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, c); it && it.row() < end; ++it) {
        const int r = static_cast<int>(it.row());
        const double d = scaling_ == Scaling::none ? (r == c ? 1.0 : 0.0) : d_[b](r - begin, c - begin);
        it.valueRef() += shift * d;
      }
    }
  }
}

}  // namespace bb
