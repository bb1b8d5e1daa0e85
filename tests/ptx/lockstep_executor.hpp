// Runs every launch twice, compiled by g++ and as nvcc's PTX, from the same memory, and compares all memory afterwards
// (tests/resident/lockstep.hpp).
#pragma once

#include "tests/ptx/ptx_executor.hpp"
#include "tests/resident/lockstep.hpp"

namespace ptx {

class LockstepExecutor : public PtxExecutor {
 public:
  using PtxExecutor::PtxExecutor;
  /// Whether the numbers of a kernel may differ by library_tolerance, by its name.
  std::function<bool(const std::string&)> calls_a_library = bb::test::calls_a_library;

 protected:
  /// Errors: ExecutionError, also where the results differ; it names the kernel and the first number that does.
  void run(const bb::exec::KernelInfo& kernel, bb::exec::Index n, const void* f) override;
};

}  // namespace ptx
