// A term of elements that stay: one family (core/energy/families) in the executor's memory.
#pragma once

#include "core/bodies/part.hpp"
#include "core/energy/families/element_family.hpp"
#include "core/resident/elements/element_term.hpp"

namespace bb::resident {

class FamilyTerm final : public ElementTerm {
 public:
  /// name: that of registry.inc. group: load or elastic.
  FamilyTerm(const ResidentInputs& inputs, std::string_view name, TermGroup group,
             std::unique_ptr<ElementFamily> family);
  void begin_step(const ResidentFrame& frame) override;
  void change_frame(const ResidentFrame& frame) override;
  void end_step(const Column& x, PhaseClock& clock) override;
  void keep(Archive& archive) override;
  void add_change(const Column& x, const Column& trial, ResidentChange& out) override;

 protected:
  void values(const double* x, double* energy) override { family_->values(x, energy); }
  void gradients(Piece piece, const double* x, double* energy, double* grad) override {
    family_->gradients(piece, x, energy, grad);
  }
  void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) override {
    family_->hessians(piece, request, x, hess);
  }

 private:
  std::unique_ptr<ElementFamily> family_;
  Buffer<double> change_;  // [2, n] J, and magnitudes; empty: energies are compared
  double dt_ = 0;          // s, of the step
};

/// One term a family of the part.
void make_resident_part(const Part& part, const ResidentInputs& inputs, ResidentTermList& terms);
template <const Part& (*part)()>
void make_resident_part(const ResidentInputs& inputs, ResidentTermList& terms) {
  make_resident_part(part(), inputs, terms);
}

}  // namespace bb::resident
