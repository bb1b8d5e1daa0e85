#include "experiments/run/calibration_replay.hpp"

#include "core/base/archive/archive.hpp"

namespace bb {

void CalibrationReplay::hold_pins(int step) {
  if (!held_.changes()) return;
  std::vector<int> holding = holding_pins(scene_, (step + 0.5) * calibration_run_.config.time.dt);
  if (holding == held_.holding()) return;
  system_.reset();
  held_.hold(std::move(holding));
  system_ = std::make_unique<NewtonSystem>(held_.now(), method_);
}

void CalibrationReplay::begin(const Positions& x, int step) {
  hold_pins(step);
  prediction_.c = c(step);
  prediction_.x_tilde = x;
  prediction_.t_end = (step + 1) * calibration_run_.config.time.dt;
  if (!calibration_run_.memory.empty()) {
    Archive memory(calibration_run_.memory[static_cast<std::size_t>(step)]);
    system_->keep(memory);
  }
  system_->begin_step(x, prediction_, calibration_run_.config.time.dt, method_.integrator->weight_factor());
}

void CalibrationReplay::find_rows(int step, Refresh refresh) {
  begin(refresh == Refresh::per_step ? start(step) : end(step), step);
  system_->assemble();
  elastic_ = diagnosis().clamped_values(TermGroup::elastic);
  if (refresh != Refresh::per_step) return;
  system_->go_to(end(step));
}

Diagnosis& CalibrationReplay::assembled(int step) {
  begin(end(step), step);
  system_->assemble();
  return diagnosis();
}

}  // namespace bb
