// The families of elastic elements as kernels read them: constants as columns, the physics of core/energy.
#pragma once

#include "core/energy/hinge.hpp"
#include "core/energy/hinge_lanes.hpp"
#include "core/energy/membrane_list.hpp"
#include "core/energy/membrane_rest.hpp"
#include "core/energy/rod_bend.hpp"
#include "core/energy/spring.hpp"
#include "core/energy/tetrahedron.hpp"
#include "core/energy/triangle_membrane.hpp"
#include "core/resident/elements/element_kernels.hpp"

namespace bb::resident {

/// Rest shapes of n triangles or tetrahedra. Rest: TriangleRest or TetrahedronRest.
template <class Rest>
struct RestColumnsOf {
  using Inverse = decltype(Rest::dm_inv);
  static constexpr int n_inverse = Inverse::SizeAtCompileTime;

  const double* dm_inv;   // [4 or 9, n] 1/m, column-major entries
  const double* measure;  // [n] m^2 or m^3
  BB_HD Rest at(Index e, Index n) const {
    Inverse inverse;
    for (int k = 0; k < n_inverse; ++k) inverse.data()[k] = dm_inv[k * n + e];
    return {inverse, measure[e]};
  }
};
using RestColumns = RestColumnsOf<TriangleRest<double>>;
using SolidRestColumns = RestColumnsOf<TetrahedronRest<double>>;

/// Rest shapes [5, n] that change with time: those that are given [5, n], a factor on their lengths, a plastic part.
struct PlaceTriangles {
  const double* given;
  const int* list;            // [n] into factor, -1: none; or null
  const double* factor;       // of the time, 1
  const double* plastic_inv;  // [4 n] triangle by triangle; or null
  Index n;
  double* rest;
  BB_HD void operator()(Index e) const {
    const double by = list && list[e] >= 0 ? factor[list[e]] : 1;
    const TriangleRest<double> from = RestColumns{given, given + 4 * n}.at(e, n);
    const TriangleRest<double> to =
        placed_rest<double>(from, by, plastic_inv ? plastic_inv + 4 * e : nullptr);
    for (int k = 0; k < 4; ++k) rest[k * n + e] = to.dm_inv.data()[k];
    rest[4 * n + e] = to.area;
  }
};

/// plastic_inv becomes what it is after a step of dt (s) that ended at x.
struct FlowTriangles {
  ElementVertices<3> elements;
  RestColumns rest;
  const double *yield, *creep;  // [n] 1, 1/s
  const double* x;
  double dt;
  double* plastic_inv;
  BB_HD void operator()(Index e) const {
    Vec3d p[3];
    elements.points(x, e, p);
    creep_plastic<double>(rest.at(e, elements.n), p, yield[e], kept_after(creep[e], dt), plastic_inv + 4 * e);
  }
};

/// R: 3 in space, 2 in the x-y plane.
template <class Model, int R>
struct Membrane : ElementVertices<3> {
  RestColumns rest;
  const double *lame_mu, *lame_lambda;  // [n] N/m
  BB_HD double value(const double* x, Index e) const {
    Vec3d p[3];
    points(x, e, p);
    return membrane_value<Model, R, double>(rest.at(e, n), p, lame_mu[e], lame_lambda[e]);
  }
  BB_HD ElementTerms<double, 9> terms(const double* x, Index e, Projection projection) const {
    Vec3d p[3];
    points(x, e, p);
    return membrane_terms<Model, R, double>(rest.at(e, n), p, lame_mu[e], lame_lambda[e], projection);
  }
};
template <class Model>
struct SpaceMembrane : Membrane<Model, 3> {};
template <class Model>
struct PlanarMembrane : Membrane<Model, 2> {};

struct Springs : ElementVertices<2> {
  const double* stiffness;    // [n] N/m
  const double* rest_length;  // [n] m
  BB_HD double value(const double* x, Index e) const {
    Vec3d p[2];
    points(x, e, p);
    return spring_value<double>(p, stiffness[e], rest_length[e]);
  }
  BB_HD ElementTerms<double, 6> terms(const double* x, Index e, Projection projection) const {
    Vec3d p[2];
    points(x, e, p);
    return spring_terms<double>(p, stiffness[e], rest_length[e], projection);
  }
};

/// Of: hinges with their constants, and energy(p, e) of one of them.
template <class Of>
struct HingeElements : Of {
  BB_HD double value(const double* x, Index e) const {
    Vec3d p[4];
    this->points(x, e, p);
    return this->energy(p, e).energy;
  }
  BB_HD ElementTerms<double, 12> terms(const double* x, Index e, Projection projection) const {
    Vec3d p[4];
    this->points(x, e, p);
    return hinge_terms_of<double>(p, this->energy(p, e), projection);
  }
  static constexpr int lanes = hinge_lanes;
  void terms_abreast(const double* x, Index first, Projection projection,
                     TermsAbreast<double, lanes, 4>& out) const {
    HingesAbreast<double> hinges;
    for (int lane = 0; lane < lanes; ++lane) {
      Vec3d p[4];
      this->points(x, first + lane, p);
      hinges.set(lane, p, this->energy(p, first + lane));
    }
    hinge_terms_abreast(hinges, projection, out);
  }
};

struct QuadraticHinges : ElementVertices<4> {
  const double* stiffness;   // [n] J
  const double* rest_angle;  // [n] rad
  BB_HD HingeEnergy<double> energy(const Vec3d (&p)[4], Index e) const {
    return hinge_energy<double>(p, stiffness[e], rest_angle[e]);
  }
};
struct Hinges : HingeElements<QuadraticHinges> {};

/// Those with a part that grows.
struct GrowingHinges : ElementVertices<4> {
  const double* stiffness;    // [n] J
  const double* rest_angle;   // [n] rad
  const double* exponential;  // [n] J, at rest
  const double* exponent;     // [n] 1/rad
  BB_HD HingeEnergy<double> energy(const Vec3d (&p)[4], Index e) const {
    return hinge_energy<double>(p, stiffness[e], exponential[e], exponent[e], rest_angle[e]);
  }
};
struct StiffeningHinges : HingeElements<GrowingHinges> {};

/// rest_angle [n] becomes what it is after a step of dt (s) that ended at x.
struct FlowHinges {
  ElementVertices<4> elements;
  const double *yield, *creep;  // [n] rad, 1/s
  const double* x;
  double dt;
  double* rest_angle;
  BB_HD void operator()(Index e) const {
    Vec3d p[4];
    elements.points(x, e, p);
    rest_angle[e] = crept_rest_angle<double>(p, rest_angle[e], yield[e], kept_after(creep[e], dt));
  }
};

/// Corners of rods, bent at the middle vertex.
struct Rods : ElementVertices<3> {
  const double* stiffness;   // [n] J
  const double* rest_angle;  // [n] rad
  BB_HD double value(const double* x, Index e) const {
    Vec3d p[3];
    points(x, e, p);
    return rod_bend_value<double>(p, stiffness[e], rest_angle[e]);
  }
  BB_HD ElementTerms<double, 9> terms(const double* x, Index e, Projection projection) const {
    Vec3d p[3];
    points(x, e, p);
    return rod_bend_terms<double>(p, stiffness[e], rest_angle[e], projection);
  }
};

/// Model: a name of core/energy/solids.inc in bb::solid.
template <class Model>
struct Tetrahedra : ElementVertices<4> {
  SolidRestColumns rest;
  const double *lame_mu, *lame_lambda;  // [n] Pa
  BB_HD double value(const double* x, Index e) const {
    Vec3d p[4];
    points(x, e, p);
    return tetrahedron_value<Model, double>(rest.at(e, n), p, lame_mu[e], lame_lambda[e]);
  }
  BB_HD ElementTerms<double, 12> terms(const double* x, Index e, Projection projection) const {
    Vec3d p[4];
    points(x, e, p);
    return tetrahedron_terms<Model, double>(rest.at(e, n), p, lame_mu[e], lame_lambda[e], projection);
  }
};

}  // namespace bb::resident
