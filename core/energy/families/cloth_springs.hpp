// Springs of cloth, and rest lengths that creep.
#pragma once

#include "core/energy/cloth_spring.hpp"
#include "core/energy/families/element_kernels.hpp"

namespace bb {

struct ClothSprings : ElementVertices<2> {
  const double* law;          // [6, n] the members of SpringLaw, N/m and 1
  const double* rest_length;  // [n] m
  template <class T>
  BB_HD SpringLaw<T> law_of(exec::Index e) const {
    return {static_cast<T>(law[e]),         static_cast<T>(law[n + e]),     static_cast<T>(law[2 * n + e]),
            static_cast<T>(law[3 * n + e]), static_cast<T>(law[4 * n + e]), static_cast<T>(law[5 * n + e])};
  }
  template <class T = double>
  BB_HD T value(const double* x, exec::Index e) const {
    Vec<T, 3> p[2];
    points(x, e, p);
    return cloth_spring_value<T>(p, static_cast<T>(rest_length[e]), law_of<T>(e));
  }
  template <class T = double>
  BB_HD ElementTerms<T, 6> terms(const double* x, exec::Index e, Projection projection) const {
    Vec<T, 3> p[2];
    points(x, e, p);
    return cloth_spring_terms<T>(p, static_cast<T>(rest_length[e]), law_of<T>(e), projection);
  }
  template <class T>
  bool is_cusp(const double* x, exec::Index e) const {
    Vec<T, 3> p[2];
    points(x, e, p);
    return cloth_spring_is_cusp<T>(p, static_cast<T>(rest_length[e]), law_of<T>(e));
  }
};

struct PlaceClothSprings {
  const double *given, *ratio;  // [n] m, 1
  double* rest_length;
  BB_HD void operator()(exec::Index e) const { rest_length[e] = ratio[e] * given[e]; }
};

/// ratio [n] becomes what it is after a step of dt (s) that ended at x.
struct FlowClothSprings {
  ClothSprings elements;
  const double* given;          // [n] m
  const double *yield, *creep;  // [n] 1, 1/s
  const double* x;
  double dt;
  double* ratio;
  BB_HD void operator()(exec::Index e) const {
    Vec3d p[2];
    elements.points(x, e, p);
    const double length = spring_length<double>(p, elements.law_of<double>(e).softening);
    const double kept = kept_after(creep[e], dt);
    ratio[e] = crept_ratio<double>(length, elements.rest_length[e], given[e], yield[e], kept, ratio[e]);
  }
};

}  // namespace bb
