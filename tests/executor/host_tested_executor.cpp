// Of the tests on the host: a HostExecutor and no more.
#include "tests/executor/tested_executor.hpp"

namespace bb::test {

struct TestedExecutor::Device {};

TestedExecutor::TestedExecutor() = default;
TestedExecutor::TestedExecutor(exec::Order order, unsigned seed) : HostExecutor(order, seed) {}
TestedExecutor::~TestedExecutor() = default;

void TestedExecutor::run(const exec::KernelInfo& kernel, exec::Index n, const void* f) {
  HostExecutor::run(kernel, n, f);
}
void* TestedExecutor::allocate_bytes(std::size_t bytes) { return HostExecutor::allocate_bytes(bytes); }
void TestedExecutor::release_bytes(void* memory) { HostExecutor::release_bytes(memory); }

}  // namespace bb::test
