// Rows on lagged contacts (core/terms/lagged_rows.hpp) from the rows of contact of an executor, and their sums in its gradient and matrix.
#pragma once

#include "core/contact/executor/pattern_view.hpp"
#include "core/contact/executor/slot_kernels.hpp"
#include "core/contact/executor/sum_kernels.hpp"
#include "core/terms/lagged_rows.hpp"

namespace bb::exec {

/// load [n]: the force that a row carries, its mollifier included.
struct LoadsOfRows {
  RowEnergy contact;  // rows with their barrier, and mollifiers
  double* load;
  BB_HD void operator()(Index r) const {
    const RowView& rows = contact.rows;
    load[r] = -rows.force[r];
    if (rows.mollified(r)) load[r] *= contact.mollifier.number[contact.mollifier.of(r)];
  }
};

/// Number c of [6, n] is entry (row, column) of the lower triangle, column by column.
BB_HD inline int lower_entry(int row, int column) {
  const int high = row > column ? row : column, low = row > column ? column : row;
  return low * (5 - low) / 2 + high;
}

/// out [3 n_vertices] += the forces of the rows of each vertex, weighted.
struct GatherMotions {
  const double* weight;  // [4, n]
  Index n;
  VertexSlots slots;
  const double* force;  // [3, n] N
  double* out;
  BB_HD void operator()(Index v) const {
    double sum[3] = {0, 0, 0};
    for (Index s = slots.begin[v]; s < slots.begin[v + 1]; ++s) {
      const Index r = slot_row(slots.slot[s]);
      const double of_point = weight[slot_point(slots.slot[s]) * n + r];
      for (int c = 0; c < 3; ++c) sum[c] += of_point * force[c * n + r];
    }
    for (int c = 0; c < 3; ++c) out[3 * v + c] += sum[c];
  }
};

/// Values of the upper blocks.
struct GatherMotionBlocks {
  const double* weight;  // [4, n]
  Index n;
  BlockSources blocks;
  const double* hess;  // [6, n] N/m
  double* value;
  BB_HD void operator()(Index j) const {
    double sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    for (Index i = blocks.begin[j]; i < blocks.begin[j + 1]; ++i) {
      const std::uint32_t code = blocks.code[i];
      const Index r = pair_row_of(code);
      const double ww = weight[pair_a(code) * n + r] * weight[pair_b(code) * n + r];
      for (int c = 0; c < 9; ++c) sum[c] += ww * hess[lower_entry(c % 3, c / 3) * n + r];
    }
    for (int c = 0; c < 9; ++c) value[value_index(j, c)] = sum[c];
  }
};

}  // namespace bb::exec
