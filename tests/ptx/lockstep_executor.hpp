// Runs every launch twice, compiled by g++ and as nvcc's PTX, from the same memory, and compares all memory afterwards:
// the tests of a pipeline, run on it, also prove that host and device agree bit for bit, launch by launch.
#pragma once

#include "tests/ptx/ptx_executor.hpp"

namespace ptx {

class LockstepExecutor : public PtxExecutor {
 public:
  using PtxExecutor::PtxExecutor;
  /// Of kernels that call a library (log, atan2): parts of their names, and what the numbers of an allocation may differ
  /// by, relative to the largest of them.
  static std::vector<std::string>& library_kernels();
  static constexpr double library_tolerance = 1e-13;

 protected:
  /// Errors: ExecutionError, also where the results differ; it names the kernel and the first number that does.
  void run(const bb::exec::KernelInfo& kernel, bb::exec::Index n, const void* f) override;
};

}  // namespace ptx
