// Triangles under a pressure from within, -p V, seen from the centre of their body at the start of the step, on which the sum of
// their volumes does not depend: every corner has a third of the force p A of a triangle. What corners have beyond that (a pressure that
// differs from triangle to triangle, another split) has no potential in x; it is that of the areas at the start of the step.
#pragma once

#include "core/energy/families/loads.hpp"
#include "core/energy/inflation.hpp"

namespace bb {

struct Inflated : ElementVertices<3> {
  const double* pressure;  // [n] Pa, without what follows keys
  const int* key;          // [n] into factor, -1: constant
  const double* factor;    // of the step
  const int* body;         // [n] into centre
  const double* centre;    // [3 bodies] m
  const double* beyond;    // [3, n] Pa on the areas of the start of the step, corner by corner; null: 0
  const double* area;      // [3, n] m^2, their vectors along the normal of the triangle

  template <class T>
  BB_HD T pressure_of(exec::Index e) const {
    return static_cast<T>(key[e] < 0 ? pressure[e] : pressure[e] * factor[key[e]]);
  }
  template <class T>
  BB_HD void off_centre(const double* x, exec::Index e, Vec<T, 3> (&out)[3]) const {
    const Vec3d from = point_at(centre, body[e]);
    for (int k = 0; k < 3; ++k) {
      const Vec3d off = point_at(x, vertex(k, e)) - from;
      out[k] = off.cast<T>();
    }
  }
  template <class T>
  BB_HD Vec<T, 3> force_beyond(int k, exec::Index e) const {
    const Vec3d force = beyond[k * n + e] * Vec3d(area[e], area[n + e], area[2 * n + e]);
    return force.cast<T>();
  }
  template <class T = double>
  BB_HD T value(const double* x, exec::Index e) const {
    Vec<T, 3> p[3];
    off_centre<T>(x, e, p);
    T out = -pressure_of<T>(e) * volume_below<T>(p[0], p[1], p[2]);
    if (beyond == nullptr) return out;
    for (int k = 0; k < 3; ++k) out -= force_beyond<T>(k, e).dot(p[k]);
    return out;
  }
  template <class T = double>
  BB_HD ElementTerms<T, 9> terms(const double* x, exec::Index e, Projection projection) const {
    Vec<T, 3> p[3];
    off_centre<T>(x, e, p);
    ElementTerms<T, 9> out = inflation_terms<T>(p, pressure_of<T>(e), projection);
    if (beyond == nullptr) return out;
    for (int k = 0; k < 3; ++k) {
      const Vec<T, 3> force = force_beyond<T>(k, e);
      out.energy -= force.dot(p[k]);
      out.grad.template segment<3>(3 * k) -= force;
    }
    return out;
  }
};

/// area [3, n] of the triangles at x.
struct AreaVectors {
  ElementVertices<3> elements;
  const double* x;  // [3 n_vertices] m
  double* area;
  BB_HD void operator()(exec::Index e) const {
    Vec3d p[3];
    elements.points(x, e, p);
    const Vec3d first = p[1] - p[0], second = p[2] - p[0], twice = first.cross(second);
    for (int c = 0; c < 3; ++c) area[c * elements.n + e] = twice[c] / 2;
  }
};

/// Neighbouring vertices.
struct VertexRange {
  int first, n;
};

/// centre of body b: the mean of its vertices, a tree over 256 strided sums.
struct BodyCentres {
  struct Shared {
    double sum[3][exec::block_threads];
  };
  const VertexRange* range;
  const double* x;  // [3 n_vertices] m
  double* centre;   // [3 bodies] m
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, exec::Index b) const {
    const VertexRange of = range[b];
    block.threads([&](int t) {
      double sum[3] = {0, 0, 0};
      for (int v = t; v < of.n; v += exec::block_threads) {
        for (int c = 0; c < 3; ++c) sum[c] += x[3 * static_cast<exec::Index>(of.first + v) + c];
      }
      for (int c = 0; c < 3; ++c) shared.sum[c][t] = sum[c];
    });
    for (int c = 0; c < 3; ++c) exec::fold(block, shared.sum[c], exec::block_threads);
    block.threads(3, [&](int t) { centre[3 * b + t] = shared.sum[t][0] / of.n; });
  }
};

}  // namespace bb
