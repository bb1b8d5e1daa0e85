// Levels of the Schwarz preconditioner: norms that decide clusters, matrices of coarse levels, and what stands round the
// solves of clusters in an iteration.
#pragma once

#include <cmath>

#include "core/linear/executor/block_jacobi_kernels.hpp"
#include "core/linear/executor/cluster_kernels.hpp"

namespace bb::exec {

/// norm [blocks] of one part: Frobenius, of what is free of a block.
struct BlockNorms {
  MatrixPart part;
  const FixedMask* fixed;
  double* norm;
  BB_HD void operator()(Index row) const {
    for (Index j = part.row_begin[row]; j < part.row_begin[row + 1]; ++j) {
      double sum = 0;
      for (int c = 0; c < 9; ++c) {
        const double a = part.value[value_index(j, c)];
        if (!is_fixed(fixed[row], c % 3) && !is_fixed(fixed[part.column[j]], c / 3)) sum = fma(a, a, sum);
      }
      norm[j] = std::sqrt(sum);
    }
  }
};

/// P^T A P on the translations of clusters: number i % 9 of coarse block i / 9 is the sum of those of its fine blocks.
struct CoarseValues {
  ExecutorMatrix matrix;  // of the level below
  const FixedMask* fixed;
  const Index *begin, *source;  // [blocks + 1], fine blocks as most_parts number + part
  const int* row;               // of each fine block
  double* value;
  BB_HD void operator()(Index i) const {
    const Index block = i / 9;
    const int c = static_cast<int>(i % 9);
    double sum = 0;
    for (Index k = begin[block]; k < begin[block + 1]; ++k) {
      const Index own = source[k] % ExecutorMatrix::most_parts, j = source[k] / ExecutorMatrix::most_parts;
      const int* column = matrix.part[0].column;
      const double* from = matrix.part[0].value;
      for (int p = 1; p < ExecutorMatrix::most_parts; ++p) {
        if (own == p) column = matrix.part[p].column, from = matrix.part[p].value;
      }
      if (is_fixed(fixed[row[k]], c % 3) || is_fixed(fixed[column[j]], c / 3)) continue;
      sum += from[value_index(j, c)];
    }
    value[value_index(block, c)] = sum;
  }
};

/// x += alpha p, r -= alpha q; partial sums of r^T r.
struct UpdateResidual {
  struct Shared {
    double rr[block_threads];
  };
  Partition partition;
  const double *p, *q, *partial_pq;
  double *x, *r, *partial_rr;
  PcgScalars* scalars;
  int k;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    if (!scalars->state[k % 2].running()) return;
    double alpha;
    if (!step_length(block, shared.rr, partial_pq, partition, scalars, k, b, alpha)) return;
    const Index first = 3 * partition.first(b), last = 3 * partition.last(b);
    const int width = block.busy(partition.width(3));
    block.threads(width, [&](int t) {
      double rr = 0;
      for (Index i = first + t; i < last; i += block_threads) {
        x[i] = fma(alpha, p[i], x[i]);
        const double value = fma(-alpha, q[i], r[i]);
        r[i] = value;
        rr = fma(value, value, rr);
      }
      shared.rr[t] = rr;
    });
    fold(block, shared.rr, width);
    block.once([&] { partial_rr[b] = shared.rr[0]; });
  }
};

/// z of the vertices plus that of the nodes above them; partial sums of r^T z.
struct AddLevels {
  static constexpr int most_levels = 16;
  struct Shared {
    double rz[block_threads];
  };
  Partition partition;
  const FixedMask* fixed;
  const double* r;
  double *z, *partial_rz;
  int n_above;
  const int* of[most_levels];  // the node above, from each level
  const double* z_above[most_levels];
  const CgState* state;

  BB_HD double above(Index vertex, int c) const {
    double sum = 0;
    Index node = vertex;
    for (int l = 0; l < n_above; ++l) {
      node = of[l][node];
      sum += z_above[l][3 * node + c];
    }
    return sum;
  }

  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    if (state && !state->running()) return;
    const Index first = 3 * partition.first(b), last = 3 * partition.last(b);
    const int width = block.busy(partition.width(3));
    block.threads(width, [&](int t) {
      double rz = 0;
      for (Index i = first + t; i < last; i += block_threads) {
        const Index v = i / 3;
        const int c = static_cast<int>(i - 3 * v);
        const double value = is_fixed(fixed[v], c) ? 0 : z[i] + above(v, c);
        z[i] = value;
        rz = fma(r[i], value, rz);
      }
      shared.rz[t] = rz;
    });
    fold(block, shared.rz, width);
    block.once([&] { partial_rz[b] = shared.rz[0]; });
  }
};

}  // namespace bb::exec
