// One membrane triangle: from three points to F, and to energy, gradient and Hessian in the nine coordinates.
#pragma once

#include <cmath>

#include "core/energy/isotropic.hpp"
#include "core/energy/pull_back.hpp"

namespace bb {

/// Rest data. `dm_inv` maps the edges (x1 - x0, x2 - x0) to F = [edges] dm_inv; its columns belong to the
/// warp direction u and to v, at right angles to it.
template <class T>
struct TriangleRest {
  Mat<T, 2, 2> dm_inv;  // 1/m
  T area;               // m^2
};

/// Rest data in the orthonormal axes u, v. Requires a triangle of area > 0 (otherwise not finite).
template <class T>
BB_HD TriangleRest<T> triangle_rest_in_frame(const Vec<T, 3> (&x)[3], const Vec<T, 3>& u,
                                             const Vec<T, 3>& v) {
  const Vec<T, 3> e1 = x[1] - x[0], e2 = x[2] - x[0];
  const T a = u.dot(e1), b = u.dot(e2), c = v.dot(e1), d = v.dot(e2);
  const T det = a * d - b * c;
  TriangleRest<T> out;
  out.dm_inv(0, 0) = d / det;
  out.dm_inv(0, 1) = -b / det;
  out.dm_inv(1, 0) = -c / det;
  out.dm_inv(1, 1) = a / det;
  out.area = (det < T(0) ? -det : det) / T(2);
  return out;
}

/// Rest data of a triangle in space; u is `warp` turned into its plane and normalised, v = n x u.
template <class T>
BB_HD TriangleRest<T> triangle_rest(const Vec<T, 3> (&x)[3], const Vec<T, 3>& warp) {
  const Vec<T, 3> e1 = x[1] - x[0], e2 = x[2] - x[0];
  const Vec<T, 3> n = e1.cross(e2) / e1.cross(e2).norm();
  const Vec<T, 3> in_plane = warp - n.dot(warp) * n;
  const Vec<T, 3> u = in_plane / in_plane.norm();
  return triangle_rest_in_frame<T>(x, u, n.cross(u));
}

/// Rest data of a triangle of a planar scene (z is not read); v is u turned by +90 degrees in the x-y plane,
/// whatever the triangle's orientation, so that det F = 1 at rest for clockwise triangles too.
template <class T>
BB_HD TriangleRest<T> planar_triangle_rest(const Vec<T, 3> (&x)[3], const Vec<T, 3>& warp) {
  using std::sqrt;
  const T length = sqrt(warp[0] * warp[0] + warp[1] * warp[1]);
  const Vec<T, 3> u(warp[0] / length, warp[1] / length, T(0));
  return triangle_rest_in_frame<T>(x, u, Vec<T, 3>(-u[1], u[0], T(0)));
}

/// F, 3 x 2 in space, 2 x 2 in the x-y plane. Host-device: yes.
template <int R, class T>
BB_HD Mat<T, R, 2> deformation_gradient(const TriangleRest<T>& rest, const Vec<T, 3> (&x)[3]) {
  const Vec<T, R> e1 = (x[1] - x[0]).template head<R>(), e2 = (x[2] - x[0]).template head<R>();
  Mat<T, R, 2> f;
  for (int j = 0; j < 2; ++j) f.col(j) = rest.dm_inv(0, j) * e1 + rest.dm_inv(1, j) * e2;
  return f;
}

/// Energy (J) of a membrane triangle: rest area x psi(F). Model: a name of registry.inc in bb::membrane; Lame
/// parameters in N/m. Host-device: yes. Total for a proper rest triangle.
template <class Model, int R, class T>
BB_HD T membrane_value(const TriangleRest<T>& rest, const Vec<T, 3> (&x)[3], T lame_mu, T lame_lambda) {
  return rest.area * Model::template value<T, R>(deformation_gradient<R>(rest, x), lame_mu, lame_lambda);
}

/// Whether that energy has a cusp at x. Host-device: yes.
template <class Model, int R, class T>
BB_HD bool membrane_is_cusp(const TriangleRest<T>& rest, const Vec<T, 3> (&x)[3], T lame_mu, T lame_lambda) {
  return Model::template is_cusp<T, R>(deformation_gradient<R>(rest, x), lame_mu, lame_lambda);
}

/// Energy, gradient and Hessian of a membrane triangle. Host-device: yes.
template <class Model, int R, class T>
BB_HD ElementTerms<T, 9> membrane_terms(const TriangleRest<T>& rest, const Vec<T, 3> (&x)[3], T lame_mu,
                                        T lame_lambda, Projection projection) {
  const Mat<T, R, 2> f = deformation_gradient<R>(rest, x);
  return pull_back<R, 2, T>(rest.dm_inv, rest.area,
                            Model::template terms<T, R>(f, lame_mu, lame_lambda, projection));
}

}  // namespace bb
