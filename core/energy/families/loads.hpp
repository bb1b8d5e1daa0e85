// Loads of every vertex: inertia, 1/(2 c h^2) |x - x_tilde|_M^2, and the work of the weight, -f . (x - x_n).
#pragma once

#include "core/energy/families/element_kernels.hpp"
#include "core/energy/families/family_step.hpp"
#include "core/energy/vertex_loads.hpp"

namespace bb {

BB_HD inline Vec3d point_at(const double* x, exec::Index v) {
  return Vec3d(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
}

/// Element v is vertex v. Convex: no projection changes the Hessian.
struct EveryVertex : ElementVertices<1> {
  static constexpr bool every_vertex = true;
};

/// Weights of inertia that are divided out where they are read: on a card, where a column of them would cost more.
struct MassOverStep {
  const double* mass;  // [n] kg, 0 for prescribed vertices
  double dt, c;        // s; as in StepColumns
  BB_HD double operator()(exec::Index v) const { return inertia_weight(mass[v], c, dt); }
};
/// The same as a column (inertia_weights.hpp).
struct StoredWeight {
  const double* of;  // [n] N/m
  BB_HD double operator()(exec::Index v) const { return of[v]; }
};

template <class Weight>
struct InertiaOf : EveryVertex {
  Weight weight;
  const double* x_tilde;  // [3 n] m

  BB_HD Vec3d off_target(const double* x, exec::Index v) const {
    return point_at(x, v) - point_at(x_tilde, v);
  }
  BB_HD Vec3d gradient(const double* x, exec::Index v) const { return weight(v) * off_target(x, v); }
  BB_HD double value(const double* x, exec::Index v) const {
    return inertia_value(weight(v), off_target(x, v));
  }
  BB_HD ElementTerms<double, 3> terms(const double* x, exec::Index v, Projection) const {
    return {value(x, v), gradient(x, v), weight(v) * Mat3d::Identity()};
  }
  BB_HD ValueChange<double> change(const double* x0, const double* x1, exec::Index v) const {
    const Vec3d step = point_at(x1, v) - point_at(x0, v);
    return inertia_change(weight(v), off_target(x0, v), off_target(x1, v), step);
  }
};

struct WeightLoads : EveryVertex {
  static constexpr bool linear = true;
  const double* mass;  // [n] kg, 0 for prescribed vertices
  const double* x_n;   // [3 n] m, start of the step
  double load_factor;
  double gravity[3];  // m/s^2

  /// at_end: gravity at the end of the step.
  void set_step(const FamilyStep& step, const Vec3d& at_end) {
    x_n = step.x_n, load_factor = step.load_factor;
    for (int k = 0; k < 3; ++k) gravity[k] = at_end[k];
  }
  BB_HD Vec3d force(exec::Index v) const {
    return weight_force(load_factor, mass[v], Vec3d(gravity[0], gravity[1], gravity[2]));
  }
  BB_HD Vec3d gradient(exec::Index v) const { return -force(v); }
  BB_HD double value(const double* x, exec::Index v) const {
    const Vec3d way = point_at(x, v) - point_at(x_n, v);
    return -force(v).dot(way);
  }
  BB_HD ElementTerms<double, 3> terms(const double* x, exec::Index v, Projection) const {
    return {value(x, v), gradient(v), Mat3d::Zero()};
  }
  BB_HD ValueChange<double> change(const double* x0, const double* x1, exec::Index v) const {
    const Vec3d step = point_at(x1, v) - point_at(x0, v);
    return work_change(force(v), step);
  }
};

}  // namespace bb
