#include "tests/features/feature.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/terms/registry.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/stepped_run.hpp"

namespace bb::features {

using nlohmann::json;

Vec3d Track::velocity(std::size_t step) const {
  Vec3d momentum = Vec3d::Zero();
  double mass = 0;
  for (int i = 0; i < scene.n_vertices(); ++i) {
    const double m = scene.mass[static_cast<std::size_t>(i)];
    momentum += m * v[step].col(i);
    mass += m;
  }
  return momentum / mass;
}

std::size_t Track::at(double time) const {
  std::size_t step = 0;
  while (step + 1 < t.size() && t[step] < time - dt / 2) ++step;
  return step;
}

json plate(const std::string& name, double height, double velocity_z) {
  json out = {{"name", name}};
  out["mesh"] = {{"generator", "grid"}, {"n_x", 2}, {"n_y", 2}, {"size_x_m", 0.1}, {"size_y_m", 0.1}};
  out["transform"]["translate_m"] = {0, 0, height};
  out["material"] = {{"model", "none"}, {"springs_N_per_m", 2000.0}, {"density_kg_per_m2", 100.0}};
  out["material"]["lumping"] = "uniform";  // the vertices have the same mass
  out["velocity_m_per_s"] = {0.0, 0.0, velocity_z};
  return out;
}

json bare(const Method& method, double dt, int steps) {
  json out = {{"schema", "barrierbench.config/1"}};
  out["scene"] = {{"name", "bodies"}, {"gravity_m_per_s2", {0, 0, 0}}, {"bodies", {plate("plate", 0)}}};
  out["time"] = {{"dt_s", dt}, {"steps", steps}};
  out["integrator"]["name"] = method.entry.name;
  out["step_solver"] = {{"name", method.solver.name}, {"tol_velocity_m_per_s", 1e-6}};
  // what is required of the others, and a penalty that is not small beside m/h^2
  if (method.solver.name == "pncg") out["step_solver"]["pncg_epsilon"] = 1e-10;
  if (method.solver.name == "augmented_lagrangian") out["step_solver"]["al_penalty_largest_N_per_m"] = 1e10;
  out["formulation"] = {{"shape", "quadratic"}, {"argument", "gap"}, {"d_hat_m", 1e-3}};
  out["formulation"]["stiffness_policy"] = {{"name", "fixed"}, {"kappa_N_per_m", 4000.0}};
  out["matching"]["rule"] = "as_given";
  out["passes"] = {{"time", true}, {"diagnose", false}, {"audit", false}};
  return out;
}

void add_floor(json& config) { config["scene"]["obstacles"] = {{{"name", "floor"}, {"kind", "plane"}}}; }

json on_the_floor(const Method& method, double dt, int steps) {
  json config = bare(method, dt, steps);
  add_floor(config);
  config["scene"]["bodies"] = {plate("plate", 7e-4)};
  return config;
}

void ground(const Method& method, json& config, double stiffness) {
  if (!method.still()) return;
  for (json& body : config["scene"]["bodies"])
    body["pins"].push_back({{"all", true}, {"pull_N_per_m", stiffness}});
}

// A step may cover a part of its length alone; load steps are as many as there are.
Outcome run_case(const json& config) {
  json longer = config;
  const bool loads = make_integrator(config["integrator"]["name"])->quasi_static();
  if (!loads) longer["time"]["steps"] = 10 * config["time"]["steps"].get<int>();
  SteppedRun run(parse_config(longer.dump(), "case"), {});
  const double end = config["time"]["dt_s"].get<double>() * (config["time"]["steps"].get<int>() - 0.5);
  Outcome out;
  out.track.scene = run.scene();
  out.track.dt = run.config().time.dt;
  const auto take = [&] {
    out.track.t.push_back(run.time());
    out.track.x.push_back(run.x());
    out.track.v.push_back(run.v());
  };
  take();
  while (!run.over() && run.time() < end) {
    run.step();
    take();
  }
  const Verdict& verdict = run.verdict();
  if (verdict.outcome != bb::Outcome::ok)
    out.failed =
        fmt::format("ended {} after {} steps: {}", to_string(verdict.outcome), run.steps(), verdict.detail);
  const Calibration calibration;
  const bb::Method method = make_method(run.config(), calibration);
  const Plan plan = make_plan(run.scene(), method, plan_options(method));
  for (const TermEntry& term : term_entries())
    if (plan.term(term.name).needed) out.terms.emplace_back(term.name);
  return out;
}

std::string differs(const char* name, double found, double expected, double tolerance) {
  if (std::abs(found - expected) <= tolerance) return {};
  return fmt::format("{} is {:.6g}, not {:.6g} within {:.2g}", name, found, expected, tolerance);
}

std::vector<Feature> features() {
  std::vector<Feature> out;
  for (const auto& group : {contact_features(), friction_features(), prescribed_features(), load_features(),
                            stitch_features(), part_features()})
    out.insert(out.end(), group.begin(), group.end());
  return out;
}

}  // namespace bb::features
