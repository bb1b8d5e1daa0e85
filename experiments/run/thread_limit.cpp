#include "experiments/run/thread_limit.hpp"

#include <oneapi/tbb/info.h>

namespace bb {

int thread_count(const RunConfig& config) {
  return config.threads > 0 ? config.threads : oneapi::tbb::info::default_concurrency();
}

oneapi::tbb::global_control threads_of(const RunConfig& config) {
  return {oneapi::tbb::global_control::max_allowed_parallelism,
          static_cast<std::size_t>(thread_count(config))};
}

}  // namespace bb
