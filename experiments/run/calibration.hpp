// Matching (docs/theory/barriers.md): from the loads of a calibration run, or from given ones, to the stiffness of
// contact and limit.
#pragma once

#include "core/base/record/run_record.hpp"
#include "experiments/run/calibration_run.hpp"

namespace bb {

/// The calibration of this config by its matching rule; the calibration run is made when the rule needs what the config
/// does not give. `record` gets every number that went into it. Where the calibration run met no contact (or no active
/// limit) with a load the static weight stands in for a fixed stiffness, and a policy that makes its own stays as given;
/// the record reports it. Errors: ConfigError when the scene has no weight, or a policy gives a contact (an
/// element) that carried a load no stiffness; Interrupted; TimeOver.
Calibration calibrate(const RunConfig& config, const Scene& scene, const RunOptions& options,
                      MatchingRecord& record);

}  // namespace bb
