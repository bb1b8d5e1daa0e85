// One step as the record keeps it, from what the step solver reports and the system holds at its end.
#pragma once

#include "core/newton/newton_system.hpp"
#include "core/newton/report.hpp"
#include "core/record/run_record.hpp"

namespace bb {

/// Everything but the smallest gaps over the accepted states, the audit's counts and the times, which only a
/// Recorder that saw the whole step knows. Cost: one pass over rows and elements.
StepRecord step_record(const NewtonSystem& system, const StepReport& report);

}  // namespace bb
