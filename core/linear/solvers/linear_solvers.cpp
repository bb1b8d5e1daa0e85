#include "core/linear/solvers/linear_solvers.hpp"

#include <stdexcept>

namespace bb {

#define ENTRY(name, doc) LinearSolverEntry linear_solver_##name();
#include "core/linear/solvers/registry.inc"
#undef ENTRY

const Registry<LinearSolverEntry>& linear_solvers() {
#define ENTRY(name, doc) named(linear_solver_##name(), #name, doc),
  static const Registry<LinearSolverEntry> all({
#include "core/linear/solvers/registry.inc"
  });
#undef ENTRY
  return all;
}

const LinearSolverEntry& linear_solver_at(MatrixPlace place) {
  for (const LinearSolverEntry& entry : linear_solvers()) {
    if (entry.matrix == place) return entry;
  }
  throw std::logic_error("no linear solver wants the matrix there");
}

std::unique_ptr<LinearSolver> make_linear_solver(const LinearOptions& options) {
  const LinearSolverEntry& entry = linear_solvers().require(options.name, "/linear_solver/name");
  ParameterMap complete = own_parameters(entry.parameters, options.parameters, "/linear_solver");
  require_usable(options.name);
  // The preconditioner reads its own of the rest.
  for (const auto& given : options.parameters) complete.insert(given);
  return entry.make(complete);
}

std::vector<std::string> linear_solver_choices() {
  std::vector<std::string> names = linear_solvers().names();
  names.emplace_back(linear_solver_auto);
  return names;
}

const Parameter* preconditioner_parameter(const LinearSolverEntry& entry) {
  for (const Parameter& one : entry.parameters) {
    if (one.name.ends_with("preconditioner")) return &one;
  }
  return nullptr;
}

std::vector<std::string> preconditioner_choices(const LinearSolverEntry& entry) {
  const Parameter* const named = preconditioner_parameter(entry);
  return named ? named->rule.words() : std::vector<std::string>{"none"};
}

void set_preconditioner(const LinearSolverEntry& entry, const std::string& choice, ParameterMap& parameters) {
  if (const Parameter* const named = preconditioner_parameter(entry)) parameters[named->name] = choice;
}

std::string preconditioner_of(const LinearOptions& options) {
  const LinearSolverEntry& entry = linear_solvers().require(options.name, "/linear_solver/name");
  const Parameter* const named = preconditioner_parameter(entry);
  if (!named) return "none";
  return text(own_parameters(entry.parameters, options.parameters, "/linear_solver"), named->name);
}

std::string missing_for(std::string_view solver) {
  const LinearSolverEntry* entry = find_named(linear_solvers(), solver);
  return entry && entry->missing ? entry->missing() : "";
}

void require_usable(const std::string& solver) {
  const std::string missing = missing_for(solver);
  if (!missing.empty()) {
    throw ConfigError("/linear_solver/name", '"' + solver + '"', "another solver: " + missing);
  }
}

}  // namespace bb
