#include "core/linear/block_scaling.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/linear/block_starts.hpp"
#include "core/linear/parallel.hpp"
#include "core/math/at.hpp"
#include "core/math/lanes.hpp"

namespace bb {
namespace {

constexpr std::size_t blocks_abreast = 4;
using OfFour = Lanes<double, 4>;

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
  if (worst == LinearStatus::ok) place_abreast();
  return worst;
}

void BlockScaling::place_abreast() {
  constexpr int row[] = {0, 1, 2, 1, 2, 2}, column[] = {0, 1, 2, 0, 0, 1};
  fours_.resize(6 * blocks_abreast * ((l_.size() + blocks_abreast - 1) / blocks_abreast));
  for (std::size_t b = 0; b < fours_.size() / 6; ++b) {
    double* to = fours_.data() + 6 * blocks_abreast * (b / blocks_abreast) + b % blocks_abreast;
    for (int k = 0; k < 6; ++k, to += blocks_abreast) {
      *to = b < l_.size() ? l_[b](row[k], column[k]) : (k < 3 ? 1.0 : 0.0);
    }
  }
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
        // A pivot below the rounding of its own subtraction shows nothing.
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

// Numbers that are stored one by one and read as four at once would have to reach the cache first: full blocks go without.
void BlockScaling::solve_four(std::size_t group, const VecXd& b, VecXd& x) const {
  const double* l = fours_.data() + 6 * blocks_abreast * group;
  const auto of = [l](std::size_t k) { return load_lanes<4>(l + blocks_abreast * k); };
  const OfFour l00 = of(0), l11 = of(1), l22 = of(2), l10 = of(3), l20 = of(4), l21 = of(5);
  const auto solve = [&](OfFour& v0, OfFour& v1, OfFour& v2) {
    v0 /= l00;
    v1 = (v1 - l10 * v0) / l11;
    v2 = (v2 - l20 * v0 - l21 * v1) / l22;
    v2 /= l22;
    v1 = (v1 - l21 * v2) / l11;
    v0 = (v0 - l10 * v1 - l20 * v2) / l00;
  };
  const std::size_t first = blocks_abreast * group, beyond = std::min(first + blocks_abreast, l_.size());
  if (start_[beyond] - start_[first] == 12) {
    const double* from = b.data() + start_[first];
    double* to = x.data() + start_[first];
    OfFour v0 = OfFour::Vector{from[0], from[3], from[6], from[9]},
           v1 = OfFour::Vector{from[1], from[4], from[7], from[10]},
           v2 = OfFour::Vector{from[2], from[5], from[8], from[11]};
    solve(v0, v1, v2);
    to[0] = v0[0], to[1] = v1[0], to[2] = v2[0];
    to[3] = v0[1], to[4] = v1[1], to[5] = v2[1];
    to[6] = v0[2], to[7] = v1[2], to[8] = v2[2];
    to[9] = v0[3], to[10] = v1[3], to[11] = v2[3];
    return;
  }
  double gathered[3][blocks_abreast] = {};
  for (std::size_t k = first; k < beyond; ++k) {
    for (int i = start_[k]; i < start_[k + 1]; ++i) gathered[i - start_[k]][k - first] = b[i];
  }
  OfFour v0 = load_lanes<4>(gathered[0]), v1 = load_lanes<4>(gathered[1]), v2 = load_lanes<4>(gathered[2]);
  solve(v0, v1, v2);
  store_lanes(v0, gathered[0]), store_lanes(v1, gathered[1]), store_lanes(v2, gathered[2]);
  for (std::size_t k = first; k < beyond; ++k) {
    for (int i = start_[k]; i < start_[k + 1]; ++i) x[i] = gathered[i - start_[k]][k - first];
  }
}

void BlockScaling::solve(const VecXd& b, VecXd& x) const {
  x.resize(b.size());
  if (scaling_ == Scaling::none) {
    x = b;
    return;
  }
  parallel_items(fours_.size() / (6 * blocks_abreast), 256,
                 [&](std::size_t group) { solve_four(group, b, x); });
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
