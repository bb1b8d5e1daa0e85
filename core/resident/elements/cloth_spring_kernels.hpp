// Springs of cloth, and rest lengths that shrink and creep.
#pragma once

#include "core/energy/cloth_spring.hpp"
#include "core/resident/elements/element_kernels.hpp"

namespace bb::resident {

struct ClothSprings : ElementVertices<2> {
  const double* law;          // [5, n] the members of SpringLaw, N/m and 1
  const double* rest_length;  // [n] m
  BB_HD SpringLaw<double> law_of(Index e) const {
    return {law[e], law[n + e], law[2 * n + e], law[3 * n + e], law[4 * n + e]};
  }
  BB_HD double value(const double* x, Index e) const {
    Vec3d p[2];
    points(x, e, p);
    return cloth_spring_value<double>(p, rest_length[e], law_of(e));
  }
  BB_HD ElementTerms<double, 6> terms(const double* x, Index e, Projection projection) const {
    Vec3d p[2];
    points(x, e, p);
    return cloth_spring_terms<double>(p, rest_length[e], law_of(e), projection);
  }
};

/// Rest lengths as they are given, and what a time makes of them.
struct GivenLengths {
  const double* given;   // [n] m
  const int* list;       // [n] into factor, -1: none; or null
  const double* factor;  // of the time, 1
  BB_HD double shrink(Index e) const { return list && list[e] >= 0 ? factor[list[e]] : 1; }
};

struct PlaceClothSprings {
  GivenLengths lengths;
  const double* ratio;  // [n] 1
  double* rest_length;
  BB_HD void operator()(Index e) const { rest_length[e] = lengths.shrink(e) * (ratio[e] * lengths.given[e]); }
};

/// ratio [n] becomes what it is after a step of dt (s) that ended at x.
struct FlowClothSprings {
  ClothSprings elements;
  GivenLengths lengths;
  const double *yield, *creep;  // [n] 1, 1/s
  const double* x;
  double dt;
  double* ratio;
  BB_HD void operator()(Index e) const {
    Vec3d p[2];
    elements.points(x, e, p);
    ratio[e] = crept_ratio<double>(p, elements.rest_length[e], lengths.shrink(e) * lengths.given[e], yield[e],
                                   kept_after(creep[e], dt), ratio[e]);
  }
};

}  // namespace bb::resident
