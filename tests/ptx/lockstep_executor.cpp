#include "tests/ptx/lockstep_executor.hpp"

namespace ptx {

void LockstepExecutor::run(const bb::exec::KernelInfo& kernel, bb::exec::Index n, const void* f) {
  const std::string name = kernel.name();
  const std::string found = bb::test::difference(
      allocations(), [&] { HostExecutor::run(kernel, n, f); }, [&] { PtxExecutor::run(kernel, n, f); });
  if (!found.empty()) throw bb::exec::ExecutionError(name + ": " + found);
}

}  // namespace ptx
