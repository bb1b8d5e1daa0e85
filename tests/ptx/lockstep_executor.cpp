#include "tests/ptx/lockstep_executor.hpp"

namespace ptx {

void LockstepExecutor::run(const bb::exec::KernelInfo& kernel, bb::exec::Index n, const void* f) {
  const std::string name = kernel.name();
  const std::string found = bb::test::difference(
      allocations(), calls_a_library(name) ? bb::test::library_tolerance : 0.0,
      [&] { HostExecutor::run(kernel, n, f); }, [&] { PtxExecutor::run(kernel, n, f); });
  if (!found.empty()) throw bb::exec::ExecutionError(name + ": " + found);
}

}  // namespace ptx
