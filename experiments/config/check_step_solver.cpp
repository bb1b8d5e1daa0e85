// What a step solver requires of the rest of a config.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "barriers/shapes/registry.hpp"
#include "core/model/integrators/registry.hpp"
#include "core/step_solvers/registry.hpp"
#include "core/terms/step_hessian.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/config/step_promise.hpp"

namespace bb {
namespace {

/// What a barrier is beyond contact: its own formula, which an unbounded shape does not have there, with a number for kappa.
void check_overlap(const RunConfig& config, const Complain& complain) {
  const FormulationConfig& contact = config.formulation;
  const std::optional<Shape> shape = find_shape(contact.shape);
  if (shape && shape->infinite_at_zero && !needs_of(config).multipliers) {
    complain("/formulation/shape", '"' + contact.shape + '"',
             "a shape that is finite at contact, as quadratic: the step solver " + config.step_solver.name +
                 " goes on beyond it");
  }
  if (contact.stiffness_policy.name != "fixed") {
    complain("/formulation/stiffness_policy/name", '"' + contact.stiffness_policy.name + '"',
             "fixed: the step solver is " + config.step_solver.name);
  }
}

/// A list of names.
std::string solvers_where(bool (*has)(const StepSolverEntry&)) {
  std::vector<std::string> names;
  for (const StepSolverEntry& entry : step_solvers()) {
    if (has(entry)) names.emplace_back(entry.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Settings that require a matrix at the end of a step, or for a minimum of E there.
void check_minimum(const RunConfig& config, const StepNeeds& needs, const Complain& complain) {
  const StepSolverConfig& solver = config.step_solver;
  if (solver.saddle == SaddleRule::report && !needs.matrix) {
    complain("/step_solver/saddle", "\"report\"",
             "ignore: the step solver " + solver.name + " has no matrix");
  }
  if (solver.saddle == SaddleRule::escape && !needs.minimum) {
    complain("/step_solver/saddle", "\"escape\"",
             "report or ignore: of step solvers only these can leave a saddle: " + solvers_with_minimum());
  }
}

/// Contact that stops what comes within one step.
void check_velocity(const RunConfig& config, const Complain& complain) {
  std::vector<std::string> right;
  for (const IntegratorEntry& entry : integrators()) {
    if (make_integrator(entry.name)->velocity_of_step()) right.push_back(entry.name);
  }
  const std::string& chosen = config.integrator.name;
  if (!integrators().find(chosen) || std::count(right.begin(), right.end(), chosen) > 0) return;
  complain("/integrator/name", '"' + chosen + '"',
           fmt::format("{}: the step solver {} stops what meets within one step, and {} takes that for an "
                       "acceleration that goes on",
                       fmt::join(right, ", "), config.step_solver.name, chosen));
}

/// A solver with a term of its own in the matrix requires one that is positive semi-definite without it.
void check_hessians(const RunConfig& config, const Complain& complain) {
  for (const HessianChoice& choice : hessian_choices()) {
    const std::string& value = text(config.hessian.parameters, choice.name);
    if (value == to_string(StepHessian::clamped)) continue;
    complain("/hessian/" + choice.name, '"' + value + '"',
             "clamped: the step solver is " + config.step_solver.name);
  }
}

/// What a step solver lets surfaces be in obstacles is less than the distance at which they are in contact.
void check_promise(const RunConfig& config, const Complain& complain) {
  const double promised = promised_overlap(config), d_hat = config.formulation.d_hat;
  if (promised <= d_hat) return;
  complain("/step_solver", fmt::format("tolerances that let surfaces be {:g} m in obstacles", promised),
           fmt::format("at most d_hat, {:g} m", d_hat));
}

void check_protocol(const RunConfig& config, const std::string& followed, const Complain& complain) {
  const std::string asked = solver_of_protocol(config.scene), &name = config.step_solver.name;
  if (asked == name || (asked.empty() && followed.empty())) return;
  complain("/step_solver/name", '"' + name + '"',
           !asked.empty()
               ? asked + ": it is the scene's protocol"
               : fmt::format("another step solver: {} needs a scene with protocol {}", name, followed));
}

StepSettings step_settings_of(const std::string& name) {
  const StepSolverEntry* entry = step_solvers().find(name);
  return entry ? entry->settings : StepSettings{};
}

}  // namespace

std::string solvers_with_minimum() {
  return solvers_where([](const StepSolverEntry& entry) { return entry.needs.minimum; });
}

std::string solvers_with_forces() {
  return solvers_where([](const StepSolverEntry& entry) { return entry.has_forces; });
}

StepNeeds needs_of(const RunConfig& config) {
  const StepSolverEntry* entry = step_solvers().find(config.step_solver.name);
  return entry ? entry->needs : StepNeeds{};
}

std::string solver_of_protocol(const SceneConfig& scene) {
  const auto protocol = scene.parameters.find("protocol");
  if (protocol == scene.parameters.end()) return "";
  for (const StepSolverEntry& entry : step_solvers()) {
    if (!entry.settings.protocol.empty() && protocol->second == ParameterValue(entry.settings.protocol))
      return entry.name;
  }
  return "";
}

void check_step_solver(const RunConfig& config, const Complain& complain) {
  const StepSolverConfig& solver = config.step_solver;
  const StepNeeds needs = needs_of(config);
  const bool unbound = !needs.step_bound, literal = unbound && !needs.overlap;
  const StepSettings settings = step_settings_of(solver.name);
  if (settings.implicit_euler && config.integrator.name != "implicit_euler") {
    complain("/integrator/name", '"' + config.integrator.name + '"',
             "implicit_euler: the step solver is " + solver.name);
  }
  if (settings.velocity_of_step) check_velocity(config, complain);
  if (unbound && config.formulation.argument != Argument::gap) {
    complain("/formulation/argument", "\"squared_gap\"", "gap: the step solver is " + solver.name);
  }
  if (literal && config.strain_limit.argument != Argument::gap) {
    complain("/strain_limit/argument", "\"squared_gap\"", "gap: the step solver is " + solver.name);
  }
  check_minimum(config, needs, complain);
  if (needs.overlap) check_overlap(config, complain);
  if (bounds_each_vertex(config.contact.step_bound.value_or(StepBoundRule::accd)) && !settings.vertex_steps) {
    complain(
        "/contact/step_bound", '"' + word_of(*config.contact.step_bound) + '"',
        fmt::format("accd, or step solver {}: {} takes one part of a step for all vertices",
                    solvers_where([](const StepSolverEntry& entry) { return entry.settings.vertex_steps; }),
                    solver.name));
  }
  if (settings.clamped) check_hessians(config, complain);
  check_protocol(config, settings.protocol, complain);
  if (step_solvers().find(solver.name)) check_promise(config, complain);
  if (const auto own = settings.contradiction
                           ? settings.contradiction(solver.parameters, solver.max_iterations)
                           : std::nullopt) {
    complain("/step_solver/" + own->where, own->found, own->allowed);
  }
}

}  // namespace bb
