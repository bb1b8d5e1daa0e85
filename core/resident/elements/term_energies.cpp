#include "core/resident/elements/term_energies.hpp"

#include "core/exec/sums/vector_kernels.hpp"

namespace bb::resident {

TermEnergies::TermEnergies(exec::Executor& executor, const std::string& what, Index n)
    : executor_(executor),
      energy_(executor, what + " energies", n),
      trial_energy_(executor, what + " energies of the trial", n) {}

void TermEnergies::add_change(const PositionsView&, const PositionsView&, ResidentChange& out) {
  out.add(size(), energy_.data(), trial_energy_.data());
}

void TermEnergies::add_energy(const PositionsView&, ResidentEnergy& out) {
  out.add(size(), nullptr, energy_.data());
}

Index TermEnergies::first_not_finite(ResidentLeast& least) {
  least.clear();
  executor_.each(size(), FirstNotFinite{energy_.data(), least.data()});
  return least.first();
}

}  // namespace bb::resident
