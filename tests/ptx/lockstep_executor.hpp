// Runs every launch twice, compiled by g++ and as nvcc's PTX, from the same memory, and compares all memory afterwards
// (tests/executor/lockstep.hpp).
#pragma once

#include "tests/executor/lockstep.hpp"
#include "tests/ptx/ptx_executor.hpp"

namespace ptx {

class LockstepExecutor : public PtxExecutor {
 public:
  using PtxExecutor::PtxExecutor;

 protected:
  /// Errors: ExecutionError, also where the results differ; it names the kernel and the first number that does.
  void run(const bb::exec::KernelInfo& kernel, bb::exec::Index n, const void* f) override;
};

}  // namespace ptx
