#include "experiments/run/plan.hpp"

#include "experiments/config/policy_request.hpp"
#include "experiments/run/method.hpp"

namespace bb {
namespace {

/// Asked of the policies themselves, so that one of a plugin counts too. The numbers do not matter.
bool reads_elastic_matrix(const RunConfig& config) {
  Calibration any;
  any.kappa = any.k_s = 1;
  if (make_contact_policy(config.formulation.stiffness_policy, any)->needs_hessian()) return true;
  return config.strain_limit.enabled &&
         make_limit_policy(config.strain_limit.stiffness_policy, any).needs_hessian();
}

}  // namespace

bool has_observed_run(const RunConfig& config) {
  return config.passes.diagnose || config.passes.audit || !config.passes.time ||
         config.output.frames_every > 0;
}

Plan plan_of(const RunConfig& config, const Scene& scene) {
  PlanOptions options;
  options.strain_limit = config.strain_limit.enabled;
  options.mollifier = config.contact.mollifier != Mollifier::none;
  options.collision_free_steps = config.step_solver.name != "article_literal";
  options.policy_needs_submatrix = reads_elastic_matrix(config);
  options.iterative_solver = config.linear_solver.name == "pcg";
  options.diagnose = config.passes.diagnose;
  options.audit = config.passes.audit;
  options.trace = has_observed_run(config);
  options.frames = config.output.frames_every > 0;
  options.matrices = config.output.matrices;
  return make_plan(scene, options);
}

}  // namespace bb
