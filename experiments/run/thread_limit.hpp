// The threads of a config.
#pragma once

#include <oneapi/tbb/global_control.h>

#include "experiments/config/run_config.hpp"

namespace bb {

/// Threads that the run may use.
int thread_count(const RunConfig& config);

/// The run has these threads, as long as the answer lives.
oneapi::tbb::global_control threads_of(const RunConfig& config);

}  // namespace bb
