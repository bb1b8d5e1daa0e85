// The part of a matrix that belongs to a few vertices: what stiffness policies read of the elastic matrix.
#pragma once

#include "core/linear/executor/find_block.hpp"

namespace bb::exec {

/// The sub-matrix of at most four vertices, entry by entry; 0 where the pattern has no block.
struct SubMatrix {
  MatrixPart matrix;
  Index block[4][4];
  /// Cost: a search a pair of vertices.
  BB_HD SubMatrix(const MatrixPart& of, const int* vertices, int n) : matrix(of), block{} {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        block[i][j] = find_block(of.row_begin, of.column, vertices[i], vertices[j]);
      }
    }
  }
  BB_HD double operator()(int row, int column) const {
    const Index j = block[row / 3][column / 3];
    return j < 0 ? 0.0 : matrix.value[value_index(j, 3 * (column % 3) + row % 3)];
  }
};

}  // namespace bb::exec
