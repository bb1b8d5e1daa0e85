// The strain limit on an executor, one term of triangles and one of tetrahedra.
#include "core/barrier/launches.hpp"
#include "core/math/error.hpp"
#include "core/terms/executor/element_term.hpp"
#include "core/terms/executor/element_terms.hpp"
#include "core/terms/executor/limit_forms.hpp"
#include "core/terms/limit_steps.hpp"

namespace bb::exec {
namespace {

class LimitTerm final : public LimitSteps<ElementTerm> {
 public:
  LimitTerm(const ExecutorInputs& inputs, std::unique_ptr<StrainLimitState> state)
      : LimitTerm(inputs, state->family(), std::move(state)) {}

  void linearise(const PositionsView& x, const ExecutorContext& context, PositionsSpan g) override {
    state_->refresh(x.data(), {context.elastic}, energies());
    ElementTerm::linearise(x, context, g);
  }
  void add_matrix(const PositionsView& x, const HessianRequest& request) override {
    state_->measure_iterate(x.data(), energies());
    ElementTerm::add_matrix(x, request);
  }

 protected:
  void gradients(Piece piece, const double* x, double* energy, double* grad) override {
    state_->family().gradients(piece, x, energy, grad);
  }
  void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) override {
    state_->family().hessians(piece, request, x, hess);
  }

 private:
  LimitTerm(const ExecutorInputs& inputs, const LimitFamily& family,
            std::unique_ptr<StrainLimitState>&& state)
      : LimitSteps(std::move(state), inputs, family.width(), family.vertices()) {}
};

}  // namespace

void require_limit_kernels(const TermOptions& options) {
  if (!options.limit.shape.launches) {
    throw ConfigError("shape", options.limit.shape.name,
                      "a shape of barriers/shapes: a plugin's and another exponent have no kernel");
  }
  for (const auto* policy : {&options.limit_stiffness, &options.solid_limit_stiffness}) {
    if (!*policy || ((*policy)->launches() && (*policy)->launches()->triangles)) continue;
    throw ConfigError("stiffness_policy/name", std::string((*policy)->name()), host_policy_words);
  }
}

void make_strain_limit_on_executor(const ExecutorInputs& inputs, ExecutorTerms& terms) {
  require_limit_kernels(inputs.options);
  const auto add = [&](bool of_solids) {
    terms.add(std::make_unique<LimitTerm>(
        inputs, std::make_unique<StrainLimitState>(inputs.executor, inputs.scene, inputs.options, of_solids,
                                                   inputs.mass.data())));
  };
  if (!inputs.scene.limit.triangles.empty()) add(false);
  if (!inputs.scene.solid_limit.tetrahedra.empty()) add(true);
}

}  // namespace bb::exec
