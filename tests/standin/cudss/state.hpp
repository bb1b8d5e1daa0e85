// What a test sets in the stand-in for cuDSS, and what that saw. One object in the test; the library finds it there.
#pragma once

#include <cudss.h>

#include <string>

namespace standin {

struct CudssState {
  // Set before the calls that read it.
  std::string failing;  // the call of this name, or cudssExecute with this phase, returns `status`
  cudssStatus_t status = CUDSS_STATUS_EXECUTION_FAILED;
  int major = CUDSS_VERSION_MAJOR;
  std::int64_t factor_nonzeros = 1234;
  std::size_t factor_bytes = 4096;  // of device memory, for each pattern

  // Seen.
  int analyses = 0, factorizations = 0, solves = 0;
  int objects = 0;    // alive
  std::string fault;  // what was called in the wrong order, or with what; the first one
};

CudssState& cudss();

}  // namespace standin
