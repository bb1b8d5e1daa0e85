// Kernels of conjugate gradients that know no preconditioner. Vectors: [3 n] numbers, 0 where a degree of freedom is fixed.
#pragma once

#include "core/linear/executor/fold_partials.hpp"
#include "core/linear/executor/pcg_scalars.hpp"

namespace bb::exec {

/// q = A p by rows, eight lanes a row; partial sums of p^T q. Nothing happens where `state` is there and not running.
struct MultiplyDot {
  static constexpr int lanes = 8, rows = block_threads / lanes;
  struct Shared {
    double dot[rows];
  };
  Partition partition;
  ExecutorMatrix matrix;
  const FixedMask* fixed;
  const double* p;
  double *q, *partial;
  const CgState* state;

  BB_HD Vec3d sum_of_lane(Index row, int lane) const {
    double y0 = 0, y1 = 0, y2 = 0;
    for (const MatrixPart& part : matrix.part) {
      if (!part.row_begin) continue;
      const Index end = part.row_begin[row + 1];
      for (Index j = part.row_begin[row] + lane; j < end; j += lanes) {
        const double* a = part.value + value_index(j, 0);
        const double* v = p + 3 * static_cast<Index>(part.column[j]);
        for (int c = 0; c < 3; ++c) {
          const double x = v[c];
          y0 = fma(a[24 * c], x, y0), y1 = fma(a[24 * c + 8], x, y1), y2 = fma(a[24 * c + 16], x, y2);
        }
      }
    }
    return Vec3d(y0, y1, y2);
  }

  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    if (state && !state->running()) return;
    const Index first = partition.first(b), last = partition.last(b);
    block.threads(rows, [&](int t) { shared.dot[t] = 0; });
    for (Index base = first; base < last; base += rows) {
      block.template tiles<lanes>([&](auto& tile, int k) {
        const Index row = base + k;
        if (row >= last) return;
        const auto mine = tile.lanes([&](int lane) { return sum_of_lane(row, lane); });
        const Vec3d y = tile.sum(mine);
        tile.once([&] {
          double dot = 0;
          for (int c = 0; c < 3; ++c) {
            const double yc = is_fixed(fixed[row], c) ? 0 : y[c];
            q[3 * row + c] = yc;
            dot = fma(p[3 * row + c], yc, dot);
          }
          shared.dot[k] += dot;
        });
      });
    }
    fold(block, shared.dot, rows);
    block.once([&] { partial[b] = shared.dot[0]; });
  }
};

/// Partial sums of |p_i| |A_ij| |p_j|: the scale of the rounding error of p^T A p.
struct MagnitudeDot {
  struct Shared {
    double sum[block_threads];
  };
  Partition partition;
  ExecutorMatrix matrix;
  const double* p;
  double* partial;

  BB_HD double row_sum(Index row) const {
    double sum = 0;
    for (const MatrixPart& part : matrix.part) {
      if (!part.row_begin) continue;
      for (Index j = part.row_begin[row]; j < part.row_begin[row + 1]; ++j) {
        const double* x = p + 3 * static_cast<Index>(part.column[j]);
        for (int c = 0; c < 9; ++c) {
          sum += fabs(p[3 * row + c % 3] * part.value[value_index(j, c)] * x[c / 3]);
        }
      }
    }
    return sum;
  }

  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const Index first = partition.first(b), last = partition.last(b);
    const int width = block.busy(partition.width(1));
    block.threads(width, [&](int t) {
      shared.sum[t] = 0;
      for (Index row = first + t; row < last; row += block_threads) shared.sum[t] += row_sum(row);
    });
    fold(block, shared.sum, width);
    block.once([&] { partial[b] = shared.sum[0]; });
  }
};

/// r = from - minus where degrees of freedom are free, minus 0 where it is null; partial sums of r^T r.
struct SetResidual {
  struct Shared {
    double rr[block_threads];
  };
  Partition partition;
  const FixedMask* fixed;
  const double *from, *minus;
  double *r, *partial_rr;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const Index first = 3 * partition.first(b), last = 3 * partition.last(b);
    const int width = block.busy(partition.width(3));
    block.threads(width, [&](int t) {
      double rr = 0;
      for (Index i = first + t; i < last; i += block_threads) {
        const double value = is_fixed(fixed[i / 3], static_cast<int>(i % 3)) ? 0
                             : minus                                         ? from[i] - minus[i]
                                                                             : from[i];
        r[i] = value;
        rr = fma(value, value, rr);
      }
      shared.rr[t] = rr;
    });
    fold(block, shared.rr, width);
    block.once([&] { partial_rr[b] = shared.rr[0]; });
  }
};

/// One block: scalars->sum = the sum of partial [n].
struct FinishSum {
  struct Shared {
    double a[block_threads];
  };
  const double* partial;
  Index n;
  PcgScalars* scalars;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index) const {
    const double sum = fold_partials(block, shared.a, partial, n);
    block.once([&] { scalars->sum = sum; });
  }
};

/// One block: the state of a run that begins with r, z and their sums. The first run of a solve sets the target.
struct BeginRun {
  struct Shared {
    double a[block_threads];
  };
  const double *partial_rz, *partial_rr;
  Index n;
  const FactorFaults* faults;
  PcgScalars* scalars;
  bool first;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index) const {
    const double rz = fold_partials(block, shared.a, partial_rz, n);
    const double rr = fold_partials(block, shared.a, partial_rr, n);
    block.once([&] {
      const bool factors =
          faults->non_finite == no_fault && faults->indefinite == no_fault && faults->singular == no_fault;
      if (first) scalars->goal = cg_goal(rr, scalars->tolerance);
      const int iteration = first ? 0 : scalars->state[0].iteration;
      scalars->state[0] = cg_begin(rz, rr, iteration, scalars->max_iterations, factors);
    });
  }
};

/// p = z + beta p. The first block writes the state after iteration k of the graph. Nothing but a copy of the state
/// where the run is over; p stays as it is when the run ends here.
struct StepDirection {
  struct Shared {
    double a[block_threads];
  };
  Partition partition;
  const double *partial_rz, *partial_rr, *z;
  double* p;
  PcgScalars* scalars;
  int k;

  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const CgState now = scalars->state[k % 2];
    CgState after = now;
    if (now.running()) {
      if (gives_step(scalars->curvature)) {
        const double rz = fold_partials(block, shared.a, partial_rz, partition.n_blocks());
        const double rr = fold_partials(block, shared.a, partial_rr, partition.n_blocks());
        after = cg_go_on(cg_take_residual(now, rr, scalars->goal.target), rz, scalars->max_iterations);
      } else {
        after.end = CgEnd::curvature;
      }
    }
    const double beta = after.rz / now.rz;
    if (after.running()) {
      const Index first = 3 * partition.first(b), last = 3 * partition.last(b);
      block.threads(block.busy(partition.width(3)), [&](int t) {
        for (Index i = first + t; i < last; i += block_threads) p[i] = fma(beta, p[i], z[i]);
      });
    }
    block.once([&] {
      if (b != 0) return;
      if (now.running()) scalars->beta[k] = beta;
      scalars->state[1 - k % 2] = after;
    });
  }
};

}  // namespace bb::exec
