// The Hessian of one contact row on its free points, made in the few directions in which it is not zero: at
// most five of twelve, so that its eigenvalues are those of a 5 x 5 matrix. One code for a number and for
// lanes.
#pragma once

#include "core/math/lower_blocks.hpp"
#include "core/math/psd.hpp"
#include "core/math/types.hpp"

namespace bb {

/// What the Hessian of a row whose closest points slide along F edges is made of. Columns on the compact free
/// slots, 0 beyond them. For the local frame see detail::RegionFrame in distance_derivatives.hpp.
template <class T, int F>
struct RowShape {
  Vec<T, 4> w;     // weights w_i
  Vec<T, 4> g[F];  // change of the weights along q_l, 1/m
  Vec<T, 3> n;     // unit normal
  Vec<T, 3> q[F];  // orthonormal directions in which the closest points slide
  T distance;      // of the closest points, m
  T stiffness;     // kappa b'', N/m
  T force;         // kappa b', N
  T bend = T(1);   // F = 1: 0 where moving across n and q_0 turns no normal, as along the axis of a cylinder
};

namespace detail {

/// An orthonormal basis u of what the first K columns of `vectors` span, and their coordinates in it: column
/// k is sum_i u_i coordinates(i, k). A direction of length 0 is 0. Gram and Schmidt twice.
template <class T, int K>
struct WeightBasis {
  Vec<T, 4> u[K];
  Mat<T, K, K> coordinates = Mat<T, K, K>::Zero();

  BB_HD explicit WeightBasis(const Vec<T, 4> (&vectors)[K]) {
    using std::sqrt;
    for (int k = 0; k < K; ++k) {
      u[k] = vectors[k];
      for (int pass = 0; pass < 2; ++pass) {
        for (int i = 0; i < k; ++i) {
          const T part = u[i].dot(u[k]);
          coordinates(i, k) += part;
          u[k] -= part * u[i];
        }
      }
      const T length = sqrt(u[k].squaredNorm());
      const auto none = !(length > T(0));
      coordinates(k, k) = select(none, T(0), length);
      u[k] *= select(none, T(0), T(1) / select(none, T(1), length));
    }
  }
};

}  // namespace detail

/// The block that every pair of points of a row shares whose closest points slide nowhere, apart from w_i w_j:
///   stiffness n n^T + force curvature (I - n n^T - flat flat^T),
/// both eigenspaces projected. stiffness = kappa b'', force = kappa b', curvature 1/d or the obstacle's (1/m), flat the
/// axis of a cylinder or 0.   Host-device.
template <class T>
BB_HD inline Mat<T, 3, 3> fixed_points_block(const Vec<T, 3>& n, const Vec<T, 3>& flat, T stiffness,
                                             T force_curvature, Projection projection) {
  const T along = project_eigenvalue(stiffness, projection);
  const T across = project_eigenvalue(force_curvature, projection);
  return along * n * n.transpose() +
         across * (Mat<T, 3, 3>::Identity() - n * n.transpose() - flat * flat.transpose());
}

/// Lower blocks (lower_blocks.hpp) of stiffness grad d grad d^T + force grad^2 d with projected eigenvalues.
///   grad d = w x n, and with c = force the second term is in the basis of docs/theory/contact-models.md, Contact rows:
///   -c (g_l x n)(w x q_l)^T - c (w x q_l)(g_l x n)^T - c d (g_l x n)(g_l x n)^T + c/d (w x t)(w x t)^T,
/// t the direction at a right angle to n and every q_l (F = 1). w x t is an eigenvector; the rest lives in
/// span(w, g_l) x n and w x span(q_l), which are at right angles to each other.
/// Exact for Projection::none, to rounding.   Errors: none.   Host-device, no allocation.
template <class T, int F>
BB_HD inline void row_hessian(const RowShape<T, F>& row, Projection projection,
                              T (&blocks)[n_lower_numbers(4)]) {
  constexpr int D = 2 * F + 1;  // coordinates: F + 1 along n, F along the q_l
  Vec<T, 4> span[F + 1];
  span[0] = row.w;
  for (int l = 0; l < F; ++l) span[l + 1] = row.g[l];
  const detail::WeightBasis<T, F + 1> basis(span);
  const T w_length = basis.coordinates(0, 0);
  const Vec<T, 4> w = basis.u[0];  // unit

  Mat<T, D, D> m = Mat<T, D, D>::Zero();
  m(0, 0) = row.stiffness * w_length * w_length;
  for (int l = 0; l < F; ++l) {
    const Vec<T, F + 1> g = basis.coordinates.col(l + 1);
    m.template topLeftCorner<F + 1, F + 1>() -= (row.force * row.distance) * (g * g.transpose());
    const Vec<T, F + 1> coupling = (-row.force * w_length) * g;
    m.template block<F + 1, 1>(0, F + 1 + l) = coupling;
    m.template block<1, F + 1>(F + 1 + l, 0) = coupling.transpose();
  }
  m = project<T, D>(m, projection);

  const Mat<T, 3, 3> nn = row.n * row.n.transpose();
  Mat<T, 3, 3> across = Mat<T, 3, 3>::Zero(), nq[F];
  Mat<T, 4, F + 1> u;
  for (int i = 0; i <= F; ++i) u.col(i) = basis.u[i];
  Mat<T, 4, F> coupled = u * m.template topRightCorner<F + 1, F>();
  const Mat<T, 4, 4> along = u * m.template topLeftCorner<F + 1, F + 1>() * u.transpose();
  for (int l = 0; l < F; ++l) {
    nq[l] = row.n * row.q[l].transpose();
    for (int k = 0; k < F; ++k) across += m(F + 1 + l, F + 1 + k) * (row.q[l] * row.q[k].transpose());
  }
  if constexpr (F == 1) {
    const Vec<T, 3> t = row.n.cross(row.q[0]);
    const T value = project_eigenvalue(row.bend * row.force / row.distance * w_length * w_length, projection);
    across += value * (t * t.transpose());
  }
  T* next = blocks;
  for (int j = 0; j < 4; ++j) {
    for (int i = j; i < 4; ++i) {
      Mat<T, 3, 3> block = along(i, j) * nn + (w[i] * w[j]) * across;
      for (int l = 0; l < F; ++l) {
        block += (coupled(i, l) * w[j]) * nq[l] + (w[i] * coupled(j, l)) * nq[l].transpose();
      }
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) *next++ = block(r, c);
      }
    }
  }
}

}  // namespace bb
