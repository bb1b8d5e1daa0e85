// One level of additive Schwarz: dense factors of the clusters of a level, and their application.
#pragma once

#include <cmath>

#include "core/linear/executor/block_factor.hpp"

namespace bb::exec {

/// Nodes of a level (vertices, or clusters of the level below) in clusters of at most 16.
struct ClusterLevel {
  static constexpr int most_nodes = 16, most_rows = 3 * most_nodes;
  Index n_clusters;
  const int *start, *member;  // [n_clusters + 1], [n] nodes by cluster
  const int *of, *place;      // [n] the cluster of a node, and where in it the node is
  const FixedMask* fixed;     // [n]
  const Index* offset;        // [n_clusters] of a factor in `factor`
  double* factor;             // S of each cluster, column-major: L^-1 in both triangles
  BB_HD int n_rows(Index k) const { return 3 * (start[k + 1] - start[k]); }
};

/// How FactorFaults count the nodes of a level; vertices are level 0.
BB_HD inline Index level_fault(Index level, Index node) { return (level << 48) + node; }

/// A block of threads makes the factor of one cluster: A = L L^T over its free degrees of freedom, the identity over
/// the fixed ones, then S(i, j) = L^-1(max(i, j), min(i, j)).
struct FactorizeClusters {
  static constexpr int stride = ClusterLevel::most_rows + 1;  // columns begin in different banks
  struct Shared {
    double a[ClusterLevel::most_rows * stride];
  };
  ClusterLevel level;
  ExecutorMatrix matrix;
  Index number;  // of the level
  FactorFaults* faults;

  // Number c of the blocks of a node's row.
  BB_HD void fill(double* a, Index cluster, int member, int c) const {
    const int node = level.member[level.start[cluster] + member], row = 3 * member + c % 3;
    for (const MatrixPart& part : matrix.part) {
      if (!part.row_begin) continue;
      for (Index j = part.row_begin[node]; j < part.row_begin[node + 1]; ++j) {
        const int other = part.column[j];
        if (level.of[other] != cluster) continue;
        if (is_fixed(level.fixed[node], c % 3) || is_fixed(level.fixed[other], c / 3)) continue;
        a[(3 * level.place[other] + c / 3) * stride + row] += part.value[value_index(j, c)];
      }
    }
  }

  // Of a pivot after its subtractions.
  BB_HD static FactorStatus judge(double pivot, double largest) {
    if (!is_finite(pivot)) return FactorStatus::non_finite;
    if (pivot > 0) return FactorStatus::ok;
    return pivot < -32 * DBL_EPSILON * largest ? FactorStatus::indefinite : FactorStatus::singular;
  }

  // The lower triangle, a column after the other; `column`: how far it came.
  template <class Block>
  BB_HD static FactorStatus factorize(Block& block, Shared& s, int m, int& column) {
    double largest = 0;
    for (int i = 0; i < m; ++i) largest = largest < s.a[i * stride + i] ? s.a[i * stride + i] : largest;
    block.threads(0, [](int) {});  // all have read the diagonal
    for (column = 0; column < m; ++column) {
      const int k = column;
      const double pivot = s.a[k * stride + k];
      const FactorStatus status = judge(pivot, largest);
      if (status != FactorStatus::ok) return status;
      block.threads(0, [](int) {});  // all have read the pivot
      const double root = std::sqrt(pivot);
      block.threads(m, [&](int t) {
        if (t == k) s.a[k * stride + k] = root;
        if (t > k) s.a[k * stride + t] /= root;
      });
      block.threads([&](int t) {
        const int rest = m - k - 1;
        for (int e = t; e < rest * rest; e += block_threads) {
          const int i = k + 1 + e % rest, j = k + 1 + e / rest;
          if (i >= j)
            s.a[j * stride + i] = fma(-s.a[k * stride + i], s.a[k * stride + j], s.a[j * stride + i]);
        }
      });
    }
    return FactorStatus::ok;
  }

  // Column j of L^-1 below its diagonal, into row j of the upper triangle.
  BB_HD static void invert_column(double* a, int j, int m) {
    for (int i = j + 1; i < m; ++i) {
      double sum = a[j * stride + i] / a[j * stride + j];
      for (int k = j + 1; k < i; ++k) sum = fma(a[k * stride + i], a[k * stride + j], sum);
      a[i * stride + j] = -sum / a[i * stride + i];
    }
  }

  template <class Block>
  BB_HD void operator()(Block& block, Shared& s, Index cluster) const {
    const int m = level.n_rows(cluster);
    block.threads([&](int t) {
      for (int i = t; i < ClusterLevel::most_rows * stride; i += block_threads) s.a[i] = 0;
    });
    block.threads(3 * m, [&](int t) { fill(s.a, cluster, t / 9, t % 9); });
    block.threads(m, [&](int t) {
      if (is_fixed(level.fixed[level.member[level.start[cluster] + t / 3]], t % 3)) {
        s.a[t * stride + t] = 1;
      }
    });
    int column;
    const FactorStatus status = factorize(block, s, m, column);
    if (status != FactorStatus::ok) {
      const int node = level.member[level.start[cluster] + column / 3];
      block.once([&] { report_fault(faults, status, level_fault(number, node)); });
      return;
    }
    block.threads(m, [&](int t) { invert_column(s.a, t, m); });
    block.threads([&](int t) {
      double* out = level.factor + level.offset[cluster];
      for (int e = t; e < m * m; e += block_threads) {
        const int i = e % m, j = e / m, low = i < j ? i : j, high = i < j ? j : i;
        out[e] = i == j ? 1 / s.a[i * stride + i] : s.a[high * stride + low];
      }
    });
  }
};

/// z = A_k^-1 r in every cluster, four clusters a block of threads; the sums of r over clusters are the right-hand side
/// of the next level, where there is one. Nothing where `state` is there and not running.
struct SolveClusters {
  static constexpr int clusters_a_block = 4, threads = block_threads / clusters_a_block;
  static_assert(ClusterLevel::most_rows <= threads);
  struct Shared {
    double r[block_threads], y[block_threads];
  };
  ClusterLevel level;
  const double* r;
  double *z, *coarse_r;
  const CgState* state;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& s, Index b) const {
    if (state && !state->running()) return;
    // f(cluster, its number of rows, row, its part of shared memory)
    const auto rows = [&](const auto& f) {
      block.threads([&](int t) {
        const Index k = b * clusters_a_block + t / threads;
        if (k >= level.n_clusters) return;
        const int m = level.n_rows(k), i = t % threads;
        if (i < m) f(k, m, i, t - i);
      });
    };
    const auto number = [&](Index k, int i) {
      return 3 * static_cast<Index>(level.member[level.start[k] + i / 3]) + i % 3;
    };
    rows([&](Index k, int, int i, int at) { s.r[at + i] = r[number(k, i)]; });
    rows([&](Index k, int m, int i, int at) {
      const double* a = level.factor + level.offset[k] + i;
      double y = 0;
      for (int j = 0; j <= i; ++j) y = fma(a[j * m], s.r[at + j], y);
      s.y[at + i] = y;
    });
    rows([&](Index k, int m, int i, int at) {
      const double* a = level.factor + level.offset[k] + i;
      double x = 0;
      for (int j = i; j < m; ++j) x = fma(a[j * m], s.y[at + j], x);
      z[number(k, i)] = x;
      if (i >= 3 || !coarse_r) return;
      double sum = 0;
      for (int j = i; j < m; j += 3) sum += s.r[at + j];
      coarse_r[3 * k + i] = sum;
    });
  }
};

}  // namespace bb::exec
