// A block matrix in an executor's memory: rows of 3 x 3 blocks, both triangles, values as planes of eight blocks.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::resident {

/// Columns of a row ascending. Number c = 3 row + column of block j is value[((j / 8) * 9 + c) * 8 + j % 8].
struct MatrixPart {
  const exec::Index* row_begin;  // [n + 1]
  const int* column;
  const double* value;
};

}  // namespace bb::resident
