// A term on an executor that pulls single vertices to places: what VertexQuadratic (core/terms) is on the host.
#pragma once

#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/quadratic_kernels.hpp"

namespace bb::resident {

class QuadraticTerm : public TermOf<Quadratics> {
 public:
  /// A square of differences, not a difference of squares.
  void add_change(const Column& x, const Column& trial, ResidentChange& out) override {
    double* const magnitude = change_.data() + size();
    executor_.each(size(), QuadraticChanges{elements_, x.data(), trial.data(), change_.data(), magnitude});
    out.add_parts(size(), change_.data(), magnitude);
  }

 protected:
  QuadraticTerm(const ResidentInputs& inputs, std::string_view name, const std::vector<int>& vertices)
      : TermOf(inputs, name, vertices, TermGroup::load, Phase::assembly),
        vertex_(executor_, std::string(name) + " vertices"),
        place_(executor_, std::string(name) + " places", 3 * size()),
        matrix_(executor_, std::string(name) + " matrices", 9 * size()),
        change_(executor_, std::string(name) + " changes", 2 * size()) {
    vertex_.upload(vertices);
    elements_.of = vertex_.data();
    elements_.n = size();
    elements_.place = place_.data(), elements_.matrix = matrix_.data();
  }

  Buffer<int> vertex_;
  Buffer<double> place_, matrix_;

 private:
  Buffer<double> change_;  // [2, n] J, and magnitudes
};

}  // namespace bb::resident
