// Energies of the state that a step ended with.
#pragma once

#include "core/base/record/step_record.hpp"
#include "core/newton/newton_system.hpp"

namespace bb {

/// elastic_J, limit_J, contact_J and gravity_J of the state that `system` holds. Cost: one pass over
/// rows and elements.
void fill_energies(const StepSystem& system, StepRecord& step);

}  // namespace bb
