// The Newton matrix as symmetric 3x3 blocks, and its restriction to the free degrees of freedom.
// Pattern, gather maps and the symbolic state stay while the contact pattern stays.
#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/linear/local_hessians.hpp"
#include "core/math/types.hpp"

namespace bb {

class Archive;

/// Which vertices the elements of one family touch: element e owns vertices[width e .. width e + width),
/// -1 = none.
struct Stencils {
  int width = 0;
  std::span<const int> vertices;
  std::size_t size() const { return width == 0 ? 0 : vertices.size() / static_cast<std::size_t>(width); }
};

/// What is known of the blocks of a reduced system beside its matrix; an empty list: not known.
struct BlockMesh {
  std::vector<Vec3d> point;    // [n_blocks] m, where their vertices start
  std::vector<int> row_start;  // [n_blocks + 1] into neighbour
  std::vector<int> neighbour;  // the blocks that an element joins with a block, ascending, without itself
};

/// What a linear solver and a condition estimator see: lower triangle, free degrees of freedom only.
struct ReducedSystem {
  Eigen::SparseMatrix<double> lower;  // [n x n] column-major, lower triangle with diagonal
  std::vector<int> block_start;   // [n_blocks + 1] degrees of freedom of one vertex are consecutive (1 to 3)
  std::vector<int> block_vertex;  // [n_blocks] vertex of each, for messages; empty: the number of the block
  std::uint64_t pattern_id =
      0;  // a hash of the pattern of lower: changes exactly with it; 0 = unknown, never reused
  std::shared_ptr<const BlockMesh> mesh;  // null where no solver wants it (LinearSolver::wants_mesh)
};

class BlockSystem {
 public:
  /// fixed: [3 n_vertices], nonzero where the degree of freedom is prescribed or locked (eliminated).
  BlockSystem(int n_vertices, const std::vector<std::uint8_t>& fixed);
  ~BlockSystem();

  /// Families that never change (elements). Called once.
  void set_elements(std::vector<Stencils> families);
  /// Makes the mesh of the reduced systems, of these elements: x [3 x n_vertices] m, where vertices start. Cost: O(blocks).
  void set_mesh(const PositionsView& x);
  /// Families of this iterate (contacts). Returns true when the block pattern changed: values() is then zero,
  /// of another length, and copies of it are void. Same stencils cost one comparison. A contact stencil whose
  /// blocks all exist already does not change the pattern (pattern_id stays); blocks of no stencil
  /// any more leave it. Cost: linear in stencils and blocks; no allocation unless something
  /// outgrows its buffer.
  bool set_contacts(std::vector<Stencils> families);

  /// The stencils of the contacts, and so the pattern: what decides whether the next ones change it. Values are not kept.
  void keep(Archive& archive);

  /// Values: one 9-vector a lower block. Stages add up in the order of the calls; fixed order,
  /// any thread count.
  using Values = std::vector<double>;
  void clear();
  void add_diagonal(std::span<const double> per_vertex);  // value * I3
  void add_elements(std::size_t family, const LocalHessians& hess);
  void add_contacts(std::size_t family, const LocalHessians& hess);
  const Values& values() const;
  /// Hands the sum over without a copy: `out` gets the values, whose place takes the old content of `out` until
  /// the next clear().
  void take_values(Values& out);

  /// Gradient gathers: g [3 x n] += local gradients [size * 3w].
  void gather_elements(std::size_t family, std::span<const double> grad, PositionsSpan g) const;
  void gather_contacts(std::size_t family, std::span<const double> grad, PositionsSpan g) const;

  /// 3k x 3k sub-matrix of `values` on k <= 4 vertices, written into the top left of a 12 x 12 column-major
  /// block (leading dimension 12); blocks between unconnected vertices are 0.
  void submatrix(const Values& values, const int* vertices, int k, double* out) const;
  /// Copies the blocks of `values` that elements have, in an order that no contact changes: such a copy stays
  /// valid when the pattern changes.
  void element_values(const Values& values, Values& out) const;
  /// submatrix() of such a copy.
  void element_submatrix(const Values& element_values, const int* vertices, int k, double* out) const;
  /// y += A v over all vertices, fixed ones included (used to lift prescribed motion to the right-hand side).
  void multiply_add(const Values& values, const PositionsView& v, PositionsSpan y) const;

  /// Restriction to the free degrees of freedom. The reference stays valid; values are overwritten
  /// by each call.
  const ReducedSystem& reduce(const Values& values);
  int n_free() const;
  void restrict_vector(const PositionsView& full, VecXd& reduced) const;
  void expand_vector(const VecXd& reduced, PositionsSpan full) const;  // leaves fixed entries as they are

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace bb
