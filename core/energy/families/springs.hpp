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

/// Springs whose tension at the end x of a step is beyond their strength have no stiffness from then on.
struct BreakSprings {
  Springs elements;
  const double* strength;  // [n] N
  const double* x;
  double* stiffness;  // [n] N/m, that of the step before
  BB_HD void operator()(exec::Index e) const {
    Vec3d p[2], along[2];
    elements.points(x, e, p);
    const double stretch = spring_stretch<double>(p, elements.rest_length[e], along);
    if (elements.stiffness[e] * stretch > strength[e]) stiffness[e] = 0;
  }
};

}  // namespace bb
