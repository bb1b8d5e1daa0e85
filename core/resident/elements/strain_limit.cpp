// The strain limit on an executor, one term of triangles and one of tetrahedra.
#include "core/terms/strain_limit_state.hpp"

#include "core/barrier/launches.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/limit_forms.hpp"

namespace bb::resident {
namespace {

class LimitTerm final : public ElementTerm {
 public:
  /// state: of the same inputs.
  LimitTerm(const ResidentInputs& inputs, std::unique_ptr<StrainLimitState> state)
      : ElementTerm(inputs, "strain_limit", TermGroup::limit, Phase::strain_limit, state->family().width(),
                    state->family().vertices()),
        state_(std::move(state)) {}

  void begin_step(const ResidentFrame& frame) override {
    state_->begin_step(frame.x_n->data(), {frame.dt, frame.c});
  }
  void change_frame(const ResidentFrame& frame) override { state_->set_time({frame.dt, frame.c}); }

  void linearise(const Column& x, const ResidentContext& context, Column& g) override {
    state_->refresh(x.data(), {context.elastic}, energies());
    ElementTerm::linearise(x, context, g);
  }
  void add_matrix(const Column& x, const HessianRequest& request) override {
    state_->measure_iterate(x.data(), energies());
    ElementTerm::add_matrix(x, request);
  }

  void look_along(const ResidentMotion& motion, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::strain_bound);
    state_->look_along(motion.x0.data(), motion.dx.data());
  }
  double bound(const ResidentMotion&, IterateNumbers& out, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::strain_bound);
    return state_->bound(out);
  }
  std::string describe_bound() const override { return std::string(state_->describe_bound()); }
  void look_at(const Column&, const Column& trial, PhaseClock&) override {
    state_->look_at(trial.data(), trial_energies());
  }
  bool admits(const Column&, const Column&, PhaseClock&) override { return state_->admits(); }
  void evaluate(const Column& trial) override { state_->evaluate(trial.data(), trial_energies()); }
  void evaluate_iterate(const Column& x) override {
    state_->measure_iterate(x.data(), energies());
    ElementTerm::evaluate_iterate(x);
  }
  void accept() override { state_->accept(); }

  void announce(const Column& x) override { state_->announce(x.data(), energies()); }
  void report(const Column& x, IterateNumbers& out, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::strain_limit);
    state_->report(x.data(), energies(), out);
  }
  void report_end(const Column& x, StepNumbers& out) override {
    state_->report_end(x.data(), energies(), out);
  }

 protected:
  void values(const double* x, double* energy) override { state_->family().values(x, energy); }
  void gradients(Piece piece, const double* x, double* energy, double* grad) override {
    state_->family().gradients(piece, x, energy, grad);
  }
  void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) override {
    state_->family().hessians(piece, request, x, hess);
  }

 private:
  std::unique_ptr<StrainLimitState> state_;
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

void make_resident_strain_limit(const ResidentInputs& inputs, ResidentTermList& terms) {
  require_limit_kernels(inputs.options);
  const auto add = [&](bool of_solids) {
    terms.add(std::make_unique<LimitTerm>(
        inputs, std::make_unique<StrainLimitState>(inputs.executor, inputs.scene, inputs.options, of_solids,
                                                   inputs.mass.data())));
  };
  if (!inputs.scene.limit.triangles.empty()) add(false);
  if (!inputs.scene.solid_limit.tetrahedra.empty()) add(true);
}

}  // namespace bb::resident
