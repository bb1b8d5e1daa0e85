// Launches of the kernels of a strain limit that depend on the shape of its barrier.
#pragma once

#include "barriers/shapes/shape_list.hpp"
#include "core/barrier/shape.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/limit_kernels.hpp"

namespace bb::resident {

/// Where kappa is known: the state x is measured, with its energies.
struct MeasureAt {
  const double* x;
  double* energy;
  Key* beyond;
};
template <int N>
struct ShapeLaunches {
  void (*shape)(exec::Executor&, const LimitColumns<N>&, const BarrierFunction&, const KappaParts*);
  void (*measure)(exec::Executor&, const LimitColumns<N>&, const BarrierFunction&, const KappaParts*,
                  const MeasureAt&);
};

template <int N, class S>
void launch_shape(exec::Executor& executor, const LimitColumns<N>& limit, const BarrierFunction& barrier,
                  const KappaParts* parts) {
  executor.each(N * limit.n, LimitShape<N, S>{limit, barrier.argument, barrier.literal, parts});
}
template <int R, int N, class S>
void launch_measure(exec::Executor& executor, const LimitColumns<N>& limit, const BarrierFunction& barrier,
                    const KappaParts* parts, const MeasureAt& at) {
  executor.each(limit.n, MeasureLimit<R, N, S>{
                             {limit, barrier.argument, barrier.literal, parts}, at.x, at.energy, at.beyond});
}

template <int R, int N>
ShapeLaunches<N> shape_kernels(const BarrierFunction& barrier) {
#define SHAPE(id, Struct)                               \
  if (barrier.shape.name == #id && !barrier.shape.self) \
    return {&launch_shape<N, shapes::Struct>, &launch_measure<R, N, shapes::Struct>};
  BB_FOR_EACH_SHAPE(SHAPE)
#undef SHAPE
  throw ConfigError("shape", barrier.shape.name,
                    "a shape of barriers/shapes: a plugin's and another exponent have no kernel");
}

}  // namespace bb::resident
