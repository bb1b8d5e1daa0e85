// Matching (DESIGN section 2.1): the pilot run with the log barrier, and what each rule makes of its loads.
#pragma once

#include "core/record/run_record.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/runner.hpp"

namespace bb {

/// Runs the pilot when the rule needs a load that the config does not give, and returns the calibration of
/// this config. `record` gets every number that went into it. Pilots are kept by config id for the life of
/// the process, so that the formulations of a sweep share one. Where the pilot met no contact (or no active
/// limit) the static weight stands in, and the record says so. Errors: ConfigError when a load is needed and
/// the scene has no weight; Interrupted.
Calibration calibrate(const RunConfig& config, const Scene& scene, const RunOptions& options,
                      MatchingRecord& record);

}  // namespace bb
