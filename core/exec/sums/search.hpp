// Binary search in ascending columns.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::exec {

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

}  // namespace bb::exec
