// What a term of the strain limit does in a step, whichever matrix engine reads it.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/terms/strain_limit_state.hpp"
#include "core/terms/term.hpp"

namespace bb {

/// Base: a term of a matrix engine with energies() and trial_energies(), which point to as many numbers (J) as there are limited elements.
template <class Base>
class LimitSteps : public Base {
 public:
  std::string_view name() const override { return "strain_limit"; }
  TermGroup group() const override { return TermGroup::limit; }
  Phase phase() const override { return Phase::strain_limit; }

  void begin_step(const StepColumns& step, PhaseClock&) override {
    state_->begin_step(step.x_n.data(), {step.dt, step.c});
  }
  void change_step(const StepColumns& step) override { state_->set_time({step.dt, step.c}); }

  void look_along(const Motion& motion, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::strain_bound);
    state_->look_along(motion.x0.data(), motion.dx.data());
  }
  double bound(const Motion&, IterateNumbers& out, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::strain_bound);
    return state_->bound(out);
  }
  std::string describe_bound() const override { return std::string(state_->describe_bound()); }

  void look_at(const PositionsView&, const PositionsView& trial, PhaseClock&) override {
    state_->look_at(trial.data(), this->trial_energies());
  }
  bool is_feasible(const PositionsView&, PhaseClock&) override { return state_->is_feasible(); }
  void evaluate(const PositionsView& trial) override {
    state_->evaluate(trial.data(), this->trial_energies());
  }
  void evaluate_iterate(const PositionsView& x) override {
    state_->measure_iterate(x.data(), this->energies());
    state_->family().values(x.data(), this->energies());
  }
  void accept(PhaseClock&) override { state_->accept(); }

  void announce(const PositionsView& x) override { state_->announce(x.data(), this->energies()); }
  void report(const PositionsView& x, IterateNumbers& out, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::strain_limit);
    state_->report(x.data(), this->energies(), out);
  }
  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::strain_limit);
    state_->report_end(x.data(), this->energies(), out);
  }

 protected:
  template <class... OfBase>
  explicit LimitSteps(std::unique_ptr<StrainLimitState> state, OfBase&&... of_base)
      : Base(std::forward<OfBase>(of_base)...), state_(std::move(state)) {}

  std::unique_ptr<StrainLimitState> state_;
};

}  // namespace bb
