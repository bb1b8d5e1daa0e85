// The step solvers of registry.inc by name.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "core/newton/step_solver.hpp"

namespace bb {

/// Those of registry.inc, then what Python added before the first run that names it (python/src/python_step_solver.cpp).
Registry<StepSolverEntry>& step_solvers();
/// Those of all of them, in the order of registry.inc. Errors: std::logic_error for a name that two declare.
std::vector<SolverCounter> step_solver_counters();
/// Makes the terms those that the method's step solver needs, how barriers are read beyond contact and multipliers, and says what
/// it needs. Errors: ConfigError for an unknown name.
void fit_terms(Method& method);
/// Names the method's step solver and says what it needs; its settings and the terms stay. Errors: ConfigError for an unknown name.
void choose_step_solver(Method& method, std::string_view name);
/// Whether no motion of an iteration goes beyond the step bound. Errors: ConfigError for an unknown name.
bool bounds_motions(const StepSolverOptions& options);
/// Errors: ConfigError for an unknown name. Ranges are checked where a config is read.
std::unique_ptr<StepSolver> make_step_solver(const StepSolverOptions& options);

}  // namespace bb
