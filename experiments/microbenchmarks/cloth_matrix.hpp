// The Newton matrix of a cloth-like block system: a grid of triangles and hinges, folded on
// itself by contacts.
#pragma once

#include <memory>
#include <vector>

#include "core/linear/block_system.hpp"

namespace bb::bench {

/// A family of stencils, each with one positive semi-definite local Hessian kappa w w^T (x) (n n^T + I / 10).
struct Family {
  int width = 0;
  std::vector<int> vertices;
  std::vector<double> hess;
  Stencils stencils() const { return {width, vertices}; }
  void add(const std::vector<int>& v, const VecXd& weights, const Vec3d& n, double kappa);
};

/// side x side vertices. With 107: 22k triangles, 34k hinges, 20k contacts.
struct Cloth {
  int side, n;
  Family triangles, hinges, contacts_a, contacts_b;

  explicit Cloth(int vertices_a_side);
  std::unique_ptr<BlockSystem> system() const;
  /// The matrix with these contacts, which must be the ones that were set. Valid until the next call.
  const ReducedSystem& assemble(BlockSystem& s, const Family& contacts) const;

 private:
  void fill_contacts(Family& contacts, unsigned seed) const;
};

}  // namespace bb::bench
