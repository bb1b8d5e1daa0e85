// The restriction of the block matrix to the free degrees of freedom, as a lower scalar matrix with a kept
// map from block values to scalar values.
#pragma once

#include <cstdint>
#include <vector>

#include "core/linear/block_pattern.hpp"
#include "core/linear/block_system.hpp"

namespace bb {

class Reduction {
 public:
  /// fixed: [3 n_vertices]. Errors: ConfigError for another length.
  Reduction(int n_vertices, const std::vector<std::uint8_t>& fixed);

  /// Rebuilds the scalar pattern; pattern_id is a hash of it, so it changes exactly when the pattern changes
  /// and an earlier pattern gets its earlier id back. Cost: O(nonzeros), buffers grow geometrically.
  void build(const BlockPattern& pattern);
  /// Copies block values into the scalar matrix. Cost: O(nonzeros), no allocation.
  const ReducedSystem& fill(const std::vector<double>& values);

  /// The mesh of the systems to come: start positions, and the blocks of `elements` between free vertices.
  void set_mesh(const BlockPattern& elements, const PositionsView& x);

  int n_free() const { return static_cast<int>(free_.size()); }
  const ReducedSystem& system() const { return system_; }
  void restrict_vector(const PositionsView& full, VecXd& reduced) const;
  void expand_vector(const VecXd& reduced, PositionsSpan full) const;

 private:
  int n_free_of(int vertex) const;

  std::vector<int> dof_;   // [3 n_vertices + 3] number of free degrees of freedom before this one
  std::vector<int> free_;  // [n_free] full index
  std::vector<int> map_;   // [nonzeros] index into the block values
  ReducedSystem system_;
};

}  // namespace bb
