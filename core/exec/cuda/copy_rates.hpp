// How fast an executor moves memory: what the rates of kernels are held against.
#pragma once

#include "core/exec/executor.hpp"

namespace bb::cuda {

struct CopyRates {
  std::size_t bytes = 0;  // of one copy
  double copy = 0, upload = 0,
         download = 0;  // B/s; a copy within the memory reads and writes: both are counted
};

/// Several copies of so many bytes each, within the memory after copies for `warm_s` seconds that are not counted. Errors:
/// OutOfMemory, ExecutionError.
CopyRates measure_copies(exec::Executor& executor, std::size_t bytes, double warm_s = 1);

}  // namespace bb::cuda
