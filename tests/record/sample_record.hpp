// A record of a run that stalled in its first step, and a line of its trace: what the file tests write.
#pragma once

#include "core/base/record/run_record.hpp"

namespace bb::test {

inline TraceRow sample_trace_row() {
  TraceRow row;
  row.step = 3;
  row.contacts.edge_edge = 2;
  row.cond.resize(2);
  row.cond[0].cond = Number::missing("lower_bound");
  row.time[Phase::linear_factor] = 0.25;
  return row;
}

inline RunRecord sample_record() {
  RunRecord r;
  r.status.outcome = Outcome::newton_stall;
  r.status.detail = "step 1 ended at its cap";
  r.config.text = R"({"time": {"dt_s": 0.01}, "scene": "hang"})";
  r.ids.sweep_id = "strip";
  r.provenance.plugins = {{"an example", "../p.so", std::string(64, 'f')}};
  StepRecord step;
  step.status = StepStatus::iteration_cap;
  step.gap_min_m = Number::missing("not_converged");
  step.gap_min_iterates_m = 1e-3;
  step.time[Phase::linear_factor] = 0.5;
  r.steps = {step};
  r.summary.cond["full/block_jacobi"].log10_cond = summarize({1, 2});
  r.summary.cond["full/block_jacobi"].statuses["ok"] = 2;
  r.samples["wall_s"] = {1.5, 1.25};
  return r;
}

}  // namespace bb::test
