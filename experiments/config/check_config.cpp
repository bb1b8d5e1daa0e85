// Settings that contradict each other across sections.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "barriers/shapes/registry.hpp"
#include "core/barrier/folded_barrier.hpp"
#include "core/integrators/registry.hpp"
#include "core/newton/step_solver.hpp"
#include "core/terms/step_hessian.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/policy_request.hpp"
#include "experiments/config/reader.hpp"

namespace bb {
namespace {

/// Nothing for an unknown name: it has a violation already.
std::optional<BarrierFunction> barrier_of(const std::string& shape, Argument argument) {
  const std::optional<Shape> found = find_shape(shape);
  return found ? std::optional<BarrierFunction>({*found, argument}) : std::nullopt;
}

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

/// Step solvers whose steps end in a minimum of E: a list of names.
std::string solvers_with_minimum() {
  std::vector<std::string> names;
  for (const StepSolverEntry& entry : step_solvers()) {
    if (entry.needs.minimum) names.emplace_back(entry.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

void check_step_solver(const RunConfig& config, const Complain& complain) {
  const StepSolverConfig& solver = config.step_solver;
  const StepNeeds needs = needs_of(config);
  const bool unbound = !needs.step_bound, literal = unbound && !needs.overlap;
  if ((solver.name == "accumulated_toi" || literal) && config.integrator.name != "implicit_euler") {
    complain("/integrator/name", '"' + config.integrator.name + '"',
             "implicit_euler: the step solver is " + solver.name);
  }
  if (unbound && config.formulation.argument != Argument::gap) {
    complain("/formulation/argument", "\"squared_gap\"", "gap: the step solver is " + solver.name);
  }
  if (literal && config.strain_limit.argument != Argument::gap) {
    complain("/strain_limit/argument", "\"squared_gap\"", "gap: the step solver is " + solver.name);
  }
  if (solver.saddle == SaddleRule::report && !needs.matrix) {
    complain("/step_solver/saddle", "\"report\"",
             "ignore: the step solver " + solver.name + " has no matrix");
  }
  if (solver.saddle == SaddleRule::escape && !needs.minimum) {
    complain("/step_solver/saddle", "\"escape\"",
             "report or ignore: of step solvers only these can leave a saddle: " + solvers_with_minimum());
  }
  if (config.friction.lag_iterations > 1 && !needs.minimum) {
    complain("/friction/lag_iterations", fmt::format("{}", config.friction.lag_iterations),
             "1: of step solvers only these solve a step again: " + solvers_with_minimum());
  }
  if (needs.overlap) check_overlap(config, complain);
  const int min_newton_steps = integer(solver.parameters, "min_newton_steps");
  if (solver.name == "accumulated_toi" && min_newton_steps > solver.max_iterations) {
    complain("/step_solver/min_newton_steps", fmt::format("{}", min_newton_steps),
             fmt::format("an integer <= max_iterations = {}", solver.max_iterations));
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

/// The article's solver adds its own term to a matrix that has to be positive semi-definite.
void check_hessians(const RunConfig& config, const Complain& complain) {
  if (config.step_solver.name != "article_literal") return;
  for (const HessianChoice& choice : hessian_choices()) {
    const std::string& value = text(config.hessian.parameters, choice.name);
    if (value == to_string(StepHessian::clamped)) continue;
    complain("/hessian/" + choice.name, '"' + value + '"', "clamped: the step solver is article_literal");
  }
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

/// A policy whose kappa has a potential asks for a shape that has one too.
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

/// What only some step solvers and policies can do.
void check_contact(const RunConfig& config, const Complain& complain) {
  const ContactConfig& contact = config.contact;
  const StepBoundRule rule = contact.step_bound.value_or(StepBoundRule::accd);
  if (bounds_each_vertex(rule) && config.step_solver.name != "line_search") {
    complain("/contact/step_bound", '"' + word_of(rule) + '"',
             "accd, or step solver line_search: " + config.step_solver.name +
                 " takes one part of a step for all vertices");
  }
  if (contact.bound_gamma && !bounds_each_vertex(rule)) {
    complain("/contact/bound_gamma", fmt::format("{}", *contact.bound_gamma),
             "nothing: accd does not read it, planar_truncation and per_vertex do");
  }
  if (contact.weighting != ContactWeighting::area) return;
  const std::string where = "/contact/weighting", found = "\"area\"";
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

/// A barrier of which matching reads its slope at theta or its curvature at 1/2 of its width.
struct MatchedBarrier {
  const std::string& shape;
  Argument argument;
  double width;
  const char* load_pointer;
  std::optional<double> load;
  const PolicyConfig& policy;
  bool by_number;  // the rule supplies the policy's stiffness, and asks nothing of it
};

bool usable(double value) { return std::isfinite(value) && value > 0; }

void check_matched_barrier(const MatchingConfig& matching, const MatchedBarrier& m,
                           const Complain& complain) {
  const auto function = barrier_of(m.shape, m.argument);
  if (!function) return;  // it has a violation already
  const std::string name = fmt::format("{} on {}", m.shape, to_string(m.argument));
  if (matching.rule == MatchingRule::equal_curvature) {
    if (usable(function->eval(m.width / 2, m.width).d2b)) return;
    complain("/matching/rule", "\"equal_curvature\"",
             fmt::format("equal_force or as_given: b'' of {} is not > 0 at half its width", name));
    return;
  }
  const double slope = -function->eval(matching.theta * m.width, m.width).db;
  if (!usable(slope)) {
    complain("/matching/theta", fmt::format("{}", matching.theta),
             fmt::format("a value where b' of {} is finite and not 0", name));
  } else if (m.load && !usable(*m.load / slope)) {
    complain(m.load_pointer, fmt::format("{}", *m.load),
             fmt::format("a load that a stiffness of {} can be matched to", name));
  }
}

/// Without weight no pilot can start: loads have to be given, and a policy that makes its own stiffness has
/// nobody to ask about the contact that carried them.
void check_pilot(const RunConfig& config, const MatchedBarrier& m, const Complain& complain) {
  if (config.scene.gravity.norm() > 0) return;
  if (!m.load) complain(m.load_pointer, "nothing", "a load: without gravity no pilot can start");
  if (m.by_number) return;
  complain("/matching/rule", fmt::format("\"{}\"", to_string(config.matching.rule)),
           fmt::format("as_given: policy {} is matched by a pilot, and without gravity none can start",
                       m.policy.name));
}

/// False when no body of the scene can have a limited element.
bool may_be_limited(const RunConfig& config) {
  const auto& bodies = config.scene.bodies;
  return config.strain_limit.enabled &&
         (config.scene.name != "bodies" || std::any_of(bodies.begin(), bodies.end(), [](const BodyConfig& b) {
            return b.limited && b.spec.kind != BodyKind::rigid;
          }));
}

void check_matching(const RunConfig& config, const Complain& complain) {
  if (config.matching.rule == MatchingRule::as_given) return;
  const FormulationConfig& contact = config.formulation;
  const StrainLimitConfig& limit = config.strain_limit;
  std::vector<MatchedBarrier> matched{{contact.shape, contact.argument, contact.d_hat, "/matching/load_N",
                                       config.matching.load, contact.stiffness_policy,
                                       needs_kappa(contact.stiffness_policy)}};
  if (may_be_limited(config)) {
    matched.push_back({limit.shape, limit.argument, limit.width, "/matching/limit_load_N_per_m",
                       config.matching.limit_load, limit.stiffness_policy,
                       needs_k_s(limit.stiffness_policy)});
  }
  const MatchedBarrier of_solids{limit.shape,
                                 limit.argument,
                                 limit.width,
                                 "/matching/solid_limit_load_Pa",
                                 config.matching.solid_limit_load,
                                 limit.stiffness_policy,
                                 true};
  if (config.matching.solid_limit_load) check_matched_barrier(config.matching, of_solids, complain);
  for (const MatchedBarrier& m : matched) {
    check_matched_barrier(config.matching, m, complain);
    check_pilot(config, m, complain);
  }
}

/// Numbers of a limit of solids, where it is asked for.
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
  if (limits_solids(limit) && config.device != Device::cpu) {
    complain("/strain_limit/solids", "true", "false, or /device cpu: a limit of tetrahedra has no kernel");
  }
}

/// Above this tolerance nothing falls: the first Newton step is already below it.
void check_tolerance(const RunConfig& config, const Complain& complain) {
  const double dt = config.time.dt, fall = 0.5 * config.scene.gravity.norm() * dt * dt;
  const bool falls = fall > 0 && config.integrator.name != "quasi_static";
  const double length = falls ? std::min(config.formulation.d_hat, fall) : config.formulation.d_hat;
  const double largest = 0.1 * length / dt;
  constexpr double rounding = 1 + 1e-12;  // the default sits exactly on the bound when the fall decides
  if (config.step_solver.tol_velocity > largest * rounding) {
    complain("/step_solver/tol_velocity_m_per_s", fmt::format("{}", config.step_solver.tol_velocity),
             fmt::format("a number <= {}, 0.1 min(d_hat, |g| dt^2/2)/dt (m/s)", largest));
  }
}

/// Tier 0 reads what PCG saw: the spectrum of the full matrix scaled by its preconditioner, and nothing else.
void check_ritz(const RunConfig& config, const Complain& complain) {
  if (!config.passes.diagnose || config.diagnose.tier != 0) return;
  if (config.diagnose.ends)
    complain("/diagnose/ends", "true with tier 0", "tier 1, 2 or 3: tier 0 factorises nothing");
  const std::string& preconditioner = text(config.linear_solver.parameters, "preconditioner");
  const auto& stages = config.diagnose.stages;
  const auto& scalings = config.diagnose.scalings;
  const auto is_scaling = [&](Scaling s) { return to_string(s) == preconditioner; };
  if (config.linear_solver.name != "pcg") {
    complain("/diagnose/tier", "0", "1, 2 or 4, or linear_solver pcg: tier 0 reads the Ritz values of PCG");
  } else if (text(config.linear_solver.parameters, "forcing") != "fixed") {
    complain("/diagnose/tier", "0",
             "1 or 2, or linear_solver.forcing fixed: loose solves know no ends of a spectrum");
  } else if (std::none_of(scalings.begin(), scalings.end(), is_scaling)) {
    complain(
        "/diagnose/tier", "0",
        fmt::format("1 or 2, or a preconditioner among diagnose.scalings: tier 0 knows the matrix scaled by "
                    "its preconditioner only, and that is {}",
                    preconditioner));
  } else if (std::find(stages.begin(), stages.end(), "full") == stages.end()) {
    complain("/diagnose/stages", "no stage full", "full: tier 0 knows the matrix that PCG solves");
  }
}

void check_protocol(const RunConfig& config, const Complain& complain) {
  const bool literal = follows_article(config.scene);
  if (literal == (config.step_solver.name == "article_literal")) return;
  complain("/step_solver/name", '"' + config.step_solver.name + '"',
           literal
               ? "article_literal: it is the scene's protocol"
               : "another step solver: article_literal needs scene drape2d with protocol article_literal");
}

}  // namespace

StepNeeds needs_of(const RunConfig& config) {
  const StepSolverEntry* entry = step_solvers().find(config.step_solver.name);
  return entry ? entry->needs : StepNeeds{};
}

bool follows_article(const SceneConfig& scene) {
  const auto protocol = scene.parameters.find("protocol");
  return protocol != scene.parameters.end() &&
         protocol->second == ParameterValue(std::string("article_literal"));
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
  check_damping(config, complain);
  check_hessians(config, complain);
  check_policies(config, complain);
  check_adaptive_start(config, complain);
  check_matching(config, complain);
  check_solid_limit(config, complain);
  check_tolerance(config, complain);
  check_protocol(config, complain);
  check_ritz(config, complain);
  if (!config.method.empty()) {
    refuse_friction(config, "0 with method " + config.method + ", whose file says nothing of friction",
                    complain);
    refuse_restitution(config, "1 with method " + config.method + ", whose file says nothing of it",
                       complain);
  }
  check_device(config, complain);
  if (config.output.matrices && !config.passes.diagnose) {
    complain("/output/matrices", "true",
             "false, or passes.diagnose true: matrices are those of diagnosed iterations");
  }
}

}  // namespace bb
