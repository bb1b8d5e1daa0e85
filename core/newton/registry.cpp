#include "core/math/error.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {

#define ENTRY(name, doc) std::unique_ptr<StepSolver> make_##name(const StepSolverOptions&);
#include "core/newton/registry.inc"
#undef ENTRY

const std::vector<StepSolverEntry>& step_solvers() {
  static const std::vector<StepSolverEntry> all = {
#define ENTRY(name, doc) {#name, doc, make_##name},
#include "core/newton/registry.inc"
#undef ENTRY
  };
  return all;
}

std::unique_ptr<StepSolver> make_step_solver(const StepSolverOptions& options) {
  std::string known;
  for (const StepSolverEntry& entry : step_solvers()) {
    if (entry.name == options.name) return entry.make(options);
    known += (known.empty() ? "" : ", ") + entry.name;
  }
  throw ConfigError("/step_solver/name", '"' + options.name + '"', "one of " + known);
}

}  // namespace bb
