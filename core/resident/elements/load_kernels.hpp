// Inertia and weight: the terms whose elements are the vertices.
#pragma once

#include "core/energy/vertex_loads.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/resident/elements/gather_kernels.hpp"

namespace bb::resident {

BB_HD inline Vec3d point_at(const double* x, Index v) { return Vec3d(x[3 * v], x[3 * v + 1], x[3 * v + 2]); }

/// The loads of a step.
struct Loads {
  const double* mass;           // [n] kg, 0 for prescribed vertices
  const double *x_n, *x_tilde;  // [3 n] m, start of the step and prediction
  double dt, c, load_factor;    // s; as in StepFrame
  double gravity[3];            // m/s^2; all 0 where the scene has none
  bool has_weight;

  BB_HD double weight(Index v) const { return inertia_weight(mass[v], c, dt); }
  BB_HD Vec3d off_target(const double* x, Index v) const { return point_at(x, v) - point_at(x_tilde, v); }
  BB_HD Vec3d force(Index v) const {
    return weight_force(load_factor, mass[v], Vec3d(gravity[0], gravity[1], gravity[2]));
  }
};

/// g += gradient of the loads.
struct LoadGradient {
  Loads loads;
  const double* x;
  double* g;  // [3 n] N
  BB_HD void operator()(Index v) const {
    Vec3d out = point_at(g, v);
    out += loads.weight(v) * loads.off_target(x, v);
    if (loads.has_weight) out += -loads.force(v);
    for (int k = 0; k < 3; ++k) g[3 * v + k] = out[k];
  }
};

/// Adds the weights of inertia to the diagonal blocks.
struct InertiaDiagonal {
  Loads loads;
  const Index* row_begin;
  const int* column;
  double* value;
  BB_HD void operator()(Index v) const {
    const Index block = find_block(row_begin, column, static_cast<int>(v), static_cast<int>(v));
    const double weight = loads.weight(v);
    for (int c = 0; c < 9; c += 4) value[value_index(block, c)] += weight;
  }
};

/// Parts of a sum: energies of the loads at x.
struct LoadEnergies {
  Loads loads;
  const double* x;
  BB_HD void operator()(Index v, Compensated& sum) const {
    sum.add(inertia_value(loads.weight(v), loads.off_target(x, v)));
    if (loads.has_weight) {
      const Vec3d way = point_at(x, v) - point_at(loads.x_n, v);
      sum.add(-loads.force(v).dot(way));
    }
  }
};

/// Parts of a sum: changes from x0 to x1, in closed form.
struct LoadChanges {
  Loads loads;
  const double *x0, *x1;
  BB_HD void operator()(Index v, Compensated& sum) const {
    const Vec3d step = point_at(x1, v) - point_at(x0, v);
    const auto inertia =
        inertia_change(loads.weight(v), loads.off_target(x0, v), loads.off_target(x1, v), step);
    sum.add(inertia.change, inertia.magnitude);
    if (!loads.has_weight) return;
    const auto work = work_change(loads.force(v), step);
    sum.add(work.change, work.magnitude);
  }
};

}  // namespace bb::resident
