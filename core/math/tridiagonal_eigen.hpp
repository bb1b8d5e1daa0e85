// Eigenvalues and eigenvectors of symmetric matrices from about 5 x 5 on: Householder reduction to a
// tridiagonal matrix, then implicit QL. A third to a quarter of the work of Jacobi rotations there. Plain
// loops of bounded length, so that the device runs the same code.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/types.hpp"

namespace bb::detail {

/// One reflection I - beta v v^T that leaves only the first entry (`target`) of x.
template <class T, int N>
struct Reflection {
  Vec<T, N> v = Vec<T, N>::Zero();  // entries before `first` are 0
  T beta = 0, target = 0;

  BB_HD Reflection() = default;
  BB_HD Reflection(const Mat<T, N, N>& a, int column) {
    using std::sqrt;
    const int first = column + 1;
    T below = 0;
    for (int i = first + 1; i < N; ++i) below += a(i, column) * a(i, column);
    target = a(first, column);
    if (below == 0) return;  // not for NaN, which has to come through
    const T length = sqrt(below + target * target);
    for (int i = first + 1; i < N; ++i) v[i] = a(i, column);
    v[first] = target > 0 ? target + length : target - length;
    beta = 2 / (below + v[first] * v[first]);
    target = target > 0 ? -length : length;
  }
};

/// A = q T q^T, T tridiagonal with diagonal d and e[i] = T(i, i + 1). Reads all of A, destroys it.
template <class T, int N>
BB_HD inline void tridiagonalise(Mat<T, N, N>& a, Vec<T, N>& d, Vec<T, N>& e, Mat<T, N, N>& q) {
  Reflection<T, N> reflections[N > 2 ? N - 2 : 1];
  for (int k = 0; k + 2 < N; ++k) {
    const Reflection<T, N> r = reflections[k] = Reflection<T, N>(a, k);
    e[k] = r.target;
    if (r.beta == 0) continue;
    Vec<T, N> p = Vec<T, N>::Zero();
    for (int j = k + 1; j < N; ++j) {
      for (int i = k + 1; i < N; ++i) p[i] += r.v[j] * a(i, j);
    }
    p *= r.beta;
    const Vec<T, N> w = p - (r.beta / 2 * r.v.dot(p)) * r.v;
    for (int j = k + 1; j < N; ++j) {
      for (int i = k + 1; i < N; ++i) a(i, j) -= r.v[i] * w[j] + w[i] * r.v[j];
    }
  }
  d = a.diagonal();
  e[N - 2] = a(N - 1, N - 2);
  e[N - 1] = 0;
  q.setIdentity();
  for (int k = N - 3; k >= 0; --k) {
    const Reflection<T, N>& r = reflections[k];
    if (r.beta == 0) continue;
    for (int j = k + 1; j < N; ++j) {
      T sum = 0;
      for (int i = k + 1; i < N; ++i) sum += r.v[i] * q(i, j);
      sum *= r.beta;
      for (int i = k + 1; i < N; ++i) q(i, j) -= sum * r.v[i];
    }
  }
}

/// One implicit QL sweep on rows first .. last of T with Wilkinson's shift; rotates the columns of q along.
template <class T, int N>
BB_HD inline void ql_sweep(int first, int last, Vec<T, N>& d, Vec<T, N>& e, Mat<T, N, N>& q) {
  using std::sqrt;
  T g = (d[first + 1] - d[first]) / (2 * e[first]);
  const T root = sqrt(1 + g * g);
  g = d[last] - d[first] + e[first] / (g + (g < 0 ? -root : root));
  T s = 1, c = 1, p = 0;
  for (int i = last - 1; i >= first; --i) {
    const T f = s * e[i], b = c * e[i];
    const T r = sqrt(f * f + g * g);
    e[i + 1] = r;
    if (r == 0) {  // the matrix splits here
      d[i + 1] -= p;
      e[last] = 0;
      return;
    }
    const T inverse = 1 / r;
    s = f * inverse;
    c = g * inverse;
    const T shifted = d[i + 1] - p, h = (d[i] - shifted) * s + 2 * c * b;
    p = s * h;
    d[i + 1] = shifted + p;
    g = c * h - b;
    const Vec<T, N> left = q.col(i), right = q.col(i + 1);
    q.col(i + 1) = s * left + c * right;
    q.col(i) = c * left - s * right;
  }
  d[first] -= p;
  e[first] = g;
  e[last] = 0;
}

/// a = q diag(d) q^T, in no order. a: symmetric, largest entry about 1; destroyed. An off-diagonal entry
/// counts as 0 below rounding of its two neighbours on the diagonal, or below the square of rounding. Cost:
/// about 2 sweeps an eigenvalue, at most 30.   Source: Golub and Van Loan, Matrix Computations, 8.3;
/// EISPACK's tred2 and imtql2.
template <class T, int N>
BB_HD inline void tridiagonal_eigen(Mat<T, N, N>& a, Vec<T, N>& d, Mat<T, N, N>& q) {
  using std::abs;
  constexpr T eps = std::numeric_limits<T>::epsilon();
  Vec<T, N> e;
  tridiagonalise<T, N>(a, d, e, q);
  for (int first = 0; first < N; ++first) {
    for (int sweep = 0; sweep < 30; ++sweep) {
      int last = first;
      while (last + 1 < N && !(abs(e[last]) <= eps / 4 * (abs(d[last]) + abs(d[last + 1])) + eps * eps))
        ++last;
      if (last == first) break;
      ql_sweep<T, N>(first, last, d, e, q);
    }
  }
}

}  // namespace bb::detail
