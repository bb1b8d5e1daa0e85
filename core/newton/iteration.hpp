// What every step solver does in an iteration: assemble, measure, report.
#pragma once

#include <optional>
#include <string>

#include "core/newton/report.hpp"
#include "core/newton/step_solver.hpp"
#include "core/newton/step_system.hpp"

namespace bb {

/// For step solvers that know no devices. Errors: ConfigError, which names the solver.
void require_on_host(const StepSystem& system, std::string_view solver);
/// For step solvers that lead no vertex to a prescribed place: nothing prescribed may move, and no pin may begin to hold in the
/// run, when its vertex is elsewhere. Errors: ConfigError, which names the solver.
void require_unmoved(const Scene& scene, std::string_view solver);
/// Errors: ConfigError for stitches that break, of a step solver that has no tension of them.
void require_unbreakable(const Scene& scene, std::string_view solver);
/// Predicts and hands the step to the system, with the poses at its end as the target. The report has iteration_cap
/// until something better is known.
StepReport start_step(StepSystem& system, const StepTask& task, Prediction& used);
/// The end-of-step poses of a step of length dt become the target of the system.
void aim_at_poses(StepSystem& system, const StepTask& task, double dt);
/// Below which a change of E is noise, J: 64 eps sum |terms|, eps of the precision that energies have.
double rounding_of(const EnergyChange& change, Precision precision = Precision::full);
bool within_rounding(const EnergyChange& change, Precision precision = Precision::full);
/// Ends a step whose direction was of no use.
void fail_step(const StepSystem& system, StepReport& step, StepStatus status, const IterationReport& report);

/// Begins a lap of the system's clock and assembles at system.x(). What is reported of the iterate comes with its direction.
IterationReport begin_iteration(StepSystem& system, int step, int iteration);
/// Solves for the direction, fills |dx|_inf, the decrement -g . dx / 2 over free degrees of freedom, and E, gradient, pattern
/// and the terms' numbers of the iterate (one wait for all of them), and lets the observer look at the matrices.
void find_direction(StepSystem& system, IterationReport& report, StepObserver& observer);
/// What find_direction() does after the solve, of a direction that was found otherwise.
void report_direction(StepSystem& system, IterationReport& report, StepObserver& observer);
/// The status that ends the step when the direction is of no use. must_descend: E has to decrease along it.
std::optional<StepStatus> direction_failure(const IterationReport& report, bool must_descend);
/// Tests whether the iterate of the system is a minimum as far as second derivatives go, unless the rule is ignore, and
/// counts what that cost.
EndCheck check_end(StepSystem& system, SaddleRule rule, StepReport& step, IterationReport& report);
/// The step is over as it should be: what its end is known to be, and how far it is from the solution, m. asked: the
/// tolerance of a step solver that has to converge, m.
void end_converged(StepReport& step, const EndCheck& end, const Number& error, double asked);
/// Ends the lap of the clock, adds an iteration to its step and notifies the observer.
void finish_iteration(StepSystem& system, StepReport& step, IterationReport& report, StepObserver& observer);

/// Notifies the observer of the motion that was accepted.
void show_motion(const StepSystem& system, int step, StepObserver& observer);
/// What held the bound of the step taken last.
std::string describe_bound(const StepSystem& system);
std::string describe_short_pin(const StepSystem& system, const StepTask& task);

/// Fills the part of a step report that is of its end state.
void measure_end(StepSystem& system, StepReport& step);

}  // namespace bb
