// The sections that every formulation shares: contact, integrator, time, solvers, passes, output.
#include <algorithm>

#include "barriers/named_entries.hpp"
#include "core/integrators/registry.hpp"
#include "experiments/config/reader.hpp"

namespace bb {
namespace {

using nlohmann::json;

#define ENTRY(name, doc) #name,
const std::vector<std::string> linear_solver_names = {
#include "core/linear/registry.inc"
};
const std::vector<std::string> step_solver_names = {
#include "core/newton/registry.inc"
};
#undef ENTRY

std::string read_name(const json& section, const std::string& fallback, const std::vector<std::string>& names,
                      const std::string& pointer, const Reader& reader) {
  const std::string name = section.value("name", fallback);
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    reader.take(unknown_name(reader.source + "#" + pointer, name, names));
  }
  return name;
}

void read_contact(const json& section, ContactConfig& out) {
  out.mollifier = section.value("mollifier", "ipc") == "ipc" ? Mollifier::ipc : Mollifier::none;
  out.hessian_mode = section.value("hessian_mode", "gauss_newton") == "gauss_newton"
                         ? HessianMode::gauss_newton
                         : HessianMode::projected_full;
  out.ccd_park = section.value("ccd_park", out.ccd_park);
}

/// Default tolerance: 1e-4 d_hat, and never more than a tenth of the fall in one step from rest (the bound
/// that check_contradictions holds a given tolerance to).
double default_tolerance(const RunConfig& config) {
  const double dt = config.time.dt, fall = 0.5 * config.scene.gravity.norm() * dt * dt;
  const double length = 1e-4 * config.formulation.d_hat;
  return (fall > 0 && config.integrator != "quasi_static" ? std::min(length, 0.1 * fall) : length) / dt;
}

void read_step_solver(const json& section, const Reader& reader, bool literal, RunConfig& config) {
  StepSolverConfig& out = config.step_solver;
  out.name = read_name(section, literal ? "article_literal" : "line_search", step_solver_names,
                       "/step_solver/name", reader);
  out.max_iterations = section.value("max_iterations", out.max_iterations);
  out.tol_velocity = section.value("tol_velocity_m_per_s", default_tolerance(config));
  out.armijo = section.value("armijo", out.armijo);
  out.cap_fraction = section.value("cap_fraction", out.cap_fraction);
  out.target_toi = section.value("target_toi", out.target_toi);
  out.min_newton_steps = section.value("min_newton_steps", out.min_newton_steps);
}

void read_linear_solver(const json& section, const Reader& reader, LinearOptions& out) {
  out.name = read_name(section, out.name, linear_solver_names, "/linear_solver/name", reader);
  out.preconditioner = section.value("preconditioner", out.preconditioner);
  out.tol_rel = section.value("tol_rel", out.tol_rel);
  out.max_iterations = section.value("max_iterations", out.max_iterations);
}

void read_diagnose(const json& section, DiagnoseConfig& out) {
  out.tier = section.value("tier", out.tier);
  if (section.contains("scalings")) {
    out.scalings.clear();
    for (const std::string name : section["scalings"]) {
      out.scalings.push_back(name == "none"     ? Scaling::none
                             : name == "jacobi" ? Scaling::jacobi
                                                : Scaling::block_jacobi);
    }
  }
  out.every = section.value("every", out.every);
  out.stages = section.value("stages", out.stages);
  out.seed = section.value("seed", out.seed);
  out.pcg = section.value("pcg", out.pcg);
  out.budget = section.value("budget_s", out.budget);
}

}  // namespace

void read_pipeline(const json& document, const Reader& reader, const SceneDefaults& defaults, bool literal,
                   RunConfig& config) {
  read_contact(child(document, "contact"), config.contact);
  config.integrator = read_name(child(document, "integrator"), config.integrator, entry_names(integrators()),
                                "/integrator/name", reader);
  const json& time = child(document, "time");
  config.time.dt = time.value("dt_s", defaults.dt);
  config.time.steps = time.value("steps", defaults.steps);
  read_step_solver(child(document, "step_solver"), reader, literal, config);
  read_linear_solver(child(document, "linear_solver"), reader, config.linear_solver);
  config.precision = document.value("precision", config.precision);
  const json& passes = child(document, "passes");
  config.passes.time = passes.value("time", config.passes.time);
  config.passes.diagnose = passes.value("diagnose", config.passes.diagnose);
  config.passes.audit = passes.value("audit", config.passes.audit);
  read_diagnose(child(document, "diagnose"), config.diagnose);
  const json& seeds = child(document, "seeds");
  config.seeds.main = seeds.value("main", config.seeds.main);
  config.seeds.jitter = seeds.value("jitter_m", config.seeds.jitter);
  const json& output = child(document, "output");
  config.output.frames_every = output.value("frames_every", config.output.frames_every);
  config.output.matrices = output.value("matrices", config.output.matrices);
  config.threads = document.value("threads", config.threads);
}

}  // namespace bb
