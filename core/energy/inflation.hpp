// The work of a pressure on a triangle of a closed surface: -p times the volume between the triangle and the origin.
#pragma once

#include "core/energy/terms.hpp"
#include "core/math/psd.hpp"

namespace bb {

/// Signed volume of the tetrahedron 0 a b c, m^3. Host-device: yes. Total.
template <class T>
BB_HD T volume_below(const Vec<T, 3>& a, const Vec<T, 3>& b, const Vec<T, 3>& c) {
  return a.dot(b.cross(c)) / T(6);
}

/// Energy (J), gradient and Hessian of -p V, V = a . (b x c)/6; pressure p in Pa. Summed over a closed surface V is its volume
/// and does not depend on the origin; a projected Hessian does, and is the smaller the nearer the origin is. Half of the
/// eigenvalues other than 0 are negative. Host-device: yes. Total.
template <class T>
BB_HD ElementTerms<T, 9> inflation_terms(const Vec<T, 3> (&x)[3], T pressure, Projection projection) {
  const T factor = -pressure / T(6);
  ElementTerms<T, 9> out;
  out.energy = -pressure * volume_below<T>(x[0], x[1], x[2]);
  out.grad << factor * x[1].cross(x[2]), factor * x[2].cross(x[0]), factor * x[0].cross(x[1]);
  Mat<T, 9, 9> hess = Mat<T, 9, 9>::Zero();
  for (int k = 0; k < 3; ++k) {  // d(x_k+1 x x_k+2)/d x_k+1 = -[x_k+2], its rows those of x_k
    const Vec<T, 3> v = factor * x[(k + 2) % 3];
    const int row = 3 * k, column = 3 * ((k + 1) % 3);
    Mat<T, 3, 3> block;
    block << T(0), v[2], -v[1], -v[2], T(0), v[0], v[1], -v[0], T(0);
    hess.template block<3, 3>(row, column) = block;
    hess.template block<3, 3>(column, row) = block.transpose();
  }
  out.hess = project<T, 9>(hess, projection);
  return out;
}

}  // namespace bb
