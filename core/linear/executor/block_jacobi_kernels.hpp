// The 3x3 blocks of the diagonal as a preconditioner, applied where x and r are updated.
#pragma once

#include "core/linear/executor/block_factor.hpp"
#include "core/linear/executor/fold_partials.hpp"

namespace bb::exec {

/// inverse [6 n] = the inverse Cholesky factors of the diagonal blocks, one number of all vertices after the other.
struct FactorizeDiagonal {
  ExecutorMatrix matrix;
  const FixedMask* fixed;
  Index n;
  double* inverse;
  FactorFaults* faults;
  BB_HD void operator()(Index v) const {
    double w[6] = {0, 0, 0, 0, 0, 0};
    const FactorStatus status = inverse_factor(diagonal_block(matrix, fixed[v], v), w);
    if (status != FactorStatus::ok) report_fault(faults, status, v);
    for (int i = 0; i < 6; ++i) inverse[i * n + v] = w[i];
  }
};

/// What the threads of a block hold of 256 vertices: numbers come in and go out in the order of memory.
struct VertexChunk {
  double rz[block_threads], rr[block_threads];
  double r[3 * block_threads], z[3 * block_threads];
};

/// z = M^-1 r of thread t's vertex v in the chunk; adds to the sums of the thread.
BB_HD inline void precondition_vertex(VertexChunk& chunk, int t, const double* inverse, Index n, Index v) {
  const double *r = chunk.r + 3 * t, *w = inverse + v;
  double* z = chunk.z + 3 * t;
  const double y0 = w[0] * r[0], y1 = fma(w[n], r[0], w[2 * n] * r[1]),
               y2 = fma(w[3 * n], r[0], fma(w[4 * n], r[1], w[5 * n] * r[2]));
  z[0] = fma(w[0], y0, fma(w[n], y1, w[3 * n] * y2));
  z[1] = fma(w[2 * n], y1, w[4 * n] * y2);
  z[2] = w[5 * n] * y2;
  chunk.rz[t] += r[0] * z[0] + r[1] * z[1] + r[2] * z[2];
  chunk.rr[t] += r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
}

/// Walks the vertices of block b in chunks: new_r(i) is r[i], to be stored by the callee. Writes z and both partial sums.
template <class Block, class NewR>
BB_HD void precondition_rows(Block& block, VertexChunk& chunk, const Partition& partition, Index b,
                             const double* inverse, const NewR& new_r, double* z, double* partial_rz,
                             double* partial_rr) {
  const Index last = partition.last(b);
  const int width = block.busy(partition.width(1));
  block.threads(width, [&](int t) { chunk.rz[t] = chunk.rr[t] = 0; });
  for (Index base = partition.first(b); base < last; base += block_threads) {
    const int count = static_cast<int>(last - base < block_threads ? last - base : block_threads);
    block.threads([&](int t) {
      for (int i = t; i < 3 * count; i += block_threads) chunk.r[i] = new_r(3 * base + i);
    });
    block.threads(count, [&](int t) { precondition_vertex(chunk, t, inverse, partition.n_rows, base + t); });
    block.threads([&](int t) {
      for (int i = t; i < 3 * count; i += block_threads) z[3 * base + i] = chunk.z[i];
    });
  }
  fold(block, chunk.rz, width);
  fold(block, chunk.rr, width);
  block.once([&] { partial_rz[b] = chunk.rz[0], partial_rr[b] = chunk.rr[0]; });
}

/// z = M^-1 r; partial sums of r^T z and r^T r.
struct ApplyBlockJacobi {
  using Shared = VertexChunk;
  Partition partition;
  const double *inverse, *r;
  double *z, *partial_rz, *partial_rr;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    precondition_rows(
        block, shared, partition, b, inverse, [&](Index i) { return r[i]; }, z, partial_rz, partial_rr);
  }
};

/// The step length of iteration k of the graph from p^T q, the same number in every block; false where there is none.
/// The first block keeps both numbers.
template <class Block>
BB_HD bool step_length(Block& block, double* scratch, const double* partial_pq, const Partition& partition,
                       PcgScalars* scalars, int k, Index b, double& alpha) {
  const double curvature = fold_partials(block, scratch, partial_pq, partition.n_blocks());
  alpha = scalars->state[k % 2].rz / curvature;
  const double kept = alpha;
  block.once([&] {
    if (b == 0) scalars->curvature = curvature, scalars->alpha[k] = kept;
  });
  return gives_step(curvature);
}

/// x += alpha p, r -= alpha q, z = M^-1 r; partial sums of r^T z and r^T r.
struct UpdateBlockJacobi {
  using Shared = VertexChunk;
  Partition partition;
  const double *inverse, *p, *q, *partial_pq;
  double *x, *r, *z, *partial_rz, *partial_rr;
  PcgScalars* scalars;
  int k;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    if (!scalars->state[k % 2].running()) return;
    double alpha;
    if (!step_length(block, shared.rz, partial_pq, partition, scalars, k, b, alpha)) return;
    const auto new_r = [&](Index i) {
      x[i] = fma(alpha, p[i], x[i]);
      return r[i] = fma(-alpha, q[i], r[i]);
    };
    precondition_rows(block, shared, partition, b, inverse, new_r, z, partial_rz, partial_rr);
  }
};

}  // namespace bb::exec
