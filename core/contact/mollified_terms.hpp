// Gradient and Hessian of one mollified row. Host-device, no allocation.
#pragma once

#include "core/geometry/distance_derivatives.hpp"
#include "core/geometry/edge_axis_mollifier.hpp"
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
BB_HD MollifiedDerivatives<T> mollified_derivatives(const Mat<T, 3, 4>& points, T eps, T b, T db, T d2b) {
  const auto e = edge_edge_mollifier<T>(points, eps);
  const auto d = distance_derivatives<T, 4>(points, closest_edge_edge<T>(points));
  const Vec<T, 12> g = b * e.gradient + (db * e.value) * d.gradient;
  const Mat<T, 12, 12> cross = db * e.gradient * d.gradient.transpose();
  const Mat<T, 12, 12> full = b * e.hessian + cross + cross.transpose() +
                              (d2b * e.value) * (d.gradient * d.gradient.transpose()) +
                              (db * e.value) * d.hessian;
  return {g, full};
}

/// The same of an edge and an axis, in e0 e1; what belongs to the other two points is 0. points: as those of
/// edge_axis_mollifier.hpp; axis: unit. Everything but the axis is across it, and so are all derivatives.
template <class T>
BB_HD MollifiedDerivatives<T> mollified_derivatives(const Mat<T, 3, 3>& points, const Vec<T, 3>& axis, T eps,
                                                    T b, T db, T d2b) {
  const Vec<T, 3> edge = points.col(2) - points.col(1);
  const detail::MollifierTerms<T> terms(edge.squaredNorm(), eps);
  const auto d = distance_derivatives<T, 3>(points, closest_point_edge<T>(points));
  const Mat<T, 3, 3> across = Mat<T, 3, 3>::Identity() - axis * axis.transpose();
  MollifiedDerivatives<T> out{Vec<T, 12>::Zero(), Mat<T, 12, 12>::Zero()};
  const T sign[2] = {T(-1), T(1)};
  Vec<T, 3> ge[2], gd[2];
  for (int i = 0; i < 2; ++i) {
    ge[i] = (2 * sign[i] * terms.de) * edge;
    gd[i] = d.gradient.template segment<3>(3 * i + 3);
    out.gradient.template segment<3>(3 * i) = b * ge[i] + (db * terms.e) * gd[i];
  }
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const Mat<T, 3, 3> of_e = (4 * terms.d2e) * (edge * edge.transpose()) + (2 * terms.de) * across;
      const Mat<T, 3, 3> of_d = across * d.hessian.template block<3, 3>(3 * i + 3, 3 * j + 3) * across;
      out.hessian.template block<3, 3>(3 * i, 3 * j) =
          (b * sign[i] * sign[j]) * of_e + db * (ge[i] * gd[j].transpose() + gd[i] * ge[j].transpose()) +
          (d2b * terms.e) * (gd[i] * gd[j].transpose()) + (db * terms.e) * of_d;
    }
  }
  return out;
}

/// Leading block of 3 n_free x 3 n_free projected, the rest is 0 and stays so.
template <class T>
BB_HD void project_leading(int n_free, Projection projection, Mat<T, 12, 12>& h) {
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

// Compiled once for these scalars, in mollified_terms.cpp: kernels that call them are in headers of many files.
#ifndef __CUDACC__
extern template MollifiedDerivatives<float> mollified_derivatives<float>(const Mat<float, 3, 4>&, float,
                                                                         float, float, float);
extern template MollifiedDerivatives<float> mollified_derivatives<float>(const Mat<float, 3, 3>&,
                                                                         const Vec<float, 3>&, float, float,
                                                                         float, float);
extern template void project_leading<float>(int, Projection, Mat<float, 12, 12>&);
extern template MollifiedDerivatives<double> mollified_derivatives<double>(const Mat<double, 3, 4>&, double,
                                                                           double, double, double);
extern template MollifiedDerivatives<double> mollified_derivatives<double>(const Mat<double, 3, 3>&,
                                                                           const Vec<double, 3>&, double,
                                                                           double, double, double);
extern template void project_leading<double>(int, Projection, Mat<double, 12, 12>&);
#endif

}  // namespace bb
