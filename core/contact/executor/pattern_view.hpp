// The pattern of contact rows as kernels read it.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::exec {

/// What a gather reads.
struct VertexSlots {
  const Index* begin;         // [n_vertices + 1]
  const std::uint32_t* slot;  // 4 row + point, ascending for every vertex
};
struct BlockSources {
  const Index* row_begin;  // [n_vertices + 1]
  const int* column;       // ascending for every row; both triangles, the diagonal of every vertex with a row
  const std::uint32_t* begin;  // [blocks + 1]; fewer than 2^28 rows have at most 10 each
  const std::uint32_t* code;   // 16 row + 4 a + b, ascending; none below the diagonal
};

}  // namespace bb::exec
