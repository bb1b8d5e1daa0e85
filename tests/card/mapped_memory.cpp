#include "tests/card/mapped_memory.hpp"

#include <cuda_runtime_api.h>

#include <new>

namespace bb::test {

void* MappedMemory::do_allocate(std::size_t bytes, std::size_t) {
  void* memory = nullptr;
  if (cudaHostAlloc(&memory, bytes, cudaHostAllocMapped) != cudaSuccess) throw std::bad_alloc();
  return memory;
}
void MappedMemory::do_deallocate(void* memory, std::size_t, std::size_t) { cudaFreeHost(memory); }

std::pmr::memory_resource& mapped_memory() {
  // Never destroyed: the driver may be gone before.
  static auto* driver = new MappedMemory;
  static auto* pieces = new std::pmr::unsynchronized_pool_resource(
      {.max_blocks_per_chunk = 64, .largest_required_pool_block = MappedMemory::chunk}, driver);
  return *pieces;
}

}  // namespace bb::test
