// Local terms of a piece of elements summed into vertices and blocks: every target owns its contributions, sorted by
// element, and adds them one after the other to what it has. So the sum does not depend on how elements are cut into
// pieces. Values of blocks: core/linear/executor/executor_matrix.hpp.
#pragma once

#include "core/linear/executor/executor_matrix.hpp"
#include "core/linear/executor/find_block.hpp"

namespace bb::exec {

/// Targets of a piece and their contributions.
struct GatherView {
  const std::uint32_t* target;  // [targets] vertex, or block
  const std::uint32_t* start;   // [targets + 1] into source
  const std::uint32_t*
      source;  // vertices: element << 2 | local vertex. blocks: element << 5 | lower block << 1 |
               // 1 where it is transposed. element: within the piece
};

/// g [3 n_vertices] += local gradients.
struct GatherVertices {
  GatherView gather;
  const double* grad;  // [3 width, n]
  Index n;             // elements of the piece
  double* g;           // N
  BB_HD void operator()(Index i) const {
    double* out = g + 3 * static_cast<Index>(gather.target[i]);
    double sum[3] = {out[0], out[1], out[2]};
    for (std::uint32_t k = gather.start[i]; k < gather.start[i + 1]; ++k) {
      const Index element = gather.source[k] >> 2, vertex = gather.source[k] & 3;
      for (int c = 0; c < 3; ++c) sum[c] += grad[(3 * vertex + c) * n + element];
    }
    for (int c = 0; c < 3; ++c) out[c] = sum[c];
  }
};

/// Blocks of the lower triangle += local Hessians.
struct GatherBlocks {
  GatherView gather;
  const double* hess;  // [9 lower blocks, n]
  Index n;             // elements of the piece
  double* value;       // N/m
  BB_HD void operator()(Index i) const {
    const Index block = gather.target[i];
    double sum[9];
    for (int c = 0; c < 9; ++c) sum[c] = value[value_index(block, c)];
    for (std::uint32_t k = gather.start[i]; k < gather.start[i + 1]; ++k) {
      const std::uint32_t source = gather.source[k];
      const Index element = source >> 5, first = 9 * static_cast<Index>(source >> 1 & 15);
      const bool transposed = (source & 1) != 0;
      for (int c = 0; c < 9; ++c) {
        const int from = transposed ? 3 * (c % 3) + c / 3 : c;
        sum[c] += hess[(first + from) * n + element];
      }
    }
    for (int c = 0; c < 9; ++c) value[value_index(block, c)] = sum[c];
  }
};

/// The upper triangle from the lower one; item: a block above the diagonal.
struct MirrorBlock {
  const std::uint32_t *to, *from;  // that block, and the one that it is the transpose of
  double* value;
  BB_HD void operator()(Index i) const {
    const Index above = to[i], below = from[i];
    for (int c = 0; c < 9; ++c) {
      value[value_index(above, c)] = value[value_index(below, 3 * (c % 3) + c / 3)];
    }
  }
};

}  // namespace bb::exec
