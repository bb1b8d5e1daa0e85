#include "experiments/run/fill_record.hpp"

#include <fmt/format.h>

#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "core/model/bodies/part.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/methods.hpp"
#include "experiments/run/calibration.hpp"
#include "experiments/run/stored_run.hpp"

namespace bb {

void fill_labels(const RunConfig& config, const RunOptions& options, RunRecord& record) {
  Labels& labels = record.labels;
  labels.scene = config.scene.name;
  labels.formulation = label_of(config.formulation);
  labels.shape = config.formulation.shape;
  labels.argument = std::string(to_string(config.formulation.argument));
  labels.stiffness_policy = config.formulation.stiffness_policy.name;
  labels.integrator = config.integrator.name;
  labels.step_solver = config.step_solver.name;
  labels.linear_solver = config.linear_solver.name;
  labels.preconditioner = preconditioner_of({config.linear_solver.name, config.linear_solver.parameters});
  labels.precision = word_of(config.precision);
  labels.d_hat_m = config.formulation.d_hat;
  labels.dt_s = config.time.dt;
  labels.note = options.note;
  labels.swept = options.swept;
}

void fill_method(const RunConfig& config, RunRecord& record) {
  if (config.method.empty()) return;
  const MethodUse use = method_use(config);
  record.labels.method = use.title();
  record.method = {use.method.name, use.method.source, use.overridden, use.method.differs};
}

void fill_scene(const Scene& scene, RunRecord& record) {
  SceneSize& size = record.scene;
  const Eigen::Index of_bodies = scene.n_body_vertices();
  size.vertices = static_cast<std::size_t>(of_bodies);
  size.free_dofs = free_dofs(scene);
#define PART(name, term, convex, where, field, ...) size.field = parts::name::part().size(scene);
#include "core/model/scene/parts/registry.inc"
#undef PART
  size.obstacles = scene.obstacles.size();
  const auto start = scene.x0.leftCols(of_bodies);
  size.extent_m = (start.rowwise().maxCoeff() - start.rowwise().minCoeff()).maxCoeff();
}

void fill_plan(const RunConfig& config, const Plan& plan, RunRecord& record) {
  for (const auto& [name, item] : plan.items()) {
    record.plan.push_back({std::string(name), item->needed, item->reason});
  }
  if (!config.passes.time) record.skipped.push_back({"time", "not_requested"});
  if (config.passes.time && !record.validity.build.valid)
    record.skipped.push_back({"time", "build_not_valid"});
  if (!plan.conditioning.needed) record.skipped.push_back({"cond", "not_requested"});
  if (!plan.audit.needed) record.skipped.push_back({"audit", "not_requested"});
  if (!plan.trace.needed) record.skipped.push_back({"trace", "not_requested"});
}

std::optional<Verdict> find_stiffness(const RunConfig& config, const Scene& scene, const RunOptions& options,
                                      MatchingRecord& record, Calibration& out) {
  try {
    out = calibrate(config, scene, options, record);
    return std::nullopt;
  } catch (const ConfigError& error) {
    return Verdict{Outcome::invalid_scene, error.what()};
  } catch (const TimeOver& over) {
    return Verdict{Outcome::timeout, over.detail};
  }
}

void fill_times(const PassResult& timed, bool requested, RunRecord& record) {
  Summary& summary = record.summary;
  const bool shown = record.validity.build.valid;
  const Number absent = Number::missing(!requested ? "not_requested"
                                        : shown    ? "not_reached"
                                                   : "build_not_valid");
  for (std::size_t i = 0; i < record.steps.size(); ++i) {
    StepRecord& step = record.steps[i];
    step.wall_s = step.unaccounted_s = absent;
    if (!shown || i >= timed.steps.size()) continue;
    step.time = timed.steps[i].phases;
    step.wall_s = timed.steps[i].wall_s;
    step.unaccounted_s = timed.steps[i].wall_s - step.time.total_s();
  }
  summary.wall_s = summary.solve_s = summary.unaccounted_s = absent;
  if (!requested || !shown) return;
  record.samples["wall_s"] = {timed.wall_s};
  for (const PassResult::StepTime& step : timed.steps) summary.time += step.phases;
  summary.wall_s = timed.wall_s;
  summary.solve_s = summary.time.solve_s();
  summary.unaccounted_s = timed.wall_s - summary.time.total_s();
}

void merge(Verdict& verdict, Outcome outcome, const std::string& detail) {
  if (outcome == Outcome::ok && verdict.outcome == Outcome::ok) verdict.detail = detail;
  if (worse(outcome, verdict.outcome) != outcome || outcome == verdict.outcome) return;
  if (was_cut(verdict.outcome)) {
    verdict.detail += fmt::format("; {} so far: {}", to_string(outcome), detail);
  } else {
    verdict = {outcome, detail};
  }
}

void fill_stiffness(const PassResult& pass, RunRecord& record) {
  if (!(pass.stiffness.kappa > 0)) return;
  record.summary.stiffness = {pass.stiffness.kappa_start, pass.stiffness.kappa, pass.stiffness.doublings,
                              pass.stiffness.saturated};
}

}  // namespace bb
