// For one family of stencils: which local 3x3 Hessian blocks add up to which block of the matrix, and which
// local gradients to which vertex. Every target owns its contributions in the order of the elements, so the
// sum is the same for any number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/linear/block_pattern.hpp"
#include "core/linear/block_system.hpp"
#include "core/linear/local_hessians.hpp"

namespace bb {

class GatherMap {
 public:
  /// The same stencils as those of the last build.
  bool same(const Stencils& stencils) const;
  /// Errors: ConfigError for a vertex outside [-1, n_vertices). Cost: O(contributions), buffers are reused.
  void build(const Stencils& stencils, int n_vertices);
  /// Looks up the blocks in a pattern that holds all of them. Cost: O(blocks of the pattern).
  void place(const BlockPattern& pattern);

  /// Blocks touched, as columns of ascending rows.
  std::span<const int> column_start() const { return column_start_; }
  std::span<const int> rows() const { return row_; }

  /// [targets + 1] where the contributions of a target begin in sources(). Targets: as rows().
  std::span<const std::uint32_t> source_start() const { return source_start_; }
  /// 2 * number of a 3x3 block in the local Hessians (lower blocks, element by element), + 1 where it is transposed.
  std::span<const std::uint32_t> sources() const { return source_; }
  /// [n_vertices + 1] where the contributions to a vertex begin in gradient_sources(): offsets in the local gradients.
  std::span<const std::size_t> gradient_start() const { return vertex_start_; }
  std::span<const std::size_t> gradient_sources() const { return vertex_source_; }

  std::size_t n_elements() const {
    return width_ == 0 ? 0 : vertices_.size() / static_cast<std::size_t>(width_);
  }
  int width() const { return width_; }
  Stencils stencils() const { return {width_, vertices_}; }
  /// values [9 x blocks] += local Hessians. A target adds its contributions to what it has in the order of the elements: kernels
  /// add in the same order, to the same bits. Cost: one read of `hess`, one read and write of the targets, 4 bytes of index a
  /// contribution.
  void add_hessians(const LocalHessians& hess, std::vector<double>& values) const;
  /// g [3 x n] += local gradients [size * 3 width].
  void add_gradients(std::span<const double> grad, PositionsSpan g) const;

 private:
  void check(const Stencils& stencils, int n_vertices) const;
  void sort_contributions(int n_vertices);
  void write_targets(int n_vertices);
  void build_gradient_map(int n_vertices);
  template <class Blocks, bool Ahead>
  void add_targets(const LocalHessians& hess, double* values) const;

  int width_ = 0;
  std::vector<int> vertices_;                // copy of the stencils
  std::vector<int> column_start_;            // [n + 1] targets of a column
  std::vector<int> row_;                     // [n_targets] ascending within a column
  std::vector<int> block_;                   // [n_targets] index in the pattern
  std::vector<std::uint8_t> mixed_;          // [n_targets] 1 where a contribution is transposed
  std::vector<std::uint32_t> source_start_;  // [n_targets + 1]
  std::vector<std::uint32_t>
      source_;  // [n_contributions] 2 * number of the 3x3 block in hess, + 1: transposed
  std::vector<std::size_t> vertex_start_;   // [n + 1]
  std::vector<std::size_t> vertex_source_;  // offset in grad
  // scratch of build
  std::vector<std::size_t> key_start_, cursor_;  // [n + 1]
  std::vector<std::uint64_t> key_;               // row << 32 | number of the contribution
};

}  // namespace bb
