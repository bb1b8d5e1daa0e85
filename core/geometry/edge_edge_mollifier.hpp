// The mollifier of Li et al. 2020 (IPC, eq. 24): takes the contact of two edges to zero, C1, as
// they become parallel.
#pragma once

#include "core/math/products.hpp"
#include "core/math/types.hpp"

namespace bb {

/// e(x) in [0, 1] with derivatives in ea0 ea1 eb0 eb1 (1, 1/m, 1/m^2).
template <class T>
struct EdgeEdgeMollifier {
  T value;
  Vec<T, 12> gradient;
  Mat<T, 12, 12> hessian;
};

/// Threshold on |ea x eb|^2 below which a pair is mollified: 1e-3 |ea|^2 |eb|^2 at rest, m^4.
/// @param x_rest [3 x 4] ea0 ea1 eb0 eb1 at rest, m
template <class T>
BB_HD inline T edge_edge_mollifier_threshold(const Mat<T, 3, 4>& x_rest) {
  return T(1e-3) * (x_rest.col(1) - x_rest.col(0)).squaredNorm() *
         (x_rest.col(3) - x_rest.col(2)).squaredNorm();
}

/// c = |ea x eb|^2, m^4: the squared area that is compared with the threshold.
template <class T>
BB_HD inline T edge_edge_cross_squared(const Mat<T, 3, 4>& x) {
  const Vec<T, 3> a = x.col(1) - x.col(0), b = x.col(3) - x.col(2);
  return accurate_cross(a, b).squaredNorm();
}

namespace detail {

/// The polynomial of the mollifier, -(c/eps)^2 + 2 c/eps, for c < eps, else 1; e' and e'' in c.
template <class T>
struct MollifierTerms {
  T e, de, d2e;
  BB_HD MollifierTerms(T c, T eps)
      : e(c < eps ? (2 - c / eps) * (c / eps) : T(1)),
        de(c < eps ? 2 * (1 - c / eps) / eps : T(0)),
        d2e(c < eps ? -2 / (eps * eps) : T(0)) {}
};

}  // namespace detail

/// e(x) alone. @param x [3 x 4] ea0 ea1 eb0 eb1, m. @param eps threshold, m^4, > 0.   Host-device.
template <class T>
BB_HD inline T edge_edge_mollifier_value(const Mat<T, 3, 4>& x, T eps) {
  return detail::MollifierTerms<T>(edge_edge_cross_squared<T>(x), eps).e;
}

/// e(x), its gradient and its (indefinite) Hessian; 1 and zeros for c >= eps. Parameters as above.
/// Errors: none.   Host-device, no allocation.
template <class T>
BB_HD inline EdgeEdgeMollifier<T> edge_edge_mollifier(const Mat<T, 3, 4>& x, T eps) {
  const Vec<T, 3> a = x.col(1) - x.col(0), b = x.col(3) - x.col(2);
  const Vec<T, 3> n = accurate_cross(a, b);
  const detail::MollifierTerms<T> terms(n.squaredNorm(), eps);

  // c = |a|^2 |b|^2 - (a.b)^2 in the edge vectors; the points follow by sign.
  const Vec<T, 3> dc_da = 2 * accurate_cross(b, n), dc_db = 2 * accurate_cross(n, a);
  const Mat<T, 3, 3> one = Mat<T, 3, 3>::Identity();
  const Mat<T, 3, 3> haa = 2 * (b.squaredNorm() * one - b * b.transpose());
  const Mat<T, 3, 3> hbb = 2 * (a.squaredNorm() * one - a * a.transpose());
  const Mat<T, 3, 3> hab = 4 * a * b.transpose() - 2 * b * a.transpose() - 2 * a.dot(b) * one;

  EdgeEdgeMollifier<T> out;
  out.value = terms.e;
  const T sign[4] = {T(-1), T(1), T(-1), T(1)};
  for (int i = 0; i < 4; ++i) {
    const Vec<T, 3> gi = sign[i] * (i < 2 ? dc_da : dc_db);
    out.gradient.template segment<3>(3 * i) = terms.de * gi;
    for (int j = 0; j < 4; ++j) {
      const Vec<T, 3> gj = sign[j] * (j < 2 ? dc_da : dc_db);
      Mat<T, 3, 3> hij = i < 2 ? (j < 2 ? haa : hab) : hbb;
      if (i >= 2 && j < 2) hij = hab.transpose();
      out.hessian.template block<3, 3>(3 * i, 3 * j) =
          terms.d2e * gi * gj.transpose() + terms.de * sign[i] * sign[j] * hij;
    }
  }
  return out;
}

}  // namespace bb
