// What the energy tests share: finite differences in long double over a ladder of steps, an independent PSD
// projection, random rotations, and the loop over the registry of membrane models.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string_view>

#include "core/energy/membrane_list.hpp"
#include "core/energy/terms.hpp"

namespace bb::test {

using Long = long double;

/// Smallest relative error, over steps 1e-2 .. 1e-9, of fourth-order differences of f: R^N -> R^M against
/// `jacobian` [M x N]; relative to its largest entry. Infinite when the jacobian is zero, so that nothing
/// passes by being empty.
template <int N, int M, class F>
double jacobian_error(const F& f, const Vec<Long, N>& x, const Mat<double, M, N>& jacobian) {
  const double scale = jacobian.cwiseAbs().maxCoeff();
  if (!(scale > 0)) return std::numeric_limits<double>::infinity();
  double best = std::numeric_limits<double>::infinity();
  for (Long h = 1e-2L; h > 0.5e-9L; h /= 10) {
    double worst = 0;
    for (int j = 0; j < N; ++j) {
      const auto at = [&](Long step) {
        Vec<Long, N> moved = x;
        moved[j] += step;
        return Vec<Long, M>(f(moved));
      };
      const Vec<Long, M> column = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
      worst = std::max(worst, (column.template cast<double>() - jacobian.col(j)).cwiseAbs().maxCoeff());
    }
    best = std::min(best, worst / scale);
  }
  return best;
}

/// Negative eigenvalues set to zero, by Eigen's solver.
template <int N>
Mat<double, N, N> clamped(const Mat<double, N, N>& a) {
  const Eigen::SelfAdjointEigenSolver<Mat<double, N, N>> solver(a);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
         solver.eigenvectors().transpose();
}

template <class A, class B>
double relative_difference(const A& a, const B& b, double scale) {
  return (a - b).cwiseAbs().maxCoeff() / scale;
}

inline Mat3d random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

/// The N points of a stacked vector, and back.
template <class T, int N>
struct Points {
  Vec<T, 3> x[N];
  template <class Stacked>
  explicit Points(const Stacked& stacked) {
    for (int i = 0; i < N; ++i) x[i] = stacked.template segment<3>(3 * i).template cast<T>();
  }
};

/// Calls f.operator()<Model>(name) for every line of registry.inc.
template <class F>
void for_each_model(const F& f) {
#define ENTRY(name, doc) f.template operator()<membrane::name>(#name);
#include "core/energy/registry.inc"
#undef ENTRY
}

}  // namespace bb::test
