#include "core/terms/executor/term_energies.hpp"

#include "core/exec/sums/vector_kernels.hpp"

namespace bb::exec {

TermEnergies::TermEnergies(Executor& executor, const std::string& what, Index n)
    : executor_(executor),
      energy_(executor, what + " energies", n),
      trial_energy_(executor, what + " energies of the trial", n) {}

void TermEnergies::add_change(const PositionsView&, const PositionsView&, ExecutorChange& out) {
  out.add(size(), energy_.data(), trial_energy_.data());
}

void TermEnergies::add_energy(const PositionsView&, ExecutorEnergy& out) {
  out.add(size(), nullptr, energy_.data());
}

Index TermEnergies::first_not_finite(ExecutorLeast& least) {
  least.clear();
  executor_.each(size(), FirstNotFinite{energy_.data(), least.data()});
  return least.first();
}

}  // namespace bb::exec
