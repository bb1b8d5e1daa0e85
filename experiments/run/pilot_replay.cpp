#include "experiments/run/pilot_replay.hpp"

#include "core/base/archive/archive.hpp"

namespace bb {

void PilotReplay::hold_pins(int step) {
  if (!held_.changes()) return;
  std::vector<int> holding = holding_pins(scene_, (step + 0.5) * pilot_.config.time.dt);
  if (holding == held_.holding()) return;
  system_.reset();
  held_.hold(std::move(holding));
  system_ = std::make_unique<NewtonSystem>(held_.now(), method_);
}

void PilotReplay::begin(const Positions& x, int step) {
  hold_pins(step);
  prediction_.c = c(step);
  prediction_.x_tilde = x;
  prediction_.t_end = (step + 1) * pilot_.config.time.dt;
  if (!pilot_.memory.empty()) {
    Archive memory(pilot_.memory[static_cast<std::size_t>(step)]);
    system_->keep(memory);
  }
  system_->begin_step(x, prediction_, pilot_.config.time.dt, method_.integrator->weight_factor());
}

void PilotReplay::find_rows(int step, Refresh refresh) {
  begin(refresh == Refresh::per_step ? start(step) : end(step), step);
  system_->assemble();
  elastic_ = diagnosis().clamped_values(TermGroup::elastic);
  if (refresh != Refresh::per_step) return;
  system_->go_to(end(step));
}

Diagnosis& PilotReplay::assembled(int step) {
  begin(end(step), step);
  system_->assemble();
  return diagnosis();
}

}  // namespace bb
