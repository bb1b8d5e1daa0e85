// What every step solver does in an iteration: assemble, measure, report.
#pragma once

#include <optional>
#include <string>

#include "core/newton/newton_system.hpp"
#include "core/newton/report.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {

/// Predicts, hands the step to the system and fills `target` with the end-of-step pose of every vertex. The
/// report says iteration_cap until something better is known.
StepReport start_step(NewtonSystem& system, const StepTask& task, Prediction& used, Positions& target);
/// Whether a change of E is noise: below 64 eps sum |terms|, eps of the precision that energies have.
bool within_rounding(const EnergyChange& change, Precision precision = Precision::full);
/// Ends a step whose direction was of no use.
/// dx: the direction.
void fail_step(const NewtonSystem& system, const Positions& dx, StepReport& step, StepStatus status,
               const IterationReport& report);

/// Begins a lap of the system's clock, assembles at system.x() and fills what is known before the solve.
IterationReport begin_iteration(NewtonSystem& system, int step, int iteration);
/// Solves for dx, fills |dx|_inf and the decrement -g . dx / 2 over free degrees of freedom, and lets the
/// observer look at the matrices.
void find_direction(NewtonSystem& system, const Positions& target, Positions& dx, IterationReport& report,
                    StepObserver& observer);
/// The status that ends the step when the direction is of no use. must_descend: E has to decrease along it.
std::optional<StepStatus> direction_failure(const IterationReport& report, bool must_descend);
/// Ends the lap of the clock, adds an iteration to its step and tells the observer.
void finish_iteration(NewtonSystem& system, StepReport& step, IterationReport& report,
                      StepObserver& observer);

bool poses_reached(const NewtonSystem& system, const Positions& target);
/// What held the bound of the step taken last.
std::string describe_bound(const NewtonSystem& system);
std::string describe_short_pin(const NewtonSystem& system, const Positions& target);

/// Fills what a step report says of its end state.
void measure_end(NewtonSystem& system, StepReport& step);

}  // namespace bb
