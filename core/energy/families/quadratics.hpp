// Vertices that are pulled to places: 1/2 (x - y)^T K (x - y), and what drag of the air makes of y and K. Drag of the air on
// triangles: every corner of a triangle of area A bears -A w (c_n u_n + c_t u_t), w its part of the triangle (a third, or as the mass is
// split), u_n and u_t the parts of its velocity relative to the wind along and across the triangle's normal. Areas and normals are those of
// the start of the step, the velocity is (x - x_n)/h: the energy is 1/(2 h) u^T C u with u = x - x_n - h wind, and convex.
#pragma once

#include "core/energy/air_drag.hpp"
#include "core/energy/families/loads.hpp"

namespace bb {

/// K symmetric without negative eigenvalues: no projection changes the Hessian.
struct Quadratics : ElementVertices<1> {
  double* place;   // [3, n] y, m
  double* matrix;  // [9, n] K, N/m

  BB_HD Vec3d off(const double* x, exec::Index e) const {
    return point_at(x, vertex(0, e)) - Vec3d(place[e], place[n + e], place[2 * n + e]);
  }
  BB_HD Mat3d stiffness(exec::Index e) const {
    Mat3d out;
    for (int c = 0; c < 9; ++c) out.data()[c] = matrix[c * n + e];
    return out;
  }
  BB_HD void set(exec::Index e, const Vec3d& at, const Mat3d& k) const {
    for (int c = 0; c < 3; ++c) place[c * n + e] = at[c];
    for (int c = 0; c < 9; ++c) matrix[c * n + e] = k.data()[c];
  }
  BB_HD double value(const double* x, exec::Index e) const {
    return quadratic_value<double>(stiffness(e), off(x, e));
  }
  BB_HD ElementTerms<double, 3> terms(const double* x, exec::Index e, Projection) const {
    const Mat3d k = stiffness(e);
    const Vec3d from = off(x, e);
    return {quadratic_value<double>(k, from), k * from, k};
  }
  BB_HD ValueChange<double> change(const double* x0, const double* x1, exec::Index e) const {
    const exec::Index v = vertex(0, e);
    const Vec3d step = point_at(x1, v) - point_at(x0, v);
    return quadratic_change<double>(stiffness(e), off(x0, e), off(x1, e), step);
  }
};

/// coefficient [9, n] (N s/m) becomes the sum over the triangles of each corner, in their order.
struct DragCoefficients {
  const int* triangle;              // [3 triangles] vertices
  const std::uint32_t *start, *of;  // [n + 1]; triangles of every element, ascending
  const double* thrice;             // of each of these, three times what the corner bears of it; null: 1
  exec::Index n;
  double normal, tangential;  // N s/m^3
  const double* x_n;          // [3 n_vertices] m
  double* coefficient;
  BB_HD void operator()(exec::Index e) const {
    Mat3d sum = Mat3d::Zero();
    for (std::uint32_t i = start[e]; i < start[e + 1]; ++i) {
      const int* const corner = triangle + 3 * static_cast<exec::Index>(of[i]);
      const Vec3d x[3] = {point_at(x_n, corner[0]), point_at(x_n, corner[1]), point_at(x_n, corner[2])};
      const Mat3d third = drag_of_corner<double>(x, normal, tangential);
      sum += thrice == nullptr ? third : Mat3d(thrice[i] * third);
    }
    for (int c = 0; c < 9; ++c) coefficient[c * n + e] = sum.data()[c];
  }
};

/// y and K of a step of dt (s): where the wind would take the vertex, and coefficient/dt.
struct DragInWind {
  Quadratics elements;
  const double* coefficient;  // [9, n] N s/m
  const double* x_n;          // [3 n_vertices] m
  double wind[3], dt;         // m/s, s
  BB_HD void operator()(exec::Index e) const {
    Mat3d k;
    for (int c = 0; c < 9; ++c) k.data()[c] = coefficient[c * elements.n + e] / dt;
    const Vec3d way = dt * Vec3d(wind[0], wind[1], wind[2]);
    elements.set(e, point_at(x_n, elements.vertex(0, e)) + way, k);
  }
};

}  // namespace bb
