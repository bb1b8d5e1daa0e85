#include "core/step_solvers/registry.hpp"

#include <stdexcept>

#include "core/base/parameters/check.hpp"

namespace bb {

#define ENTRY(name, doc) StepSolverEntry step_solver_##name();
#include "core/step_solvers/registry.inc"
#undef ENTRY

Registry<StepSolverEntry>& step_solvers() {
#define ENTRY(name, doc) named(step_solver_##name(), #name, doc),
  static Registry<StepSolverEntry> all({
#include "core/step_solvers/registry.inc"
  });
#undef ENTRY
  return all;
}

std::vector<SolverCounter> step_solver_counters() {
  std::vector<SolverCounter> out;
  for (const StepSolverEntry& entry : step_solvers()) {
    for (const SolverCounter& counter : entry.counters) {
      if (find_named(out, counter.name)) {
        throw std::logic_error("two step solvers declare the counter " + counter.name);
      }
      out.push_back(counter);
    }
  }
  return out;
}

namespace {

StepSolverOptions completed(const StepSolverEntry& entry, const StepSolverOptions& options) {
  StepSolverOptions complete = options;
  complete.parameters = to_map(entry.parameters, to_json(options.parameters));
  return complete;
}

}  // namespace

void choose_step_solver(Method& method, std::string_view name) {
  method.step_needs = step_solvers().require(std::string(name), "/step_solver/name").needs;
  method.step_solver.name = name;
}

void fit_terms(Method& method) {
  const StepSolverEntry& entry = step_solvers().require(method.step_solver.name, "/step_solver/name");
  method.step_needs = entry.needs;
  method.contact.literal = method.limit.literal = !entry.needs.step_bound && !entry.needs.overlap;
  method.overlap = entry.needs.overlap;
  if (entry.set_terms) entry.set_terms(completed(entry, method.step_solver), method);
}

bool bounds_motions(const StepSolverOptions& options) {
  const StepSolverEntry& entry = step_solvers().require(options.name, "/step_solver/name");
  if (!entry.needs.step_bound || !entry.settings.unbounded) return entry.needs.step_bound;
  return !entry.settings.unbounded(completed(entry, options).parameters);
}

std::unique_ptr<StepSolver> make_step_solver(const StepSolverOptions& options) {
  const StepSolverEntry& entry = step_solvers().require(options.name, "/step_solver/name");
  return entry.make(completed(entry, options));
}

}  // namespace bb
