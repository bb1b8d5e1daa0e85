// Corners of rods, bent at the middle vertex.
#pragma once

#include "core/energy/families/element_kernels.hpp"
#include "core/energy/rod_bend.hpp"

namespace bb {

struct Rods : ElementVertices<3> {
  const double* stiffness;   // [n] J
  const double* rest_angle;  // [n] rad
  template <class T = double>
  BB_HD T value(const double* x, exec::Index e) const {
    Vec<T, 3> p[3];
    points(x, e, p);
    return rod_bend_value<T>(p, static_cast<T>(stiffness[e]), static_cast<T>(rest_angle[e]));
  }
  template <class T = double>
  BB_HD ElementTerms<T, 9> terms(const double* x, exec::Index e, Projection projection) const {
    Vec<T, 3> p[3];
    points(x, e, p);
    return rod_bend_terms<T>(p, static_cast<T>(stiffness[e]), static_cast<T>(rest_angle[e]), projection);
  }
  template <class T>
  bool is_cusp(const double* x, exec::Index e) const {
    Vec<T, 3> p[3];
    points(x, e, p);
    return rod_bend_is_cusp<T>(p, static_cast<T>(stiffness[e]), static_cast<T>(rest_angle[e]));
  }
};

}  // namespace bb
