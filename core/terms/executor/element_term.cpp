#include "core/terms/executor/element_term.hpp"

namespace bb::exec {

ElementTerm::ElementTerm(const ExecutorInputs& inputs, int width, std::span<const int> vertices)
    : TermEnergies(inputs.executor, "element", static_cast<Index>(vertices.size()) / width),
      matrix_(inputs.matrix),
      family_(matrix_.add_family(width, {vertices.begin(), vertices.end()})) {}

void ElementTerm::linearise(const PositionsView& x, const ExecutorContext&, PositionsSpan g) {
  matrix_.add_gradients(family_, g.data(), [&](const Piece& piece, double* grad) {
    gradients(piece, x.data(), energies(), grad);
  });
}

void ElementTerm::add_matrix(const PositionsView& x, const HessianRequest& request) {
  matrix_.add_hessians(family_,
                       [&](const Piece& piece, double* hess) { hessians(piece, request, x.data(), hess); });
}

}  // namespace bb::exec
