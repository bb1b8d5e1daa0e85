// What a summary reports of the steps of a run.
#pragma once

#include "core/base/record/run_record.hpp"

namespace bb {

/// Sums, extremes and order statistics of record.steps into record.summary. counters: those of its step solver.
void summarize_steps(const std::vector<SolverCounter>& counters, RunRecord& record);

}  // namespace bb
