// Inertia and weight in one launch each: a vertex is read once.
#pragma once

#include "core/energy/families/loads.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/terms/executor/gather_kernels.hpp"

namespace bb::exec {

/// The loads of a step.
struct Loads {
  InertiaOf<MassOverStep> inertia;
  WeightLoads weight;
  bool has_weight;
};

/// g += gradient of the loads.
struct LoadGradient {
  Loads loads;
  const double* x;
  double* g;  // [3 n] N
  BB_HD void operator()(Index v) const {
    Vec3d out = point_at(g, v);
    out += loads.inertia.gradient(x, v);
    if (loads.has_weight) out += loads.weight.gradient(v);
    for (int k = 0; k < 3; ++k) g[3 * v + k] = out[k];
  }
};

/// Adds the weights of inertia to the diagonal blocks.
struct InertiaDiagonal {
  InertiaOf<MassOverStep> inertia;
  const Index* row_begin;
  const int* column;
  double* value;
  BB_HD void operator()(Index v) const {
    const Index block = find_block(row_begin, column, static_cast<int>(v), static_cast<int>(v));
    const double weight = inertia.weight(v);
    for (int c = 0; c < 9; c += 4) value[value_index(block, c)] += weight;
  }
};

/// Parts of a sum: energies of the loads at x.
struct LoadEnergies {
  Loads loads;
  const double* x;
  BB_HD void operator()(Index v, Compensated& sum) const {
    sum.add(loads.inertia.value(x, v));
    if (loads.has_weight) sum.add(loads.weight.value(x, v));
  }
};

/// Parts of a sum: changes from x0 to x1, in closed form.
struct LoadChanges {
  Loads loads;
  const double *x0, *x1;
  BB_HD void operator()(Index v, Compensated& sum) const {
    const auto inertia = loads.inertia.change(x0, x1, v);
    sum.add(inertia.change, inertia.magnitude);
    if (!loads.has_weight) return;
    const auto work = loads.weight.change(x0, x1, v);
    sum.add(work.change, work.magnitude);
  }
};

}  // namespace bb::exec
