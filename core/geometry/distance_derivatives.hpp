// Gradient and Hessian of the distance d, and of d^2, of a pair in its closest region: one formula for
// every kind. The distance is not twice differentiable where regions meet; each side has the derivatives
// of its region.
#pragma once

#include <cmath>

#include "core/geometry/closest_points.hpp"
#include "core/geometry/region.hpp"
#include "core/math/products.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Derivatives in the 3N coordinates, vertex-major.
template <class T, int N>
struct DistanceDerivatives {
  Vec<T, 3 * N> gradient;
  Mat<T, 3 * N, 3 * N> hessian;
};

namespace detail {

/// The local frame of a region: unit normal n, the free directions made orthonormal (q_l, with the change of
/// weights g_l that moves r by q_l), and the projector on the directions that are neither.
template <class T, int N>
struct RegionFrame {
  int n_free;
  Vec<T, 3> n, q[2];
  Vec<T, N> g[2];
  Mat<T, 3, 3> rest;
};

template <class T, int N>
BB_HD inline RegionFrame<T, N> region_frame(const Mat<T, 3, N>& x, const Closest<T, N>& closest) {
  const FreeEdges edges = free_edges(closest.region);
  RegionFrame<T, N> frame;
  frame.n_free = edges.count;
  const Vec<T, 3> r = closest.r;
  frame.n = closest.d > 0 ? Vec<T, 3>(r / closest.d) : Vec<T, 3>(Vec<T, 3>::Zero());
  if (edges.count == 0) {
    frame.rest = Mat<T, 3, 3>::Identity() - frame.n * frame.n.transpose();
    return frame;
  }
  const Vec<T, 3> e = x.col(edges.to[0]) - x.col(edges.from[0]);
  const T e_length = e.norm();
  frame.q[0] = e / e_length;
  frame.g[0].setZero();
  frame.g[0][edges.to[0]] = 1 / e_length;
  frame.g[0][edges.from[0]] = -1 / e_length;
  if (N < 4 || edges.count == 1) {  // an edge and a point have no more
    if (closest.d > 0) {
      const Vec<T, 3> t = accurate_cross(frame.n, frame.q[0]);
      frame.rest = t * t.transpose();
    } else {
      frame.rest = Mat<T, 3, 3>::Identity() - frame.q[0] * frame.q[0].transpose();
    }
    return frame;
  }
  const Vec<T, 3> f = x.col(edges.to[1]) - x.col(edges.from[1]);
  const Vec<T, 3> normal = accurate_cross(e, f);
  const T area = normal.norm();
  if (!(closest.d > 0)) frame.n = normal / area;  // the plane has a normal at d = 0 too
  const T height = area / e_length;               // of f over e
  frame.q[1] = accurate_cross(normal, e) / (area * e_length);
  frame.g[1] = -frame.q[0].dot(f) * frame.g[0];
  frame.g[1][edges.to[1]] += 1;
  frame.g[1][edges.from[1]] -= 1;
  frame.g[1] /= height;
  frame.rest.setZero();
  return frame;
}

/// d times the Hessian of d. With phi = d^2/2 and weights linear in the free parameters s,
///   hess phi = phi_xx - phi_xs phi_ss^-1 phi_sx  (s minimises phi),
/// and s scaled so that phi_ss = 1: block ij of hess phi is
///   w_i w_j (1 - sum q q^T) - d sum (g_i w_j n q^T + w_i g_j q n^T) - d^2 sum g_i g_j n n^T;
/// d hess d is that less w_i w_j n n^T. Terms that cancel (1 - n n^T - sum q q^T) are never formed.
template <class T, int N>
BB_HD inline Mat<T, 3 * N, 3 * N> scaled_distance_hessian(const RegionFrame<T, N>& frame,
                                                          const Closest<T, N>& closest) {
  const Vec<T, N>& w = closest.weights;
  const T d = closest.d;
  Mat<T, 3 * N, 3 * N> out;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      Mat<T, 3, 3> block = w[i] * w[j] * frame.rest;
      for (int l = 0; l < (N < 4 ? 1 : 2) && l < frame.n_free; ++l) {
        const Vec<T, N>& g = frame.g[l];
        const Mat<T, 3, 3> nq = frame.n * frame.q[l].transpose();
        block -= d * (g[i] * w[j] * nq + w[i] * g[j] * nq.transpose());
        block -= d * d * g[i] * g[j] * (frame.n * frame.n.transpose());
      }
      out.template block<3, 3>(3 * i, 3 * j) = block;
    }
  }
  return out;
}

template <class T, int N>
BB_HD inline Vec<T, 3 * N> stack_weighted(const Vec<T, N>& weights, const Vec<T, 3>& v) {
  Vec<T, 3 * N> out;
  for (int i = 0; i < N; ++i) out.template segment<3>(3 * i) = weights[i] * v;
  return out;
}

}  // namespace detail

/// Gradient (unit 1) and Hessian (1/m) of d in the region of `closest`; requires d > 0.
/// @param x       [3 x N] the points that `closest` was computed from, m
/// Errors: none; d = 0 gives non-finite values.   Host-device, no allocation.
/// Source: envelope theorem; compare Li et al. 2020 (IPC), supplement.
template <class T, int N>
BB_HD inline DistanceDerivatives<T, N> distance_derivatives(const Mat<T, 3, N>& x,
                                                            const Closest<T, N>& closest) {
  const detail::RegionFrame<T, N> frame = detail::region_frame<T, N>(x, closest);
  return {detail::stack_weighted<T, N>(closest.weights, frame.n),
          detail::scaled_distance_hessian<T, N>(frame, closest) / closest.d};
}

}  // namespace bb
