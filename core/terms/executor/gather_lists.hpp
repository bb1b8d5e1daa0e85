// What the gathers of a piece of elements read, made once on the host from the stencils.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/energy/families/element_kernels.hpp"
#include "core/exec/buffer.hpp"
#include "core/linear/block_system.hpp"
#include "core/terms/executor/gather_kernels.hpp"

namespace bb::exec {

/// Rows of the blocks that elements have, both triangles, every diagonal block among them.
struct BlockRows {
  std::vector<Index> row_begin;  // [n + 1]
  std::vector<int> column;       // ascending within a row
};

/// Errors: ConfigError for a vertex outside [-1, n_vertices) and for more than 2^32 blocks.
BlockRows block_rows(int n_vertices, std::span<const Stencils> families);

/// Cost: O(elements, and the range of their vertices) on the host. Memory: 4 B a contribution and 8 B a target.
class GatherLists {
 public:
  /// stencils: of one piece, at most 2^27 elements.
  GatherLists(Executor& executor, const Stencils& stencils, const BlockRows& rows);
  /// grad, hess: the local terms of the piece's n elements.
  void add_gradients(Executor& executor, Index n, const double* grad, double* g) const;
  void add_hessians(Executor& executor, Index n, const double* hess, double* value) const;

 private:
  struct Lists {
    explicit Lists(Executor& executor, const char* name);
    void upload(std::span<const std::uint32_t> targets, std::span<const std::uint32_t> starts,
                std::span<const std::uint32_t> sources);
    GatherView view() const { return {target.data(), start.data(), source.data()}; }
    Buffer<std::uint32_t> target, start, source;
  };
  Lists vertices_, blocks_;
};

}  // namespace bb::exec
