// One level of multilevel additive Schwarz: a block matrix on nodes, dense factors of blocks of nodes, and the matrix
// of the level above.
#pragma once

#include <cstdint>
#include <vector>

#include "core/linear/symmetric_product.hpp"
#include "core/linear/vertex_clusters.hpp"
#include "core/math/at.hpp"

namespace bb {

class MasLevel {
 public:
  /// The vertices of a matrix. rows is read here alone; its values come with factorize().
  MasLevel(const SymmetricProduct& rows, VertexClusters blocks);
  /// The nodes above `below`: its connected components within blocks, by block and first member, `size` to a block. A
  /// node has as many translations as the member with the most degrees of freedom; the i-th of a member goes to the i-th.
  MasLevel(const MasLevel& below, int size);

  int n_nodes() const { return static_cast<int>(start_.size()) - 1; }
  int n_blocks() const { return blocks_.size(); }
  bool coarsens() const { return n_above_ < n_nodes(); }  // some block has fewer components than nodes

  /// Factorises every block, and makes the matrix of the level above. values: 9 numbers a block of the matrix, rows
  /// first. Sums go in a fixed order. @return false when a block is not positive definite.
  bool factorize(const double* values);
  const double* coarse_values() const { return coarse_.data(); }
  /// Solves with the factors. @return the residual of the level above: sums over its nodes' members.
  const double* solve(const double* residual);
  /// The solution of this level, and of those above: what their nodes move by.
  const double* add(const double* above);

 private:
  void place_members();
  void find_components();
  void make_coarse_graph();
  bool factorize_block(int block, const double* values);
  int width(int node) const { return start_[at(node) + 1] - start_[at(node)]; }
  int n_dofs(int block) const { return block_first_[at(block) + 1] - block_first_[at(block)]; }

  std::vector<int> start_;               // [n_nodes + 1] degrees of freedom before a node
  std::vector<int> row_start_, column_;  // the graph, with the diagonal, both triangles, ascending
  VertexClusters blocks_;
  std::vector<int> place_;           // [n_nodes] degrees of freedom before a node in its block
  std::vector<int> block_first_;     // [n_blocks + 1] degrees of freedom before a block
  std::vector<std::size_t> offset_;  // [n_blocks] of a factor in factor_
  std::vector<double> factor_;       // L of every block, column-major
  std::vector<std::uint8_t> failed_;

  int n_above_ = 0;
  std::vector<int> above_;        // [n_nodes] node of the level above
  std::vector<int> above_start_;  // [n_above + 1] degrees of freedom before one of them
  std::vector<int> above_row_start_, above_column_;
  std::vector<int> gather_start_,
      gather_;                  // of every block above the blocks of this matrix that it is the sum of
  std::vector<double> coarse_;  // its values
  std::vector<double> work_;    // by blocks
  std::vector<double> solution_, residual_above_;
};

}  // namespace bb
