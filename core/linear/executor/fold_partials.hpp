// Sums over blocks of threads.
#pragma once

#include "core/linear/executor/executor_matrix.hpp"

namespace bb::exec {

/// The sum of partial [n]: every thread adds each 256th, then a tree. The same in all blocks that compute it.
/// scratch: [256] in shared memory, free afterwards.
template <class Block>
BB_HD double fold_partials(Block& block, double* scratch, const double* partial, Index n) {
  const int width = fold_width(n);
  block.threads(width, [=](int t) {
    double sum = 0;
    for (Index i = t; i < n; i += width) sum += partial[i];
    scratch[t] = sum;
  });
  fold(block, scratch, width);
  const double total = scratch[0];
  block.threads(0, [](int) {});  // all have read it
  return total;
}

}  // namespace bb::exec
