// Settings that contradict each other across sections.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>

#include "barriers/shapes/registry.hpp"
#include "core/barrier/folded_barrier.hpp"
#include "core/barrier/gap_potential.hpp"
#include "core/model/integrators/registry.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/methods.hpp"
#include "experiments/config/policy_request.hpp"
#include "experiments/config/reader.hpp"

namespace bb {
namespace {

/// A registered name may carry an exponent that its shape does not allow; an unknown name has a violation already.
void check_exponent(const std::string& section, const std::string& shape, const Complain& complain) {
  if (shape.find(':') == std::string::npos) return;
  try {
    require_shape(shape);
  } catch (const ConfigError& error) {
    const Violation& v = error.violations().front();
    complain(section + "/shape", v.found, v.allowed);
  }
}

/// Steps that read the positions before the last carry the velocity on that was taken off.
void check_damping(const RunConfig& config, const Complain& complain) {
  const IntegratorConfig& chosen = config.integrator;
  if (!config.scene.damping.acts() || !integrators().find(chosen.name)) return;
  if (make_integrator(chosen.name, chosen.parameters)->one_step()) return;
  complain("/integrator/name", '"' + chosen.name + '"',
           "one whose steps read the last state alone: /scene/velocity_damping changes its velocities");
}

/// A policy judges its own settings; what matching will supply is 1 here.
void check_policy(const std::string& section, const PolicyConfig& policy, PolicyUse use,
                  const std::optional<double>& given, const Complain& complain) {
  try {
    make_policy(policy_request(policy, use, given.value_or(1)), use);
  } catch (const ConfigError& error) {
    for (const Violation& v : error.violations()) complain(section + "/" + v.where, v.found, v.allowed);
  }
}

/// kappa as any function of the gap, for pairs of some masses and stiffnesses: what of it is unknown before a run is not
/// checked here.
void check_gap_potential(const std::string& section, const std::string& shape, Argument argument,
                         const PolicyConfig& policy, const RunConfig& config, const Complain& complain) {
  const auto barrier = barrier_of(shape, argument);
  const auto potential = policy.parameters.find("potential");
  if (!barrier || potential == policy.parameters.end() ||
      potential->second != ParameterValue(std::string("derived"))) {
    return;
  }
  const std::string pointer = section + "/stiffness_policy/potential";
  if (!needs_of(config).step_bound)
    complain(pointer, "\"derived\"", "none: the step solver is " + config.step_solver.name);
  std::unique_ptr<StiffnessPolicy> made;
  try {
    made = make_policy(policy_request(policy, PolicyUse::contact, 1), PolicyUse::contact);
  } catch (const ConfigError&) {
    return;  // check_policy has reported it
  }
  const GapStiffness* of = made->gap_stiffness();
  if (!of) return;
  made->set_time({config.time.dt, 1});
  constexpr KappaParts pairs[] = {{0, 1e-6}, {1, 1e-4}, {1e4, 1e-2}};  // k in N/m and m in kg
  const std::string fault = GapPotential(*barrier, *of).fault(pairs, config.formulation.d_hat);
  if (!fault.empty()) {
    complain(pointer, "\"derived\" with " + fault,
             "none, or kappa(d) and a shape whose force grows smoothly as the gap closes");
  }
}

/// A policy whose kappa has a potential requires a shape that has one too.
void check_potential(const std::string& section, const std::string& shape, Argument argument,
                     const PolicyConfig& policy, const RunConfig& config, const Complain& complain) {
  const auto derivative = policy.parameters.find("derivative");
  if (derivative == policy.parameters.end() ||
      derivative->second != ParameterValue(std::string("included"))) {
    return;
  }
  const std::string pointer = section + "/stiffness_policy/derivative";
  const auto barrier = barrier_of(shape, argument);
  if (barrier && !has_potential(*barrier)) {
    complain(pointer, fmt::format("\"included\" with {} on {}", shape, to_string(argument)),
             "dropped, or argument gap and one of the shapes with a potential: " + shapes_with_potential());
  }
  if (!needs_of(config).step_bound)
    complain(pointer, "\"included\"", "dropped: the step solver is " + config.step_solver.name);
}

/// Rows below 0, which corrections are, are no load of friction and have no Hessian that is positive by itself.
void check_corrections(const RunConfig& config, const Complain& complain) {
  const std::string corrected = "/contact/weighting", found = "\"area_corrected\"";
  if (config.step_solver.name != "line_search")
    complain(corrected, found, "area or none: " + config.step_solver.name + " knows no pair that takes back");
  if (config.contact.hessian_mode == HessianMode::gauss_newton) {
    complain("/contact/hessian_mode", "\"gauss_newton\"",
             "projected_full: with weighting area_corrected rows have to be projected");
  }
  const std::string allowed = "with weighting area_corrected: its corrections are no loads";
  refuse_friction(config, "0 " + allowed, complain);
  refuse_restitution(config, "1 " + allowed, complain);
}

void check_model(const RunConfig& config, ContactModel model, const Complain& complain) {
  const std::string where = "/contact/model", found = '"' + word_of(model) + '"';
  if (config.scene.planar) complain(where, found, "all_pairs: the scene is planar");
  if (model == ContactModel::points) {
    if (config.contact.weighting.value_or(ContactWeighting::none) != ContactWeighting::none)
      complain(where, found, "all_pairs, or weighting none: points have no area");
    return;
  }
  const std::string& solver = config.step_solver.name;
  if (solver != "line_search" && solver != "accumulated_toi")
    complain(where, found, "all_pairs, or line_search or accumulated_toi: the step solver is " + solver);
  if (config.precision != Precision::full)
    complain(where, found, "all_pairs, or precision double: blocks are computed in double");
  if (config.contact.weighting.value_or(ContactWeighting::none) != ContactWeighting::none)
    complain(where, found, "all_pairs, or weighting none: features of a block count as one");
}

/// What only some policies can do.
void check_contact(const RunConfig& config, const Complain& complain) {
  const ContactConfig& contact = config.contact;
  const StepBoundRule rule = contact.step_bound.value_or(StepBoundRule::accd);
  if (contact.bound_gamma && !bounds_each_vertex(rule)) {
    complain("/contact/bound_gamma", fmt::format("{}", *contact.bound_gamma),
             "nothing: accd does not read it, bounds of each vertex do");
  }
  const ContactModel model = contact.model.value_or(ContactModel::all_pairs);
  if (model != ContactModel::all_pairs) check_model(config, model, complain);
  const ContactWeighting weighting = contact.weighting.value_or(ContactWeighting::none);
  if (weighting == ContactWeighting::none) return;
  if (weighting == ContactWeighting::area_corrected) check_corrections(config, complain);
  const std::string where = "/contact/weighting", found = '"' + word_of(weighting) + '"';
  if (config.formulation.stiffness_policy.name != "fixed") {
    complain(where, found,
             "none, or policy fixed: kappa of " + config.formulation.stiffness_policy.name +
                 " is that of a pair and not of an area");
  }
  if (config.matching.rule != MatchingRule::as_given) {
    complain(where, found, "none, or matching rule as_given: the others match the kappa of a pair");
  }
}

void check_policies(const RunConfig& config, const Complain& complain) {
  const FormulationConfig& contact = config.formulation;
  check_policy("/formulation", contact.stiffness_policy, PolicyUse::contact,
               given_kappa(contact.stiffness_policy), complain);
  check_gap_potential("/formulation", contact.shape, contact.argument, contact.stiffness_policy, config,
                      complain);
  check_potential("/formulation", contact.shape, contact.argument, contact.stiffness_policy, config,
                  complain);
  const StrainLimitConfig& limit = config.strain_limit;
  if (!limit.enabled) return;
  check_potential("/strain_limit", limit.shape, limit.argument, limit.stiffness_policy, config, complain);
  check_policy("/strain_limit", limit.stiffness_policy, PolicyUse::limit, given_k_s(limit.stiffness_policy),
               complain);
}

bool given_both_bounds(const PolicyConfig& policy) {
  return policy.parameters.contains("kappa_min_N_per_m") && policy.parameters.contains("kappa_max_N_per_m");
}

/// c of the inertia M/(c h^2) is 0 without inertia.
void check_formula_of_inertia(const RunConfig& config, const Complain& complain) {
  const PolicyConfig& policy = config.formulation.stiffness_policy;
  if (policy.name != "formula" || config.integrator.name != "quasi_static") return;
  const std::string& formula = text(policy.parameters, "formula");
  const auto in_word = [](char letter) {
    return std::isalnum(static_cast<unsigned char>(letter)) || letter == '_';
  };
  for (std::size_t i = 0; i < formula.size(); ++i) {
    const bool alone =
        (i == 0 || !in_word(formula[i - 1])) && (i + 1 == formula.size() || !in_word(formula[i + 1]));
    if (formula[i] != 'c' || !alone) continue;
    complain("/formulation/stiffness_policy/formula", '"' + formula + '"',
             "a formula without c: it is of the inertia M/(c h^2), and the integrator is quasi_static");
    return;
  }
}

/// kappa of ipc_adaptive starts from the inertia of the contacts and the curvature at d_hat/2, unless both of
/// its bounds are given.
void check_adaptive_start(const RunConfig& config, const Complain& complain) {
  const PolicyConfig& policy = config.formulation.stiffness_policy;
  if (policy.name != "ipc_adaptive" || given_both_bounds(policy)) return;
  const std::string name = "/formulation/stiffness_policy/name", found = "\"ipc_adaptive\"";
  if (config.integrator.name == "quasi_static") {
    complain(name, found,
             "another policy, or kappa_min_N_per_m and kappa_max_N_per_m: it starts from inertia, and the "
             "integrator is quasi_static");
  }
  const double d_hat = config.formulation.d_hat;
  const auto barrier = barrier_of(config.formulation.shape, config.formulation.argument);
  if (barrier && !(barrier->eval(d_hat / 2, d_hat).d2b > 0)) {
    complain(name, found,
             fmt::format("another policy, or kappa_min_N_per_m and kappa_max_N_per_m: it starts from "
                         "b''(d_hat/2), and that of {} on {} is not > 0",
                         config.formulation.shape, to_string(config.formulation.argument)));
  }
}

/// Numbers of a limit of solids, where it is requested.
void check_solid_limit(const RunConfig& config, const Complain& complain) {
  const StrainLimitConfig& limit = config.strain_limit;
  const bool by_number = limits_solids(limit) && needs_k_s(limit.stiffness_policy);
  const char* const allowed = "nothing: it is read with strain_limit/solids true and policy fixed";
  if (limit.solid_k_s && !by_number) {
    complain("/strain_limit/solid_k_s_Pa", fmt::format("{}", *limit.solid_k_s), allowed);
  }
  if (config.matching.solid_limit_load && !limits_solids(limit)) {
    complain("/matching/solid_limit_load_Pa", fmt::format("{}", *config.matching.solid_limit_load),
             "nothing: it is read with strain_limit/solids true");
  }
  if (limit.solids.value_or(false) && !limit.enabled) {
    complain("/strain_limit/solids", "true", "false, or a limit: strain_limit is not enabled");
  }
}

/// Above this tolerance nothing falls: the first Newton step is already below it.
void check_tolerance(const RunConfig& config, const Complain& complain) {
  const double dt = config.time.dt;
  const double fall = 0.5 * largest_gravity(config.scene.gravity, config.scene.gravity_keys) * dt * dt;
  const bool falls = fall > 0 && config.integrator.name != "quasi_static";
  const double length = falls ? std::min(config.formulation.d_hat, fall) : config.formulation.d_hat;
  const double largest = 0.1 * length / dt;
  constexpr double rounding = 1 + 1e-12;  // the default sits exactly on the bound when the fall decides
  if (config.step_solver.tol_velocity > largest * rounding) {
    complain("/step_solver/tol_velocity_m_per_s", fmt::format("{}", config.step_solver.tol_velocity),
             fmt::format("a number <= {}, 0.1 min(d_hat, |g| dt^2/2)/dt (m/s)", largest));
  }
}

/// The estimator ritz reads what PCG saw: the spectrum of the full matrix scaled by its preconditioner, and nothing else.
void check_ritz(const RunConfig& config, const Complain& complain) {
  if (!config.passes.diagnose || config.diagnose.estimator != Estimator::ritz) return;
  if (config.diagnose.ends)
    complain("/diagnose/ends", "true with estimator ritz", "another estimator: ritz factorises nothing");
  const std::string& preconditioner = text(config.linear_solver.parameters, "preconditioner");
  const auto& stages = config.diagnose.stages;
  const auto& scalings = config.diagnose.scalings;
  const auto is_scaling = [&](Scaling s) { return to_string(s) == preconditioner; };
  if (config.linear_solver.name != "pcg") {
    complain("/diagnose/estimator", "ritz",
             "another estimator, or linear_solver pcg: ritz reads the Ritz values of PCG");
  } else if (text(config.linear_solver.parameters, "forcing") != "fixed") {
    complain("/diagnose/estimator", "ritz",
             "another estimator, or linear_solver.forcing fixed: loose solves know no ends of a spectrum");
  } else if (std::none_of(scalings.begin(), scalings.end(), is_scaling)) {
    complain(
        "/diagnose/estimator", "ritz",
        fmt::format(
            "another estimator, or a preconditioner among diagnose.scalings: ritz knows the matrix scaled by "
            "its preconditioner only, and that is {}",
            preconditioner));
  } else if (std::find(stages.begin(), stages.end(), "full") == stages.end()) {
    complain("/diagnose/stages", "no stage full", "full: ritz knows the matrix that PCG solves");
  }
}

}  // namespace

std::optional<BarrierFunction> barrier_of(const std::string& shape, Argument argument) {
  const std::optional<Shape> found = find_shape(shape);
  return found ? std::optional<BarrierFunction>({*found, argument}) : std::nullopt;
}

void check_contradictions(const RunConfig& config, const std::string& source,
                          std::vector<Violation>& violations) {
  const Complain complain{source, violations};
  check_exponent("/formulation", config.formulation.shape, complain);
  if (config.strain_limit.shape != config.formulation.shape) {
    check_exponent("/strain_limit", config.strain_limit.shape, complain);
  }
  check_contact(config, complain);
  check_step_solver(config, complain);
  check_friction(config, complain);
  check_step_size(config, complain);
  check_damping(config, complain);
  check_policies(config, complain);
  check_formula_of_inertia(config, complain);
  check_adaptive_start(config, complain);
  check_matching(config, complain);
  check_solid_limit(config, complain);
  check_tolerance(config, complain);
  check_ritz(config, complain);
  if (!config.method.empty()) {
    if (friction_of_method(config.method).empty()) {
      refuse_friction(config, "0 with method " + config.method + ", whose file states nothing about friction",
                      complain);
    }
    refuse_restitution(config, "1 with method " + config.method + ", whose file states nothing about it",
                       complain);
  }
  check_device(config, complain);
  check_output(config, complain);
}

}  // namespace bb
