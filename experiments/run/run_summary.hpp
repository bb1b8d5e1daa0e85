// What a summary says of the steps of a run.
#pragma once

#include "core/record/run_record.hpp"

namespace bb {

/// Sums, extremes and order statistics of record.steps into record.summary.
void summarize_steps(RunRecord& record);

}  // namespace bb
