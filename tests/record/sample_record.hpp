// A record and a trace row with something in every section.
#pragma once

#include "core/record/run_record.hpp"

namespace bb::test {

inline TraceRow sample_trace_row() {
  TraceRow row;
  row.step = 3;
  row.iteration = 2;
  row.t_s = 0.04;
  row.energy_J = -1.5;
  row.alpha = 0.5;
  row.contacts.edge_edge = 2;
  row.contacts.obstacle = 3;
  row.gap_min_iterates_m = 1e-3;
  ConditionSample raw;
  raw.estimate = {};
  raw.estimate.lambda_min = 2;
  raw.estimate.lambda_max = 8;
  raw.estimate.cond = 4;
  raw.estimate.method = "dense";
  ConditionSample scaled = raw;
  scaled.stage = MatrixStage::no_contact;
  scaled.scaling = Scaling::block_jacobi;
  row.cond = {raw, scaled};
  row.time[Phase::linear_factor] = 0.25;
  return row;
}

inline RunRecord sample_record() {
  RunRecord r;
  r.ids.config_id = r.ids.run_id = r.ids.build_id = r.ids.machine_id = std::string(64, 'a');
  r.ids.parent_ids = {std::string(64, 'b')};
  r.status = {Outcome::newton_stall, "step 1 ended at its cap", 0, "2024-01-31T12:00:00Z",
              "2024-01-31T12:00:05Z"};
  r.labels.scene = "hang";
  r.labels.formulation = "log";
  r.labels.d_hat_m = 0.01;
  r.labels.dt_s = 0.01;
  r.passes.diagnose = true;
  r.config_json = R"({"time": {"dt_s": 0.01}, "scene": "hang"})";
  r.scene.mesh_sha256 = {{"a.obj", std::string(64, 'c')}};
  r.provenance.plugins = {{"an example", "../p.so", std::string(64, 'f')}};
  r.ids.rerun_of = std::string(64, 'b');
  r.plan = {{"contact", false, "no collision surface"}};
  r.skipped = {{"cond", "budget"}};
  r.matching.rule = "equal_force";
  r.matching.load_N = 0.3;
  StepRecord step;
  step.gap_min_m = 1.25e-3;
  step.gap_min_iterates_m = 1e-3;
  step.newton_iterations = 4;
  step.status = "max_iterations";
  step.time[Phase::linear_factor] = 0.5;
  r.steps = {step};
  r.summary.newton_per_step = summarize({4});
  r.summary.cond["full/block_jacobi"].log10_cond = summarize({1, 2});
  r.summary.cond["full/block_jacobi"].statuses["ok"] = 2;
  r.summary.state_hash = std::string(64, 'd');
  r.samples["total_s"] = {1.5, 1.25};
  r.audit.judged = 12;
  r.audit.examples = {"edge 1 2 through triangle 3 4 5"};
  r.comparability.verdict = "not_valid";
  r.comparability.reason = "the run is not valid: its outcome is newton_stall";
  r.validity.checks = {{"steps_capped", 1, 0, false}};
  r.artifacts = {{"trace.jsonl", "trace", "application/x-ndjson", std::string(64, 'e'), 12}};
  return r;
}

}  // namespace bb::test
