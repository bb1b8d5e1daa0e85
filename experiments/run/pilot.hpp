// Matching (DESIGN section 2.1): the pilot run with the log barrier, and what each rule makes of its loads.
#pragma once

#include "core/record/run_record.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/method.hpp"

namespace bb {

/// Runs the pilot when the rule needs a load that the config does not give, and returns the calibration of
/// this config. `record` gets every number that went into it. Pilots are kept by config id for the life of
/// the process, so that the formulations of a sweep share one. Errors: ConfigError when a load is needed and
/// the scene gives none (no gravity, no contact in the pilot).
Calibration calibrate(const RunConfig& config, const Scene& scene, MatchingRecord& record);

}  // namespace bb
