// Springs, stitches among them.
#pragma once

#include "core/energy/families/element_kernels.hpp"
#include "core/energy/spring.hpp"

namespace bb {

struct Springs : ElementVertices<2> {
  const double* stiffness;    // [n] N/m
  const double* rest_length;  // [n] m
  template <class T = double>
  BB_HD T value(const double* x, exec::Index e) const {
    Vec<T, 3> p[2];
    points(x, e, p);
    return spring_value<T>(p, static_cast<T>(stiffness[e]), static_cast<T>(rest_length[e]));
  }
  template <class T = double>
  BB_HD ElementTerms<T, 6> terms(const double* x, exec::Index e, Projection projection) const {
    Vec<T, 3> p[2];
    points(x, e, p);
    return spring_terms<T>(p, static_cast<T>(stiffness[e]), static_cast<T>(rest_length[e]), projection);
  }
  template <class T>
  bool is_cusp(const double* x, exec::Index e) const {
    Vec<T, 3> p[2];
    points(x, e, p);
    return spring_is_cusp<T>(p, static_cast<T>(stiffness[e]), static_cast<T>(rest_length[e]));
  }
};

}  // namespace bb
