// A term on an executor whose elements stay within a step: their energies at the iterate and at a trial.
#pragma once

#include <string>

#include "core/terms/executor/executor_term.hpp"

namespace bb::exec {

class TermEnergies : public ExecutorTerm {
 public:
  /// Elements.
  Index size() const { return energy_.size(); }
  void add_change(const PositionsView& x, const PositionsView& trial, ExecutorChange& out) override;
  void take_energies() override { energy_.swap(trial_energy_); }
  void add_energy(const PositionsView& x, ExecutorEnergy& out) override;
  Index first_not_finite(ExecutorLeast& least) override;

 protected:
  /// what: elements, in the names of buffers.
  TermEnergies(Executor& executor, const std::string& what, Index n);
  /// Other elements, without energies.
  void fit_energies(Index n) { energy_.fit(n), trial_energy_.fit(n); }
  double* energies() { return energy_.data(); }
  double* trial_energies() { return trial_energy_.data(); }

  Executor& executor_;

 private:
  Column energy_, trial_energy_;  // [size] J
};

}  // namespace bb::exec
