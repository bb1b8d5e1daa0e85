#include "core/newton/end_residual.hpp"

#include "core/base/archive/archive.hpp"

namespace bb {

Number EndResidual::measure(StepSystem& system, const StepFrame& frame) {
  const WholePhase timer(system.clock(), Phase::output);
  NewtonSystem* seen = &system.on_host();
  if (system.is_on_host()) {
    if (!own_) own_ = std::make_unique<NewtonSystem>(scene_, method_, plan_);
    own_->drop_caches();  // a factor of the step before would make another direction of a run that is resumed
    Archive memory;       // of the terms, from step to step
    seen->keep(memory);
    Archive again(memory.bytes());
    own_->keep(again);
    own_->adopt(frame, *seen);
    seen = own_.get();
  }
  seen->set_target(seen->view().x());
  const LinearStatus status = seen->find_direction().linear.status;
  return status == LinearStatus::ok ? Number(seen->direction_size().inf_m) : Number::missing("not_estimated");
}

}  // namespace bb
