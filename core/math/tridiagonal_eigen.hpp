// Eigenvalues and eigenvectors of symmetric matrices from about 5 x 5 on: Householder reduction to a
// tridiagonal matrix, then implicit QL. A third to a quarter of the work of Jacobi rotations there. Plain
// loops of bounded length, so that the device runs the same code.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/select.hpp"
#include "core/math/types.hpp"

namespace bb::detail {

/// One reflection I - beta v v^T that leaves only the first entry (`target`) of x.
template <class T, int N>
struct Reflection {
  Vec<T, N> v = Vec<T, N>::Zero();  // entries before `first` are 0
  T beta = T(0), target = T(0);

  BB_HD Reflection() = default;
  BB_HD Reflection(const Mat<T, N, N>& a, int column) {
    using std::sqrt;
    const int first = column + 1;
    T below(0);
    for (int i = first + 1; i < N; ++i) below += a(i, column) * a(i, column);
    target = a(first, column);
    // Entries of a matrix of size 1 whose squares are no normal numbers are far below its rounding, and 2 over their
    // sum may overflow. False for NaN, which has to come through.
    const MaskOf<T> done = below < T(std::numeric_limits<typename ScalarOf<T>::type>::min());
    if (!any(!done)) return;
    const T length = sqrt(below + target * target);
    for (int i = first + 1; i < N; ++i) v[i] = a(i, column);
    v[first] = select(target > T(0), target + length, target - length);
    beta = select(done, T(0), T(2) / (below + v[first] * v[first]));
    target = select(done, target, select(target > T(0), -length, length));
  }
};

/// (I - beta v v^T) a (I - beta v v^T) of a symmetric a, v zero before `first`: rows and columns from `first`
/// on are written, and stay symmetric bit for bit.
template <class T, int N>
BB_HD inline void reflect_symmetric(int first, const Vec<T, N>& v, T beta, Mat<T, N, N>& a) {
  Vec<T, N> p = Vec<T, N>::Zero();
  for (int j = first; j < N; ++j) {
    for (int i = first; i < N; ++i) p[i] += v[j] * a(i, j);
  }
  p *= beta;
  const Vec<T, N> w = p - (beta / T(2) * v.dot(p)) * v;
  for (int j = first; j < N; ++j) {
    for (int i = first; i < N; ++i) a(i, j) -= v[i] * w[j] + w[i] * v[j];
  }
}

/// A = q T q^T, T tridiagonal with diagonal d and e[i] = T(i, i + 1). Reads all of A, destroys it.
template <class T, int N>
BB_HD inline void tridiagonalise(Mat<T, N, N>& a, Vec<T, N>& d, Vec<T, N>& e, Mat<T, N, N>& q) {
  Reflection<T, N> reflections[N > 2 ? N - 2 : 1];
  for (int k = 0; k + 2 < N; ++k) {
    const Reflection<T, N> r = reflections[k] = Reflection<T, N>(a, k);
    e[k] = r.target;
    if (!any(!(r.beta == T(0)))) continue;
    reflect_symmetric<T, N>(k + 1, r.v, r.beta, a);
  }
  d = a.diagonal();
  e[N - 2] = a(N - 1, N - 2);
  e[N - 1] = T(0);
  q.setIdentity();
  for (int k = N - 3; k >= 0; --k) {
    const Reflection<T, N>& r = reflections[k];
    if (!any(!(r.beta == T(0)))) continue;
    for (int j = k + 1; j < N; ++j) {
      T sum(0);
      for (int i = k + 1; i < N; ++i) sum += r.v[i] * q(i, j);
      sum *= r.beta;
      for (int i = k + 1; i < N; ++i) q(i, j) -= sum * r.v[i];
    }
  }
}

/// One implicit QL sweep with Wilkinson's shift on rows first .. last of T, last the first row from `first`
/// on whose rotation is not `active` any more; rotates the columns of q along.
template <class T, int N>
BB_HD inline void ql_sweep(int first, const MaskOf<T> (&active)[N], Vec<T, N>& d, Vec<T, N>& e,
                           Mat<T, N, N>& q) {
  using std::sqrt;
  const T slope = (d[first + 1] - d[first]) / (T(2) * e[first]);
  const T root = sqrt(T(1) + slope * slope);
  const T shift = e[first] / (slope + select(slope < T(0), -root, root));
  T s(1), c(1), p(0), g(0);
  MaskOf<T> whole = true;  // false from the row on where the matrix splits
  for (int i = N - 2; i >= first; --i) {
    if (!any(active[i])) continue;
    const MaskOf<T> starts = active[i] && !active[i + 1];
    g = select(starts, d[i + 1] - d[first] + shift, g);
    const MaskOf<T> reached = active[i] && whole;
    const T f = s * e[i], b = c * e[i];
    const T r = sqrt(f * f + g * g);
    whole = whole && !(active[i] && r == T(0));
    const MaskOf<T> turns = active[i] && whole;
    e[i + 1] = select(reached && !starts, r, select(starts, T(0), e[i + 1]));
    const T inverse = T(1) / r;
    const T shifted = d[i + 1] - p;
    s = select(turns, f * inverse, s);
    c = select(turns, g * inverse, c);
    const T h = (d[i] - shifted) * s + T(2) * c * b;
    p = select(turns, s * h, p);
    d[i + 1] = select(turns, shifted + p, select(reached, shifted, d[i + 1]));
    g = select(turns, c * h - b, g);
    const T cosine = select(turns, c, T(1)), sine = select(turns, s, T(0));
    const Vec<T, N> left = q.col(i), right = q.col(i + 1);
    q.col(i + 1) = sine * left + cosine * right;
    q.col(i) = cosine * left - sine * right;
  }
  const MaskOf<T> ends = active[first] && whole;
  d[first] = select(ends, d[first] - p, d[first]);
  e[first] = select(ends, g, e[first]);
}

/// Marks the rotations of the unreduced block that begins at `first`. An off-diagonal entry counts as 0 below
/// rounding of its two neighbours on the diagonal or of the largest entry, which the reduction lost already.
template <class T, int N>
BB_HD inline void mark_block(int first, const Vec<T, N>& d, const Vec<T, N>& e, MaskOf<T> (&active)[N]) {
  using std::abs;
  const T eps(std::numeric_limits<typename ScalarOf<T>::type>::epsilon());
  MaskOf<T> coupled = true;
  for (int i = first; i + 1 < N; ++i) {
    coupled = coupled && !(abs(e[i]) <= eps / T(4) * (abs(d[i]) + abs(d[i + 1]) + T(0.25)));
    active[i] = coupled;
  }
}

/// The tridiagonal matrix of diagonal d and e next to it becomes diag(d); the columns of q turn along. Cost: about 2
/// sweeps an eigenvalue, at most 30.
template <class T, int N>
BB_HD inline void ql_iterate(Vec<T, N>& d, Vec<T, N>& e, Mat<T, N, N>& q) {
  MaskOf<T> active[N] = {};
  for (int first = 0; first + 1 < N; ++first) {
    for (int sweep = 0; sweep < 30; ++sweep) {
      mark_block<T, N>(first, d, e, active);
      if (!any(active[first])) break;
      ql_sweep<T, N>(first, active, d, e, q);
    }
  }
}

/// a = q diag(d) q^T, in no order. a: symmetric, largest entry about 1; destroyed.   Source: Golub and Van Loan, Matrix
/// Computations, 8.3; EISPACK's tred2 and imtql2.
template <class T, int N>
BB_HD inline void tridiagonal_eigen(Mat<T, N, N>& a, Vec<T, N>& d, Mat<T, N, N>& q) {
  Vec<T, N> e;
  tridiagonalise<T, N>(a, d, e, q);
  ql_iterate<T, N>(d, e, q);
}

}  // namespace bb::detail
