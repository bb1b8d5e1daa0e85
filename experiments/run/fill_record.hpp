// What a record reports of a run beside its steps: labels, sizes, plan, matching, times. Whole runs (runner.cpp, passes.cpp) and
// runs by single steps (stepped_run.cpp) fill it alike.
#pragma once

#include <optional>
#include <string>

#include "core/base/record/run_record.hpp"
#include "core/terms/plan.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/outcome.hpp"
#include "experiments/run/pass.hpp"
#include "experiments/run/runner.hpp"

namespace bb {

void fill_labels(const RunConfig& config, const RunOptions& options, RunRecord& record);
/// Before the first step: the file of the method may be edited while a run goes on.
void fill_method(const RunConfig& config, RunRecord& record);
void fill_scene(const Scene& scene, RunRecord& record);
void fill_plan(const RunConfig& config, const Plan& plan, RunRecord& record);

/// The stiffness of this run by its matching rule, or why there is no first step: only the scene or its calibration run shows that it
/// cannot be matched, and the time limit may come before the answer. Errors: Interrupted.
std::optional<Verdict> find_stiffness(const RunConfig& config, const Scene& scene, const RunOptions& options,
                                      MatchingRecord& record, Calibration& out);

/// Times of the pass that was timed; a step that it did not reach has none. A build that is not valid shows none.
/// requested: whether the config requests times.
void fill_times(const PassResult& timed, bool requested, RunRecord& record);
void fill_stiffness(const PassResult& pass, RunRecord& record);

/// The outcome that stays of two, with its detail. A run that was cut off stays one, whatever the audit has found so far: its
/// detail reports it, and the whole run will have that outcome.
void merge(Verdict& verdict, Outcome outcome, const std::string& detail);

}  // namespace bb
