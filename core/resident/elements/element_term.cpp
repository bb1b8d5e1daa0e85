#include "core/resident/elements/element_term.hpp"

#include "core/exec/sums/vector_kernels.hpp"

namespace bb::resident {

ElementTerm::ElementTerm(const ResidentInputs& inputs, std::string_view name, TermGroup group, Phase phase,
                         int width, std::span<const int> vertices)
    : executor_(inputs.executor),
      name_(name),
      group_(group),
      phase_(phase),
      matrix_(inputs.matrix),
      family_(matrix_.add_family(width, {vertices.begin(), vertices.end()})),
      energy_(executor_, "element energies", static_cast<Index>(vertices.size()) / width),
      trial_energy_(executor_, "element energies of the trial", energy_.size()) {}

void ElementTerm::linearise(const Column& x, const ResidentContext&, Column& g) {
  matrix_.add_gradients(family_, g.data(), [&](const Piece& piece, double* grad) {
    gradients(piece, x.data(), energy_.data(), grad);
  });
}

void ElementTerm::add_matrix(const Column& x, const HessianRequest& request) {
  matrix_.add_hessians(family_,
                       [&](const Piece& piece, double* hess) { hessians(piece, request, x.data(), hess); });
}

void ElementTerm::add_change(const Column&, const Column&, ResidentChange& out) {
  out.add(size(), energy_.data(), trial_energy_.data());
}

void ElementTerm::add_energy(const Column&, ResidentEnergy& out) { out.add(size(), nullptr, energy_.data()); }

Index ElementTerm::first_not_finite(ResidentLeast& least) {
  least.clear();
  executor_.each(size(), FirstNotFinite{energy_.data(), least.data()});
  return least.first();
}

}  // namespace bb::resident
