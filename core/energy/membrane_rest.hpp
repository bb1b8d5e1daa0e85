// Rest triangles that creep: the F of an element is that of its given triangle times the inverse of a plastic part.
#pragma once

#include "core/energy/creep.hpp"
#include "core/energy/triangle_membrane.hpp"
#include "core/math/svd.hpp"

namespace bb {

/// @param plastic_inv  column-major. Host-device: yes.
template <class T>
BB_HD TriangleRest<T> placed_rest(const TriangleRest<T>& given, const T* plastic_inv) {
  Mat<T, 2, 2> plastic;
  for (int k = 0; k < 4; ++k) plastic.data()[k] = plastic_inv[k];
  TriangleRest<T> rest = given;
  const Mat<T, 2, 2> crept = rest.dm_inv * plastic;
  rest.dm_inv = crept;
  return rest;
}

/// plastic_inv (column-major) becomes what it is after a step that ended at x: F V diag(crept/sigma) V^T has the singular values that
/// are left. Nothing happens where none creeps, or where a factor is not a number > 0. Host-device: yes.
/// @param rest  of the step   @param yield, kept  as those of crept(), of sigma - 1
template <class T>
BB_HD void creep_plastic(const TriangleRest<T>& rest, const Vec<T, 3> (&x)[3], T yield, T kept,
                         T* plastic_inv) {
  const auto svd = svd_3x2<T>(deformation_gradient<3>(rest, x));
  const T first = svd.sigma[0] - 1, second = svd.sigma[1] - 1;
  const T left_first = crept(first, yield, kept), left_second = crept(second, yield, kept);
  const T f0 = left_first == first ? T(1) : (1 + left_first) / svd.sigma[0];
  const T f1 = left_second == second ? T(1) : (1 + left_second) / svd.sigma[1];
  const bool numbers = f0 - f0 == T(0) && f1 - f1 == T(0);
  if ((f0 == T(1) && f1 == T(1)) || !numbers || !(f0 > T(0)) || !(f1 > T(0))) return;
  Mat<T, 2, 2> scaled = svd.V, plastic;
  scaled.col(0) *= f0;
  scaled.col(1) *= f1;
  const Mat<T, 2, 2> more = scaled * svd.V.transpose();
  for (int k = 0; k < 4; ++k) plastic.data()[k] = plastic_inv[k];
  const Mat<T, 2, 2> next = plastic * more;
  for (int k = 0; k < 4; ++k) plastic_inv[k] = next.data()[k];
}

}  // namespace bb
