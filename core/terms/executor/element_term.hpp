// A term whose elements stay: local terms of one family, in the matrix that it shares with others.
#pragma once

#include <span>

#include "core/terms/executor/term_energies.hpp"
#include "core/terms/executor/term_inputs.hpp"

namespace bb::exec {

class ElementTerm : public TermEnergies {
 public:
  void linearise(const PositionsView& x, const ExecutorContext& context, PositionsSpan g) override;
  void add_matrix(const PositionsView& x, const HessianRequest& request) override;

 protected:
  /// vertices: [width size] element-major.
  ElementTerm(const ExecutorInputs& inputs, int width, std::span<const int> vertices);
  // All pointers are memory of the executor. x: [3 n_vertices] m.
  /// energy [size]; grad [3 width, piece.n], N.
  virtual void gradients(Piece piece, const double* x, double* energy, double* grad) = 0;
  /// hess [lower numbers, piece.n], N/m.
  virtual void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) = 0;

 private:
  ElementMatrix& matrix_;
  std::size_t family_;  // of the matrix
};

}  // namespace bb::exec
