// Memory of the host that a card reads and writes in place, so that one pointer serves both. No CUDA header.
#pragma once

#include <memory_resource>

namespace bb::test {

/// Page-locked, mapped memory in chunks of a few megabytes. Errors: std::bad_alloc.
class MappedMemory final : public std::pmr::memory_resource {
 public:
  static constexpr std::size_t chunk = std::size_t{4} << 20;

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override;
  bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
};

/// Pieces of it for the whole process: taking memory from the driver costs far more than a small test.
std::pmr::memory_resource& mapped_memory();

}  // namespace bb::test
