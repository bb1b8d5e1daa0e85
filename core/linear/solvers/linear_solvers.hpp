// The linear solvers by name: one line of registry.inc and one file NAME.cpp with linear_solver_NAME each.
#pragma once

#include "core/linear/linear_solver.hpp"

namespace bb {

/// Where a solver wants the matrix.
enum class MatrixPlace {
  host,      // in this machine's memory, reduced to what is free, by columns
  executor,  // where an executor assembles it, as block rows
  card       // reduced and by columns in the memory of a card: it goes up for every solve
};

struct LinearSolverEntry {
  std::string name, doc;
  std::vector<Parameter> parameters;  // its own, with defaults
  bool iterative = false;
  MatrixPlace matrix = MatrixPlace::host;
  /// What this build or this machine lacks to run it, and what to do; empty: nothing. Null: it runs everywhere.
  std::string (*missing)() = nullptr;
  /// Called where nothing is missing. A solver whose matrix is an executor's gets that of the host here, and copies it.
  std::unique_ptr<LinearSolver> (*make)(const ParameterMap& complete) = nullptr;
};
/// The registry, in its order.
const Registry<LinearSolverEntry>& linear_solvers();
/// The first solver of the registry that wants the matrix there.
const LinearSolverEntry& linear_solver_at(MatrixPlace place);

/// Errors: ConfigError for an unknown name, for what own_parameters refuses, and as require_usable.
std::unique_ptr<LinearSolver> make_linear_solver(const LinearOptions& options);

/// In the place of a solver's name: the number of unknowns chooses it (experiments/run/linear_choice.hpp).
inline constexpr std::string_view linear_solver_auto = "auto";
/// The names of the registry, and linear_solver_auto.
std::vector<std::string> linear_solver_choices();

/// The parameter that names the preconditioner of a solver; null: it has none.
const Parameter* preconditioner_parameter(const LinearSolverEntry& entry);
/// What it may name; "none" alone for a solver that has no such parameter.
std::vector<std::string> preconditioner_choices(const LinearSolverEntry& entry);
/// Puts one of these into parameters of the solver; nothing for a solver that has no such parameter.
void set_preconditioner(const LinearSolverEntry& entry, const std::string& choice, ParameterMap& parameters);
/// The preconditioner of a solver that has one, "none" for the others.
std::string preconditioner_of(const LinearOptions& options);

/// What this build or this machine lacks to run a linear solver; empty for those that run everywhere, and for unknown
/// names. Cost: with cudss a library is loaded and a kernel is run.
std::string missing_for(std::string_view solver);
/// Errors: ConfigError at /linear_solver/name with what is missing.
void require_usable(const std::string& solver);

}  // namespace bb
