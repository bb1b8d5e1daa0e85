// Binary search in ascending columns.
#pragma once

#include "core/linear/executor/resident_matrix.hpp"

namespace bb::resident {

/// First number of [begin, end) for which column[number] >= value; columns ascending.
template <class T>
BB_HD inline Index first_not_below(const T* column, Index begin, Index end, T value) {
  while (begin < end) {
    const Index middle = begin + (end - begin) / 2;
    if (column[middle] < value) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

/// Number of the block (row, wanted), -1 where the pattern has none. Columns of a row ascending.
BB_HD inline Index find_block(const Index* row_begin, const int* column, int row, int wanted) {
  const Index end = row_begin[row + 1], at = first_not_below(column, row_begin[row], end, wanted);
  return at < end && column[at] == wanted ? at : -1;
}

}  // namespace bb::resident
