// Launches of the kernels of a shape, from its struct.
#pragma once

#include "core/barrier/launches.hpp"
#include "core/contact/executor/shape_kernels.hpp"
#include "core/energy/families/limit_kernels.hpp"
#include "core/exec/executor.hpp"

namespace bb {

/// Limited elements with N singular values, in R dimensions.
template <int R, int N, class S>
LimitLaunches<N> limit_launches() {
  using Columns = LimitColumns<N>;
  return {
      [](exec::Executor& executor, const Columns& limit, const BarrierFunction& barrier,
         const KappaParts* parts) {
        executor.each(limit.n, LimitShape<N, S>{limit, barrier.argument, barrier.literal, parts});
      },
      [](exec::Executor& executor, const Columns& limit, const BarrierFunction& barrier,
         const KappaParts* parts, const MeasureAt& at) {
        executor.each(limit.n, MeasureLimit<R, N, S>{{limit, barrier.argument, barrier.literal, parts}, at});
      }};
}

/// S is a struct of this folder.
template <class S>
ShapeLaunches shape_launches() {
  ShapeLaunches out;
  out.rows = [](exec::Executor& executor, const exec::RowView& rows, Argument argument) {
    executor.each(rows.n, exec::EvaluateShape<S>{rows, argument});
  };
  if constexpr (shapes::HasPotential<S>) {
    out.folded_rows = [](exec::Executor& executor, const exec::RowView& rows) {
      executor.each(rows.n, exec::EvaluateFoldedShape<S>{rows});
    };
  }
  out.planar_triangles = limit_launches<2, 2, S>();
  out.triangles = limit_launches<3, 2, S>();
  out.tetrahedra = limit_launches<3, 3, S>();
  return out;
}

}  // namespace bb
