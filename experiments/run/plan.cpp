#include "experiments/run/plan.hpp"

namespace bb {

Plan plan_of(const RunConfig& config, const Scene& scene) {
  const PolicyConfig& contact = config.formulation.stiffness_policy;
  const PolicyConfig& limit = config.strain_limit.stiffness_policy;
  PlanOptions options;
  options.strain_limit = config.strain_limit.enabled;
  options.mollifier = config.contact.mollifier != Mollifier::none;
  options.policy_needs_submatrix = (contact.name == "elasticity_inclusive" && contact.elastic_term) ||
                                   (config.strain_limit.enabled && limit.name == "elasticity_inclusive");
  options.iterative_solver = config.linear_solver.name == "pcg";
  options.diagnose = config.passes.diagnose;
  options.audit = config.passes.audit;
  options.frames = config.output.frames_every > 0;
  options.matrices = config.output.matrices;
  return make_plan(scene, options);
}

}  // namespace bb
