// How much of its last direction a nonlinear conjugate gradient method keeps.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// beta of p_next = -P g + beta p, with y = g - g_before, Py = P y, P the inverse of a preconditioner:
///
///   beta = g.Py / y.p - (y.Py / y.p) (g.p / y.p)
///
/// (Dai, Kou 2013, with their parameter tau = s.y/s.s; with P: Shen et al. 2024). Of a quadratic E, the minimum along p
/// and one P it is g.Pg / g_before.Pg_before, that of linear conjugate gradients. Whatever g is,
/// g.p_next <= -(3/4) g.Pg. Not finite where y.p is 0.
inline double dai_kou(const VecXd& g, const VecXd& y, const VecXd& Py, const VecXd& p) {
  const double along = y.dot(p);
  return (g.dot(Py) - y.dot(Py) * g.dot(p) / along) / along;
}

}  // namespace bb
