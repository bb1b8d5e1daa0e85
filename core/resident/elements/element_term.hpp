// A term whose elements stay: energies and local terms of one family, in the matrix that it shares with others.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/resident/elements/term_inputs.hpp"

namespace bb::resident {

class ElementTerm : public ResidentTerm {
 public:
  std::string_view name() const override { return name_; }
  TermGroup group() const override { return group_; }
  Phase phase() const override { return phase_; }
  Index size() const { return energy_.size(); }

  void linearise(const Column& x, const ResidentContext& context, Column& g) override;
  void add_matrix(const Column& x, const HessianRequest& request) override;
  void evaluate(const Column& trial) override { values(trial.data(), trial_energy_.data()); }
  void add_change(const Column& x, const Column& trial, ResidentChange& out) override;
  void take_energies() override { energy_.swap(trial_energy_); }
  void evaluate_iterate(const Column& x) override { values(x.data(), energy_.data()); }
  void add_energy(const Column& x, ResidentEnergy& out) override;
  Index first_not_finite(ResidentLeast& least) override;

 protected:
  /// name: of its line of registry.inc. vertices: [width size] element-major.
  ElementTerm(const ResidentInputs& inputs, std::string_view name, TermGroup group, Phase phase, int width,
              std::span<const int> vertices);
  // All pointers are memory of the executor. x: [3 n_vertices] m.
  /// energy [size], J.
  virtual void values(const double* x, double* energy) = 0;
  /// energy [size]; grad [3 width, piece.n], N.
  virtual void gradients(Piece piece, const double* x, double* energy, double* grad) = 0;
  /// hess [lower numbers, piece.n], N/m.
  virtual void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) = 0;

  double* energies() { return energy_.data(); }
  double* trial_energies() { return trial_energy_.data(); }

  exec::Executor& executor_;

 private:
  std::string_view name_;
  TermGroup group_;
  Phase phase_;
  ElementMatrix& matrix_;
  std::size_t family_;                    // of the matrix
  Buffer<double> energy_, trial_energy_;  // [size] J
};

/// Launches of the kernels of Elements (element_kernels.hpp).
template <class Elements>
class TermOf : public ElementTerm {
 protected:
  TermOf(const ResidentInputs& inputs, std::string_view name, std::span<const int> vertices,
         TermGroup group = TermGroup::elastic, Phase phase = Phase::elastic)
      : ElementTerm(inputs, name, group, phase, Elements::width, vertices) {}

  void values(const double* x, double* energy) override {
    executor_.each(elements_.n, ElementValues<Elements>{elements_, x, energy});
  }
  void gradients(Piece piece, const double* x, double* energy, double* grad) override {
    executor_.each(piece.n, ElementGradients<Elements>{elements_, piece, x, energy, grad});
  }
  void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) override {
    executor_.each(piece.n, ElementHessians<Elements>{elements_, piece, request, x, hess});
  }

  Elements elements_{};
};

}  // namespace bb::resident
