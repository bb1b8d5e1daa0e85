// Gradient and Hessian of one mollified edge-edge row. Host-device, no allocation.
#pragma once

#include "core/geometry/distance_derivatives.hpp"
#include "core/geometry/edge_edge_mollifier.hpp"
#include "core/math/psd.hpp"

namespace bb {

template <class T>
struct MollifiedDerivatives {
  Vec<T, 12> gradient;
  Mat<T, 12, 12> hessian;
};

/// Of e(x) b(d(x)) in the four points ea0 ea1 eb0 eb1. eps: threshold of the mollifier, m^4; b, db, d2b: barrier and
/// its derivatives in d, stiffness included.
template <class T>
BB_HD inline MollifiedDerivatives<T> mollified_derivatives(const Mat<T, 3, 4>& points, T eps, T b, T db,
                                                           T d2b) {
  const auto e = edge_edge_mollifier<T>(points, eps);
  const auto d = distance_derivatives<T, 4>(points, closest_edge_edge<T>(points));
  const Vec<T, 12> g = b * e.gradient + (db * e.value) * d.gradient;
  const Mat<T, 12, 12> cross = db * e.gradient * d.gradient.transpose();
  const Mat<T, 12, 12> full = b * e.hessian + cross + cross.transpose() +
                              (d2b * e.value) * (d.gradient * d.gradient.transpose()) +
                              (db * e.value) * d.hessian;
  return {g, full};
}

/// Leading block of 3 n_free x 3 n_free projected, the rest is 0 and stays so.
template <class T>
BB_HD inline void project_leading(int n_free, Projection projection, Mat<T, 12, 12>& h) {
  switch (n_free) {
    case 1:
      h.template topLeftCorner<3, 3>() = project<T, 3>(h.template topLeftCorner<3, 3>(), projection);
      break;
    case 2:
      h.template topLeftCorner<6, 6>() = project<T, 6>(h.template topLeftCorner<6, 6>(), projection);
      break;
    case 3:
      h.template topLeftCorner<9, 9>() = project<T, 9>(h.template topLeftCorner<9, 9>(), projection);
      break;
    default:
      h = project<T, 12>(h, projection);
  }
}

}  // namespace bb
