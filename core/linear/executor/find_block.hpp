// The block of two vertices in a matrix.
#pragma once

#include "core/exec/sums/search.hpp"
#include "core/linear/executor/executor_matrix.hpp"

namespace bb::exec {

/// Number of the block (row, wanted), -1 where the pattern has none. Columns of a row ascending.
BB_HD inline Index find_block(const Index* row_begin, const int* column, int row, int wanted) {
  const Index end = row_begin[row + 1], at = first_not_below(column, row_begin[row], end, wanted);
  return at < end && column[at] == wanted ? at : -1;
}

}  // namespace bb::exec
