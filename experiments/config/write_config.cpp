// RunConfig to canonical JSON: what reader.hpp reads, with every default in place.
#include <nlohmann/json.hpp>

#include "barriers/stiffness/registry.hpp"
#include "core/record/provenance.hpp"
#include "experiments/config/parse.hpp"

namespace bb {
namespace {

using nlohmann::json;

json to_json(const Vec3d& v) { return json::array({v[0], v[1], v[2]}); }

json to_json(const ParameterMap& parameters) {
  json out = json::object();
  for (const auto& [name, value] : parameters) {
    std::visit([&, key = name](const auto& held) { out[key] = held; }, value);
  }
  return out;
}

json to_json(const RigidMotion& motion) {
  json out = {{"velocity_m_per_s", to_json(motion.velocity)},
              {"center_m", to_json(motion.center)},
              {"axis", to_json(motion.axis)},
              {"angular_velocity_rad_per_s", motion.angular_velocity},
              {"start_s", motion.start}};
  if (motion.end < std::numeric_limits<double>::infinity()) out["end_s"] = motion.end;
  return out;
}

json to_json(const MeshSource& mesh) {
  if (!mesh.file.empty()) return {{"file", mesh.file}, {"sha256", mesh.sha256}};
  json out = to_json(mesh.parameters);
  out["generator"] = mesh.generator;
  return out;
}

json to_json(const Material& m) {
  json out = {{"model", m.model},
              {"poisson", m.poisson},
              {"density_kg_per_m2", m.density},
              {"line_density_kg_per_m", m.line_density},
              {"bending_J", m.bending},
              {"springs_N_per_m", m.springs}};
  out[m.thickness ? "youngs_Pa" : "youngs_N_per_m"] = m.youngs;
  if (m.thickness) out["thickness_m"] = *m.thickness;
  if (m.warp_axis) out["warp_axis"] = to_json(*m.warp_axis);
  return out;
}

json to_json(const PinSpec& pin) {
  json out = {{"top_row", pin.top_row}, {"all", pin.all}, {"motion", to_json(pin.motion)}};
  if (!pin.indices.empty()) out["indices"] = pin.indices;
  if (pin.box) out["box_m"] = json::array({to_json((*pin.box)[0]), to_json((*pin.box)[1])});
  return out;
}

json to_json(const BodyConfig& body) {
  json out = {{"name", body.spec.name},
              {"mesh", to_json(body.mesh)},
              {"transform",
               {{"scale", body.transform.scale},
                {"axis", to_json(body.transform.axis)},
                {"angle_deg", body.transform.angle},
                {"translate_m", to_json(body.transform.translation)}}},
              {"offset_m", body.spec.offset}};
  if (body.spec.d_hat > 0) out["d_hat_m"] = body.spec.d_hat;
  if (body.spec.kind == BodyKind::rigid) {
    out["kind"] = "rigid";
    out["motion"] = to_json(body.spec.motion);
    return out;
  }
  out["kind"] = "deformable";
  out["material"] = to_json(body.spec.material);
  out["velocity_m_per_s"] = to_json(body.spec.velocity);
  out["limited"] = body.limited;
  out["pins"] = json::array();
  for (const PinSpec& pin : body.spec.pins) out["pins"].push_back(to_json(pin));
  return out;
}

json to_json(const Obstacle& obstacle) {
  json out = {{"name", obstacle.name}, {"point_m", to_json(obstacle.point)}};
  if (obstacle.kind == ObstacleKind::plane) {
    out["kind"] = "plane";
    out["axis"] = to_json(obstacle.axis);
    return out;
  }
  out["kind"] = obstacle.kind == ObstacleKind::sphere ? "sphere" : "cylinder";
  out["radius_m"] = obstacle.radius;
  out["inside"] = obstacle.inside;
  if (obstacle.kind == ObstacleKind::cylinder) out["axis"] = to_json(obstacle.axis);
  return out;
}

json to_json(const SceneConfig& scene) {
  if (scene.name != "bodies") {
    json out = to_json(scene.parameters);
    out["name"] = scene.name;
    return out;
  }
  json out = {{"name", "bodies"},
              {"planar", scene.planar},
              {"gravity_m_per_s2", to_json(scene.gravity)},
              {"bodies", json::array()},
              {"obstacles", json::array()}};
  if (scene.planar) out["pairs"] = scene.pairs == PlanarPairs::point_edge ? "point_edge" : "vertex_vertex";
  for (const BodyConfig& body : scene.bodies) out["bodies"].push_back(to_json(body));
  for (const Obstacle& obstacle : scene.obstacles) out["obstacles"].push_back(to_json(obstacle));
  return out;
}

/// Only what the policy reads.
json to_json(const PolicyConfig& policy) {
  json out = {{"name", policy.name}, {"scale", policy.scale}};
  if (policy.kappa) out["kappa_N_per_m"] = *policy.kappa;
  if (policy.k_s) out["k_s_N_per_m"] = *policy.k_s;
  if (policy.kappa_min) out["kappa_min_N_per_m"] = *policy.kappa_min;
  if (policy.kappa_max) out["kappa_max_N_per_m"] = *policy.kappa_max;
  if (policy.doubling_gap) out["doubling_gap_m"] = *policy.doubling_gap;
  if (policy.name == "fixed" || policy.name == "ipc_adaptive") return out;
  out["refresh"] = to_string(policy.refresh);
  if (policy.name != "elasticity_inclusive") return out;
  out["mass_term"] = to_string(policy.mass_term);
  out["elastic_term"] = policy.elastic_term;
  return out;
}

json to_json(const FormulationConfig& formulation) {
  json out = {{"shape", formulation.shape},
              {"argument", to_string(formulation.argument)},
              {"stiffness_policy", to_json(formulation.stiffness_policy)},
              {"d_hat_m", formulation.d_hat}};
  if (!formulation.name.empty()) out["name"] = formulation.name;
  return out;
}

json to_json(const StrainLimitConfig& limit) {
  if (!limit.enabled) return {{"enabled", false}};
  return {{"enabled", true},
          {"shape", limit.shape},
          {"argument", to_string(limit.argument)},
          {"stiffness_policy", to_json(limit.stiffness_policy)},
          {"onset", limit.limit.onset},
          {"width", limit.limit.width}};
}

json to_json(const MatchingConfig& matching) {
  json out = {{"rule", to_string(matching.rule)}, {"theta", matching.theta}};
  if (matching.load) out["load_N"] = *matching.load;
  if (matching.limit_load) out["limit_load_N_per_m"] = *matching.limit_load;
  if (matching.curvature) out["curvature_N_per_m"] = *matching.curvature;
  if (matching.limit_curvature) out["limit_curvature_N_per_m"] = *matching.limit_curvature;
  return out;
}

json to_json(const StepSolverConfig& solver) {
  return {{"name", solver.name},
          {"max_iterations", solver.max_iterations},
          {"tol_velocity_m_per_s", solver.tol_velocity},
          {"armijo", solver.armijo},
          {"cap_fraction", solver.cap_fraction},
          {"target_toi", solver.target_toi},
          {"min_newton_steps", solver.min_newton_steps}};
}

json to_json(const DiagnoseConfig& diagnose) {
  json scalings = json::array();
  for (const Scaling scaling : diagnose.scalings) {
    scalings.push_back(scaling == Scaling::none     ? "none"
                       : scaling == Scaling::jacobi ? "jacobi"
                                                    : "block_jacobi");
  }
  return {{"tier", diagnose.tier},      {"scalings", scalings},  {"every", diagnose.every},
          {"stages", diagnose.stages},  {"seed", diagnose.seed}, {"pcg", diagnose.pcg},
          {"budget_s", diagnose.budget}};
}

}  // namespace

std::string resolved_json(const RunConfig& config) {
  const json document = {
      {"schema", "barrierbench.config/1"},
      {"scene", to_json(config.scene)},
      {"formulation", to_json(config.formulation)},
      {"strain_limit", to_json(config.strain_limit)},
      {"matching", to_json(config.matching)},
      {"contact",
       {{"mollifier", config.contact.mollifier == Mollifier::ipc ? "ipc" : "none"},
        {"hessian_mode",
         config.contact.hessian_mode == HessianMode::gauss_newton ? "gauss_newton" : "projected_full"},
        {"ccd_park", config.contact.ccd_park}}},
      {"integrator", {{"name", config.integrator}}},
      {"time", {{"dt_s", config.time.dt}, {"steps", config.time.steps}}},
      {"step_solver", to_json(config.step_solver)},
      {"linear_solver",
       {{"name", config.linear_solver.name},
        {"preconditioner", config.linear_solver.preconditioner},
        {"tol_rel", config.linear_solver.tol_rel},
        {"max_iterations", config.linear_solver.max_iterations}}},
      {"precision", config.precision},
      {"passes",
       {{"time", config.passes.time}, {"diagnose", config.passes.diagnose}, {"audit", config.passes.audit}}},
      {"diagnose", to_json(config.diagnose)},
      {"seeds", {{"main", config.seeds.main}, {"jitter_m", config.seeds.jitter}}},
      {"output", {{"frames_every", config.output.frames_every}, {"matrices", config.output.matrices}}},
      {"threads", config.threads}};
  return document.dump(2);
}

std::string config_id(const RunConfig& config) { return config_id(std::string_view(resolved_json(config))); }

}  // namespace bb
