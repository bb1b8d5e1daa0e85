// Elements of two numbers each: a stiffness, and what they are at rest.
#pragma once

#include "core/resident/elements/element_term.hpp"

namespace bb::resident {

template <class Elements>
class PairTerm final : public TermOf<Elements> {
 public:
  struct Names {
    const char *term, *vertices, *stiffness, *rest;  // the last three: of buffers
  };
  /// vertices: element-major. stiffness, rest: [n]; rest goes to that member.
  PairTerm(const ResidentInputs& inputs, const Names& names, std::span<const int> vertices,
           std::span<const double> stiffness, std::span<const double> rest, const double* Elements::*member)
      : TermOf<Elements>(inputs, names.term, vertices),
        vertex_(inputs.executor, names.vertices),
        stiffness_(inputs.executor, names.stiffness),
        rest_(inputs.executor, names.rest) {
    vertex_.upload(to_columns(vertices, Elements::width));
    stiffness_.upload(stiffness);
    rest_.upload(rest);
    Elements& elements = this->elements_;
    elements.of = vertex_.data();
    elements.n = stiffness_.size();
    elements.stiffness = stiffness_.data();
    elements.*member = rest_.data();
  }

 private:
  Buffer<int> vertex_;
  Buffer<double> stiffness_, rest_;
};

}  // namespace bb::resident
