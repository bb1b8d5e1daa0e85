// One linear tetrahedron: from four points to F, and to energy, gradient and Hessian in the twelve coordinates.
#pragma once

#include "core/energy/pull_back.hpp"

namespace bb {

/// Rest data. F = [x1 - x0, x2 - x0, x3 - x0] dm_inv.
template <class T>
struct TetrahedronRest {
  Mat<T, 3, 3> dm_inv;  // 1/m
  T volume;             // m^3, > 0 where the corners are a right-handed system seen from point 0
};

/// Six times the signed volume of a tetrahedron, m^3. Host-device: yes.
template <class T>
BB_HD T tetrahedron_determinant(const Vec<T, 3> (&x)[4]) {
  const Vec<T, 3> e1 = x[1] - x[0], e2 = x[2] - x[0], e3 = x[3] - x[0];
  return e1.dot(accurate_cross<T>(e2, e3));
}

/// Rest data; not finite without volume, of an inverted tetrahedron with volume < 0. Host-device: yes.
template <class T>
BB_HD TetrahedronRest<T> tetrahedron_rest(const Vec<T, 3> (&x)[4]) {
  const Vec<T, 3> e1 = x[1] - x[0], e2 = x[2] - x[0], e3 = x[3] - x[0];
  const T det = tetrahedron_determinant<T>(x);
  TetrahedronRest<T> out;
  out.dm_inv.row(0) = accurate_cross<T>(e2, e3).transpose() / det;
  out.dm_inv.row(1) = accurate_cross<T>(e3, e1).transpose() / det;
  out.dm_inv.row(2) = accurate_cross<T>(e1, e2).transpose() / det;
  out.volume = det / T(6);
  return out;
}

/// F, 3 x 3. Host-device: yes.
template <class T>
BB_HD Mat<T, 3, 3> deformation_gradient(const TetrahedronRest<T>& rest, const Vec<T, 3> (&x)[4]) {
  const Vec<T, 3> e1 = x[1] - x[0], e2 = x[2] - x[0], e3 = x[3] - x[0];
  Mat<T, 3, 3> f;
  for (int j = 0; j < 3; ++j) {
    f.col(j) = rest.dm_inv(0, j) * e1 + rest.dm_inv(1, j) * e2 + rest.dm_inv(2, j) * e3;
  }
  return f;
}

/// Energy (J) of a tetrahedron: rest volume x psi(F). Model: a name of solids.inc in bb::solid; Lame parameters in Pa.
/// Host-device: yes. Total for a proper rest tetrahedron, inverted states included.
template <class Model, class T>
BB_HD T tetrahedron_value(const TetrahedronRest<T>& rest, const Vec<T, 3> (&x)[4], T lame_mu, T lame_lambda) {
  return rest.volume * Model::template value<T, 3, 3>(deformation_gradient(rest, x), lame_mu, lame_lambda);
}

/// Whether that energy has a cusp at x. Host-device: yes.
template <class Model, class T>
BB_HD bool tetrahedron_is_cusp(const TetrahedronRest<T>& rest, const Vec<T, 3> (&x)[4], T lame_mu,
                               T lame_lambda) {
  return Model::template is_cusp<T, 3, 3>(deformation_gradient(rest, x), lame_mu, lame_lambda);
}

/// Energy, gradient and Hessian of a tetrahedron. Host-device: yes.
template <class Model, class T>
BB_HD ElementTerms<T, 12> tetrahedron_terms(const TetrahedronRest<T>& rest, const Vec<T, 3> (&x)[4],
                                            T lame_mu, T lame_lambda, Projection projection) {
  const Mat<T, 3, 3> f = deformation_gradient(rest, x);
  return pull_back<3, 3, T>(rest.dm_inv, rest.volume,
                            Model::template terms<T, 3, 3>(f, lame_mu, lame_lambda, projection));
}

}  // namespace bb
