#include "core/terms/plan.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "core/linear/solvers/linear_solvers.hpp"

namespace bb {
namespace {

constexpr const char* no_matrix = "the step solver has no matrix";

std::string reason_of_bound(const Scene& scene, StepBoundRule rule) {
  std::string out = scene.collisions.chosen()
                        ? "every step of pairs that collide as ccd stays free of contact"
                        : "every step stays free of contact";
  if (rule != StepBoundRule::accd) out += ", by " + std::string(to_string(rule));
  return out;
}

void plan_steps(Plan& plan, const Scene& scene, const TermOptions& terms, const PlanOptions& options) {
  const bool contact = plan.term("contact").needed;
  plan.step_bound =
      plan_item(contact && options.step.step_bound, reason_of_bound(scene, terms.contact_options.step_bound),
                contact ? "the step solver has no step bound" : "nothing can touch");
  plan.trial_energies = plan_item(options.step.energies, "the step solver compares E at trials",
                                  "feasibility alone judges the trials of the step solver");
  plan.end_check = plan_item(options.end_check, "step_solver.saddle", "step_solver.saddle is ignore");
  const bool contact_reads = contact && terms.stiffness && terms.stiffness->needs_hessian();
  const auto reads = [](const std::unique_ptr<StiffnessPolicy>& policy) {
    return policy && policy->needs_hessian();
  };
  const bool limit_reads = plan.term("strain_limit").needed &&
                           (reads(terms.limit_stiffness) || reads(terms.solid_limit_stiffness));
  plan.policy_submatrix = plan_item(
      options.step.matrix && (contact_reads || limit_reads), "a stiffness policy reads the elastic matrix",
      options.step.matrix ? "no stiffness policy of a term in use reads it" : no_matrix);
  bool moving = false;
  for (const Pin& pin : scene.pins) {
    moving = moving || !scene.motions[static_cast<std::size_t>(pin.motion)].is_static();
  }
  plan.pins = plan_item(!scene.pins.empty(), fmt::format("{} prescribed vertices", scene.pins.size()),
                        "no prescribed vertex");
  plan.pin_lifting = plan_item(moving, "prescribed vertices move", "no prescribed vertex moves");
  plan.planar_lock = plan_item(scene.planar, "the scene is planar", "the scene is not planar");
}

PlanItem plan_float(Precision precision) {
  constexpr const char* stored =
      "; stored and solved in double, so that times are no times of a float program";
  const bool single = values_in_float(precision);
  return plan_item(precision != Precision::full,
                   (single ? "states, gaps, energies, gradients, Hessians, step bounds"
                           : "Hessians of elements and contacts") +
                       std::string(stored),
                   "precision is double");
}

void plan_passes(Plan& plan, const PlanOptions& options) {
  plan.linear = options.linear;
  const bool solves = options.step.matrix;
  plan.linear_solver = plan_item(solves, plan.linear.name + ", " + options.linear_reason, no_matrix);
  plan.preconditioner = plan_item(solves && preconditioner_of(plan.linear) != "none",
                                  preconditioner_of(plan.linear) + ", of the linear solver",
                                  solves ? "the linear solver has none" : no_matrix);
  plan.conditioning =
      plan_item(solves && options.diagnose, "passes.diagnose", solves ? "passes.diagnose is off" : no_matrix);
  plan.audit = plan_item(options.audit, "passes.audit", "passes.audit is off");
  plan.trace =
      plan_item(options.trace, "a run is observed",
                "only the pass time: passes.diagnose, passes.audit or output.frames_every leave one");
  plan.frames = plan_item(options.frames, "output.frames_every", "output.frames_every is 0");
  plan.matrices =
      plan_item(solves && options.matrices, "output.matrices", solves ? "output.matrices is off" : no_matrix);
}

}  // namespace

const PlanItem& Plan::term(std::string_view name) const {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (term_entries()[i].name == name) return terms[i];
  }
  throw std::logic_error("the plan has no term " + std::string(name));
}

std::vector<std::pair<std::string_view, const PlanItem*>> Plan::items() const {
  std::vector<std::pair<std::string_view, const PlanItem*>> out;
  for (std::size_t i = 0; i < terms.size(); ++i) out.emplace_back(term_entries()[i].name, &terms[i]);
  out.insert(out.end(), {{"self_contact", &contacts.self_contact},
                         {"given_surfaces", &contacts.given_surfaces},
                         {"obstacles", &contacts.obstacles},
                         {"collisions", &contacts.collisions},
                         {"broad_phase", &contacts.broad_phase},
                         {"step_bound", &step_bound},
                         {"trial_energies", &trial_energies},
                         {"end_check", &end_check},
                         {"mollifier", &contacts.mollifier},
                         {"policy_submatrix", &policy_submatrix},
                         {"pins", &pins},
                         {"pin_lifting", &pin_lifting},
                         {"planar_lock", &planar_lock},
                         {"float_arithmetic", &float_arithmetic},
                         {"linear_solver", &linear_solver},
                         {"preconditioner", &preconditioner},
                         {"conditioning", &conditioning},
                         {"audit", &audit},
                         {"trace", &trace},
                         {"frames", &frames},
                         {"matrices", &matrices}});
  return out;
}

Plan make_plan(const Scene& scene, const TermOptions& terms, const PlanOptions& options) {
  Plan plan;
  plan.contacts = plan_contact(scene, terms.contact_options);
  for (const TermEntry& entry : term_entries()) {
    plan.terms.push_back(entry.needs({scene, terms, plan.contacts}));
  }
  plan_steps(plan, scene, terms, options);
  plan.float_arithmetic = plan_float(terms.precision);
  plan_passes(plan, options);
  return plan;
}

TermList make_terms(const Plan& plan, const TermInputs& inputs) {
  TermList terms;
  for (std::size_t i = 0; i < plan.terms.size(); ++i) {
    if (plan.terms[i].needed) term_entries()[i].make(inputs, terms);
  }
  return terms;
}

}  // namespace bb
