#include "experiments/run/method.hpp"

#include "barriers/shapes/registry.hpp"
#include "core/math/error.hpp"
#include "core/model/integrators/registry.hpp"
#include "core/newton/executor/executor_engine.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/config/policy_request.hpp"
#include "experiments/run/device_run.hpp"

namespace bb {
namespace {

double require_stiffness(const std::optional<double>& calibrated, const std::optional<double>& given,
                         const char* where) {
  if (calibrated) return *calibrated;
  if (given) return *given;
  throw ConfigError(where, "nothing", "a number > 0, or a matching rule other than as_given");
}

StepSolverOptions step_solver_options(const RunConfig& config) {
  StepSolverOptions out;
  out.name = config.step_solver.name;
  out.max_iterations = config.step_solver.max_iterations;
  out.retries = config.step_solver.retries;
  out.saddle = config.step_solver.saddle;
  out.tol_velocity = config.step_solver.tol_velocity;
  out.parameters = config.step_solver.parameters;
  return out;
}

StepSizeOptions step_size_options(const TimeConfig& time) {
  StepSizeOptions out;
  out.rule = time.step_size.value_or(out.rule);
  out.iterations = time.step_iterations.value_or(out.iterations);
  out.halvings = time.step_halvings.value_or(out.halvings);
  out.error_m = time.step_error.value_or(out.error_m);
  return out;
}

FrictionOptions friction_options(const FrictionConfig& friction) {
  FrictionOptions out;
  out.law = friction.law;
  out.mu = friction.mu;
  out.mu_static = friction.mu_static;
  out.combine = friction.combine;
  out.lag_iterations = friction.lag_iterations;
  out.eps_v = friction.eps_v;
  out.eps_m = friction.eps_m;
  out.kinetic_v = friction.kinetic_v;
  out.hessian = friction.hessian.value_or(out.hessian);
  out.refresh = friction.refresh.value_or(out.refresh);
  return out;
}

}  // namespace

std::unique_ptr<StiffnessPolicy> make_contact_policy(const PolicyConfig& policy,
                                                     const Calibration& calibration) {
  double kappa = 0;
  if (needs_kappa(policy)) {
    kappa = require_stiffness(calibration.kappa, given_kappa(policy),
                              "/formulation/stiffness_policy/kappa_N_per_m");
  }
  return make_policy(policy_request(policy, PolicyUse::contact, kappa, calibration.scale));
}

std::unique_ptr<StiffnessPolicy> make_limit_policy(const PolicyConfig& policy,
                                                   const Calibration& calibration) {
  if (!calibration.limited) return nullptr;
  double k_s = 0;
  if (needs_k_s(policy)) {
    k_s = require_stiffness(calibration.k_s, given_k_s(policy), "/strain_limit/stiffness_policy/k_s_N_per_m");
  }
  return make_policy(policy_request(policy, PolicyUse::limit, k_s, calibration.limit_scale),
                     PolicyUse::limit);
}

std::unique_ptr<StiffnessPolicy> make_solid_limit_policy(const StrainLimitConfig& limit,
                                                         const Calibration& calibration) {
  if (!limits_solids(limit)) return nullptr;
  const PolicyConfig& policy = limit.stiffness_policy;
  double k_s = 0;
  if (needs_k_s(policy)) {
    k_s = require_stiffness(calibration.solid_k_s, limit.solid_k_s, "/strain_limit/solid_k_s_Pa");
  }
  return make_policy(policy_request(policy, PolicyUse::limit, k_s), PolicyUse::limit);
}

ContactOptions contact_options(const ContactConfig& contact) {
  ContactOptions out;
  out.mollifier = contact.mollifier;
  out.min_gap_fraction = contact.min_gap_fraction;
  out.weighting = contact.weighting.value_or(ContactWeighting::none);
  out.model = contact.model.value_or(ContactModel::all_pairs);
  out.rest_rule = contact.rest_rule.value_or(RestRule::on);
  out.step_bound = contact.step_bound.value_or(StepBoundRule::accd);
  out.bound_gamma = contact.bound_gamma.value_or(default_bound_gamma);
  return out;
}

Method make_method(const RunConfig& config, const Calibration& calibration) {
  Method method;
  method.contact = {require_shape(config.formulation.shape), config.formulation.argument};
  method.stiffness = make_contact_policy(config.formulation.stiffness_policy, calibration);
  method.strain_limit = config.strain_limit.enabled;
  if (method.strain_limit) {
    method.limit = {require_shape(config.strain_limit.shape), config.strain_limit.argument};
    method.limit_stiffness = make_limit_policy(config.strain_limit.stiffness_policy, calibration);
    method.solid_limit_stiffness = make_solid_limit_policy(config.strain_limit, calibration);
  }
  method.precision = config.precision;
  method.contact.in_float = method.limit.in_float = values_in_float(config.precision);
  method.hessian_mode = config.contact.hessian_mode;
  method.contact_options = contact_options(config.contact);
  method.friction = friction_options(config.friction);
  method.integrator = make_integrator(config.integrator.name, config.integrator.parameters);
  method.step_solver = step_solver_options(config);
  method.step_size = step_size_options(config.time);
  fit_terms(method);
  for (const HessianChoice& choice : hessian_choices()) {
    method.step_hessian[choice.name] = step_hessian_of(text(config.hessian.parameters, choice.name));
  }
  method.linear = {config.linear_solver.name, config.linear_solver.parameters};
  if (config.device != Device::cpu) {
    method.make_potential = [device = config.device](const Scene& scene, Method& of, const Plan& plan,
                                                     const std::vector<std::uint8_t>& fixed,
                                                     PhaseClock& clock) {
      auto out = std::make_unique<exec::ExecutorEngine>(make_executor(device), scene, of, plan, fixed, clock);
      if (synchronizes_phases()) out->synchronize_phases();
      return out;
    };
  }
  return method;
}

}  // namespace bb
