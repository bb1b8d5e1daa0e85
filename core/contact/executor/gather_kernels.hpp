// Sums of row terms onto vertices and blocks: every vertex and every block adds up its own contributions, in their
// order.
#pragma once

#include "core/contact/executor/mollified_column.hpp"
#include "core/contact/executor/pattern_view.hpp"
#include "core/contact/executor/slot_kernels.hpp"
#include "core/contact/executor/term_kernels.hpp"
#include "core/contact/obstacle.hpp"

namespace bb::exec {

/// Adds to out [3 n_vertices] what the rows of each vertex have for it: of mollified rows their numbers, of the others
/// term.add(rows, row, weight of the vertex, sum).
template <class Term>
struct GatherRows {
  RowView rows;
  VertexSlots slots;
  MollifiedColumn mollified;
  Term term;
  double* out;
  BB_HD void operator()(Index v) const {
    double sum[3] = {0, 0, 0};
    for (Index s = slots.begin[v]; s < slots.begin[v + 1]; ++s) {
      const Index r = slot_row(slots.slot[s]);
      const int k = slot_point(slots.slot[s]);
      if (rows.mollified(r)) {
        const Index i = mollified.of(r);
        for (int c = 0; c < 3; ++c) sum[c] += mollified.number[(3 * k + c) * mollified.n + i];
      } else {
        term.add(rows, r, rows.weight[k * rows.n + r], sum);
      }
    }
    for (int c = 0; c < 3; ++c) out[3 * v + c] += sum[c];
  }
};

/// The gradient of B, N.
struct RowForce {
  BB_HD void add(const RowView& rows, Index r, double weight, double* sum) const {
    for (int c = 0; c < 3; ++c) sum[c] += rows.force[r] * (weight * rows.normal[c * rows.n + r]);
  }
};

/// How the gradient changes along a motion of prescribed vertices [3 n_vertices]: add_given_motion() of
/// core/contact/contact_terms.hpp.
struct RowGivenMotion {
  const double* motion;
  BB_HD void add(const RowView& rows, Index r, double weight, double* sum) const {
    const double closing = closing_motion(rows, r);
    if (closing == 0) return;
    const double size = rows.stiffness[r] * closing * weight;
    for (int c = 0; c < 3; ++c) sum[c] += size * rows.normal[c * rows.n + r];
  }

 private:
  BB_HD double closing_motion(const RowView& rows, Index r) const {
    double closing = 0;
    for (int k = 0; k < 4; ++k) {
      const Index vertex = rows.vertex[k * rows.n + r];
      if (vertex < 0) continue;
      const Vec3d moved(motion[3 * vertex], motion[3 * vertex + 1], motion[3 * vertex + 2]);
      closing += rows.weight[k * rows.n + r] * rows.normal_of(r).dot(moved);
    }
    return closing;
  }
};

/// Values of the upper blocks, from the rows that need no Hessian of their own.
struct GatherStreamed {
  RowView rows;
  BlockSources blocks;
  const double* x;
  SurfaceView surface;
  HessianChoice choice;
  double* value;

  BB_HD void operator()(Index j) const {
    double sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    for (Index i = blocks.begin[j]; i < blocks.begin[j + 1]; ++i) {
      const std::uint32_t code = blocks.code[i];
      const Index r = pair_row_of(code);
      if (has_own_hessian(rows, choice.mode, r)) continue;
      const double wa = rows.weight[pair_a(code) * rows.n + r], wb = rows.weight[pair_b(code) * rows.n + r];
      if (choice.mode == HessianMode::gauss_newton || rows.force[r] == 0) {
        add_stiffness(r, wa, wb, sum);
      } else {
        add_fixed_points(r, wa * wb, sum);
      }
    }
    for (int c = 0; c < 9; ++c) value[value_index(j, c)] = sum[c];
  }

 private:
  BB_HD void add_stiffness(Index r, double wa, double wb, double* sum) const {
    const Vec3d n = rows.normal_of(r), ga = wa * n, gb = wb * n;
    for (int c = 0; c < 9; ++c) sum[c] += rows.stiffness[r] * (ga[c % 3] * gb[c / 3]);
  }
  /// Rows whose closest points slide nowhere, grad^2 d included.
  BB_HD void add_fixed_points(Index r, double ww, double* sum) const {
    const auto [curvature, flat] = row_curvature(rows, surface, r, x);
    const double stiffness = rows.stiffness[r], force = rows.force[r] * curvature;
    const Vec3d n = rows.normal_of(r);
    const Mat3d one = fixed_points_block<double>(n, flat, stiffness, force, choice.projection_of(rows, r));
    if (!choice.blended) {
      for (int c = 0; c < 9; ++c) sum[c] += ww * one(c % 3, c / 3);
      return;
    }
    const Mat3d exact = fixed_points_block<double>(n, flat, stiffness, force, Projection::none);
    for (int c = 0; c < 9; ++c) sum[c] += ww * blend(exact(c % 3, c / 3), one(c % 3, c / 3), choice.t);
  }
};

/// Adds the Hessians of a chunk of rows to the upper blocks. An item is a pair of points of a row: of those with one
/// block, the first in the order of the block adds all of them up. So the cost is that of the chunk, whatever the matrix
/// holds besides.
struct GatherDense {
  RowView rows;
  BlockSources blocks;
  RowChunk chunk;
  HessianMode mode;
  Index stride;
  const double* number;  // [row_numbers][stride]
  double* value;

  BB_HD void operator()(Index item) const {
    const Index r = chunk.row(item >> 4);
    if (!has_own_hessian(rows, mode, r)) return;
    const std::uint32_t own = static_cast<std::uint32_t>(r) << 4 | static_cast<std::uint32_t>(item & 15);
    const Index j = block_of(own);
    if (j < 0) return;
    const Index end = blocks.begin[j + 1];
    Index i = first_not_below(blocks.code, Index{blocks.begin[j]}, end, own);
    if (!is_first(j, i)) return;
    const Index last = chunk.last_row();
    double sum[9];
    for (int c = 0; c < 9; ++c) sum[c] = value[value_index(j, c)];
    for (; i < end && pair_row_of(blocks.code[i]) <= last; ++i) {
      const std::uint32_t code = blocks.code[i];
      const Index row = pair_row_of(code);
      if (has_own_hessian(rows, mode, row)) add(chunk.place(row), pair_a(code), pair_b(code), sum);
    }
    for (int c = 0; c < 9; ++c) value[value_index(j, c)] = sum[c];
  }

 private:
  /// The upper block of two free points of a row; -1 where they have none.
  BB_HD Index block_of(std::uint32_t code) const {
    const Index r = pair_row_of(code);
    const int a = pair_a(code), b = pair_b(code);
    if (!rows.is_free(r, a) || !rows.is_free(r, b)) return -1;
    const int row = rows.vertex[a * rows.n + r], column = rows.vertex[b * rows.n + r];
    if (column < row) return -1;
    return first_not_below(blocks.column, blocks.row_begin[row], blocks.row_begin[row + 1], column);
  }
  /// Whether no row of the chunk comes before contribution i of block j.
  BB_HD bool is_first(Index j, Index i) const {
    while (i > static_cast<Index>(blocks.begin[j]) && pair_row_of(blocks.code[i - 1]) >= chunk.first_row()) {
      if (has_own_hessian(rows, mode, pair_row_of(blocks.code[i - 1]))) return false;
      --i;
    }
    return true;
  }
  /// Block (a, b) of a row is stored, column-major, when a >= b; else its transpose is.
  BB_HD void add(Index at, int a, int b, double* sum) const {
    const bool stored = a >= b;
    const int high = stored ? a : b, low = stored ? b : a;
    const int first = 9 * (low * (9 - low) / 2 + (high - low));
    for (int c = 0; c < 9; ++c) {
      sum[c] += number[(first + (stored ? c : 3 * (c % 3) + c / 3)) * stride + at];
    }
  }
};

/// Blocks below the diagonal are those above it, transposed.
struct MirrorBlocks {
  BlockSources blocks;
  int n_vertices;
  double* value;
  BB_HD void operator()(Index j) const {
    const int column = blocks.column[j];
    // the last row that begins at or before j
    const int row = static_cast<int>(
        first_not_below(blocks.row_begin, Index{0}, static_cast<Index>(n_vertices) + 1, j + 1) - 1);
    if (column >= row) return;
    const Index from =
        first_not_below(blocks.column, blocks.row_begin[column], blocks.row_begin[column + 1], row);
    for (int c = 0; c < 9; ++c) value[value_index(j, c)] = value[value_index(from, 3 * (c % 3) + c / 3)];
  }
};

}  // namespace bb::exec
