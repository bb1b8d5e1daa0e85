// What a step solver promises: of the overlap with obstacles, and of motions.
#pragma once

#include "experiments/config/run_config.hpp"

namespace bb {

/// By how much (m) surfaces may be in obstacles at the end of a step that converges, as its step solver promises; 0: nothing is promised but
/// that they are not. Errors: ConfigError for a parameter of the step solver that is wrong.
double promised_overlap(const RunConfig& config);

/// Whether no motion of an iteration goes beyond the step bound. Errors: as above.
bool bounds_motions(const RunConfig& config);

}  // namespace bb
