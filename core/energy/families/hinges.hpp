// Bending hinges, with a part of the stiffness that grows or without.
#pragma once

#include "core/energy/families/element_kernels.hpp"
#include "core/energy/hinge.hpp"
#include "core/energy/hinge_lanes.hpp"

namespace bb {

/// Of: hinges with their constants; energy(p, e) of one of them, and its stiffness at rest.
template <class Of>
struct HingeElements : Of {
  template <class T = double>
  BB_HD T value(const double* x, exec::Index e) const {
    Vec<T, 3> p[4];
    this->points(x, e, p);
    return this->energy(p, e).energy;
  }
  template <class T = double>
  BB_HD ElementTerms<T, 12> terms(const double* x, exec::Index e, Projection projection) const {
    Vec<T, 3> p[4];
    this->points(x, e, p);
    return hinge_terms_of<T>(p, this->energy(p, e), projection);
  }
  template <class T>
  bool is_cusp(const double* x, exec::Index e) const {
    Vec<T, 3> p[4];
    this->points(x, e, p);
    return hinge_is_cusp<T>(p, static_cast<T>(this->stiffness_at_rest(e)),
                            static_cast<T>(this->rest_angle[e]));
  }
  static constexpr int lanes = hinge_lanes;
  template <class T>
  void terms_abreast(const double* x, exec::Index first, Projection projection,
                     TermsAbreast<T, lanes, 4>& out) const {
    HingesAbreast<T> hinges;
    for (int lane = 0; lane < lanes; ++lane) {
      Vec<T, 3> p[4];
      this->points(x, first + lane, p);
      hinges.set(lane, p, this->energy(p, first + lane));
    }
    hinge_terms_abreast(hinges, projection, out);
  }
};

struct QuadraticHinges : ElementVertices<4> {
  const double* stiffness;   // [n] J
  const double* rest_angle;  // [n] rad
  template <class T>
  BB_HD HingeEnergy<T> energy(const Vec<T, 3> (&p)[4], exec::Index e) const {
    return hinge_energy<T>(p, static_cast<T>(stiffness[e]), static_cast<T>(rest_angle[e]));
  }
  double stiffness_at_rest(exec::Index e) const { return stiffness[e]; }
};
struct Hinges : HingeElements<QuadraticHinges> {};

/// Those with a part that grows.
struct GrowingHinges : ElementVertices<4> {
  const double* stiffness;    // [n] J
  const double* rest_angle;   // [n] rad
  const double* exponential;  // [n] J, at rest
  const double* exponent;     // [n] 1/rad
  template <class T>
  BB_HD HingeEnergy<T> energy(const Vec<T, 3> (&p)[4], exec::Index e) const {
    return hinge_energy<T>(p, static_cast<T>(stiffness[e]), static_cast<T>(exponential[e]),
                           static_cast<T>(exponent[e]), static_cast<T>(rest_angle[e]));
  }
  double stiffness_at_rest(exec::Index e) const { return stiffness[e] + exponential[e]; }
};
struct StiffeningHinges : HingeElements<GrowingHinges> {};

/// Rest angles [n] whose rest shape moves: those that creep, and by how much the ones that are given differ from those of the start.
struct PlaceHinges {
  const double *crept, *moved;
  double* rest_angle;
  BB_HD void operator()(exec::Index e) const { rest_angle[e] = crept[e] + moved[e]; }
};

/// crept [n] becomes what it is after a step of dt (s) that ended at x.
struct FlowHinges {
  ElementVertices<4> elements;
  const double *yield, *creep;  // [n] rad, 1/s
  const double* moved;          // [n] rad; or null: nothing
  const double* x;
  double dt;
  double* crept;
  BB_HD void operator()(exec::Index e) const {
    Vec3d p[4];
    elements.points(x, e, p);
    const double by = moved ? moved[e] : 0;
    crept[e] = crept_rest_angle<double>(p, crept[e] + by, yield[e], kept_after(creep[e], dt)) - by;
  }
};

}  // namespace bb
