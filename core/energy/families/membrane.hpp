// Triangles of a membrane model, whose rest shapes may creep.
#pragma once

#include <cmath>
#include <limits>

#include "core/energy/families/element_kernels.hpp"
#include "core/energy/families/rest_kernels.hpp"
#include "core/energy/membrane_lanes.hpp"
#include "core/energy/membrane_list.hpp"
#include "core/energy/membrane_rest.hpp"

namespace bb {

/// Rest shapes [5, n] that creep: those that are given [5, n], with a plastic part.
struct PlaceTriangles {
  const double* given;
  const double* plastic_inv;  // [4 n] triangle by triangle
  exec::Index n;
  double* rest;
  BB_HD void operator()(exec::Index e) const {
    const TriangleRest<double> to =
        placed_rest<double>(RestColumns{given, given + 4 * n}.at(e, n), plastic_inv + 4 * e);
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
  BB_HD void operator()(exec::Index e) const {
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
  template <class T = double>
  BB_HD T value(const double* x, exec::Index e) const {
    Vec<T, 3> p[3];
    points(x, e, p);
    return membrane_value<Model, R, T>(rest.at<T>(e, n), p, static_cast<T>(lame_mu[e]),
                                       static_cast<T>(lame_lambda[e]));
  }
  template <class T = double>
  BB_HD ElementTerms<T, 9> terms(const double* x, exec::Index e, Projection projection) const {
    Vec<T, 3> p[3];
    points(x, e, p);
    return membrane_terms<Model, R, T>(rest.at<T>(e, n), p, static_cast<T>(lame_mu[e]),
                                       static_cast<T>(lame_lambda[e]), projection);
  }
  /// In space only a triangle without area has one.
  template <class T>
  bool is_cusp(const double* x, exec::Index e) const {
    Vec<T, 3> p[3];
    points(x, e, p);
    const Vec<T, 3> a = p[1] - p[0], b = p[2] - p[0];
    const T thin = std::sqrt(std::numeric_limits<T>::epsilon());
    if (R == 3 && a.cross(b).norm() > thin * a.norm() * b.norm()) return false;
    return membrane_is_cusp<Model, R, T>(rest.at<T>(e, n), p, static_cast<T>(lame_mu[e]),
                                         static_cast<T>(lame_lambda[e]));
  }
};
/// In space four are taken abreast (membrane_lanes.hpp).
template <class Model>
struct SpaceMembrane : Membrane<Model, 3> {
  static constexpr int lanes = membrane_lanes;
  template <class T>
  void terms_abreast(const double* x, exec::Index first, Projection projection,
                     TermsAbreast<T, lanes, 3>& out) const {
    membrane_terms_abreast<Model>(triangles<T>(x, first), projection, out);
  }
  template <class T>
  void values_abreast(const double* x, exec::Index first, T (&energy)[lanes]) const {
    membrane_values_abreast<Model>(triangles<T>(x, first), energy);
  }

 private:
  template <class T>
  TrianglesAbreast<T> triangles(const double* x, exec::Index first) const {
    TrianglesAbreast<T> out;
    for (int lane = 0; lane < lanes; ++lane) {
      const exec::Index e = first + lane;
      Vec<T, 3> p[3];
      this->points(x, e, p);
      out.set(lane, p, this->rest.template at<T>(e, this->n), static_cast<T>(this->lame_mu[e]),
              static_cast<T>(this->lame_lambda[e]));
    }
    return out;
  }
};
template <class Model>
struct PlanarMembrane : Membrane<Model, 2> {};

}  // namespace bb
