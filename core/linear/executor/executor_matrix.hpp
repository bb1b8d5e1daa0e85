// The symmetric Newton matrix in an executor's memory: rows of 3x3 blocks, both triangles, so that a row needs no other.
#pragma once

#include "core/exec/kernel.hpp"
#include "core/exec/sums/fixed_mask.hpp"

namespace bb::exec {

/// Where number c of block j is: planes of eight blocks, so that eight lanes that read eight blocks read whole lines.
/// c = 3 column + row.
BB_HD inline Index value_index(Index j, int c) { return ((j / 8) * 9 + c) * 8 + j % 8; }
/// Numbers to allocate for n blocks.
BB_HD inline Index value_count(Index n_blocks) { return (n_blocks + 7) / 8 * 72; }

/// Block rows of all vertices; columns need no order within a row. Rows and columns of fixed degrees of freedom (FixedMask) count
/// as those of the identity.
struct MatrixPart {
  const Index* row_begin;  // [n_vertices + 1] number of the first block of a row; null: no such part
  const int* column;       // [n_blocks]
  const double* value;     // [value_count(n_blocks)]
  bool operator==(const MatrixPart&) const = default;
};

/// The sum of some parts: elements, whose pattern stays, contacts, whose pattern changes, and terms on the contacts that a step
/// begins with.
struct ExecutorMatrix {
  static constexpr int most_parts = 4;
  MatrixPart part[most_parts];
  bool operator==(const ExecutorMatrix&) const = default;
};

/// Which rows a block of threads takes: a function of their number alone, so that sums are the same everywhere.
struct Partition {
  Index n_rows, rows_a_block;
  bool operator==(const Partition&) const = default;
  static constexpr Index most_blocks = 1024;
  static Partition of(Index n_rows) {
    const Index each = (n_rows + most_blocks - 1) / most_blocks;
    return {n_rows, each < 32 ? 32 : (each + 31) / 32 * 32};
  }
  BB_HD Index n_blocks() const { return (n_rows + rows_a_block - 1) / rows_a_block; }
  BB_HD Index first(Index b) const { return b * rows_a_block; }
  BB_HD Index last(Index b) const {
    const Index end = (b + 1) * rows_a_block;
    return end < n_rows ? end : n_rows;
  }
  /// Threads of a block that have one of its numbers or more, `each` numbers a row.
  BB_HD int width(int each) const { return fold_width(each * rows_a_block); }
};

}  // namespace bb::exec
