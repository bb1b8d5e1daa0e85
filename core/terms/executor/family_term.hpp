// A term of elements that stay: one family (core/energy/families) in the executor's memory.
#pragma once

#include "core/model/bodies/part.hpp"
#include "core/terms/executor/element_term.hpp"
#include "core/terms/family_steps.hpp"

namespace bb::exec {

class FamilyTerm final : public FamilySteps<ElementTerm> {
 public:
  /// name: that of registry.inc. group: load or elastic.
  FamilyTerm(const ExecutorInputs& inputs, std::string_view name, TermGroup group,
             std::unique_ptr<ElementFamily> family)
      : FamilyTerm(inputs, name, group, *family, std::move(family)) {}
  void add_change(const PositionsView& x, const PositionsView& trial, ExecutorChange& out) override;

 protected:
  void gradients(Piece piece, const double* x, double* energy, double* grad) override {
    family_->gradients(piece, x, energy, grad);
  }
  void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) override {
    family_->hessians(piece, request, x, hess);
  }

 private:
  FamilyTerm(const ExecutorInputs& inputs, std::string_view name, TermGroup group,
             const ElementFamily& elements, std::unique_ptr<ElementFamily>&& family);

  Buffer<double> change_;  // [2, n] J, and magnitudes; empty: energies are compared
};

/// One term a family of the part.
void make_part_on_executor(const Part& part, const ExecutorInputs& inputs, ExecutorTerms& terms);
template <const Part& (*part)()>
void make_part_on_executor(const ExecutorInputs& inputs, ExecutorTerms& terms) {
  make_part_on_executor(part(), inputs, terms);
}

}  // namespace bb::exec
