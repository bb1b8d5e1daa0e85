// Tetrahedra of a model of solids.
#pragma once

#include "core/energy/families/element_kernels.hpp"
#include "core/energy/families/rest_kernels.hpp"

namespace bb {

/// Model: a name of core/energy/solids.inc in bb::solid.
template <class Model>
struct Tetrahedra : ElementVertices<4> {
  SolidRestColumns rest;
  const double *lame_mu, *lame_lambda;  // [n] Pa
  template <class T = double>
  BB_HD T value(const double* x, exec::Index e) const {
    Vec<T, 3> p[4];
    points(x, e, p);
    return tetrahedron_value<Model, T>(rest.at<T>(e, n), p, static_cast<T>(lame_mu[e]),
                                       static_cast<T>(lame_lambda[e]));
  }
  template <class T = double>
  BB_HD ElementTerms<T, 12> terms(const double* x, exec::Index e, Projection projection) const {
    Vec<T, 3> p[4];
    points(x, e, p);
    return tetrahedron_terms<Model, T>(rest.at<T>(e, n), p, static_cast<T>(lame_mu[e]),
                                       static_cast<T>(lame_lambda[e]), projection);
  }
  /// Only where a singular value is negative.
  template <class T>
  bool is_cusp(const double* x, exec::Index e) const {
    Vec<T, 3> p[4];
    points(x, e, p);
    return !(tetrahedron_determinant<T>(p) > T(0)) &&
           tetrahedron_is_cusp<Model, T>(rest.at<T>(e, n), p, static_cast<T>(lame_mu[e]),
                                         static_cast<T>(lame_lambda[e]));
  }
};

}  // namespace bb
