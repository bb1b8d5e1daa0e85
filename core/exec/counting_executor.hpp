// Counts the buffers of a pipeline and computes nothing: what a scene needs is known before it runs, from the code that
// would allocate it.
#pragma once

#include <cstdint>

#include "core/exec/buffer.hpp"

namespace bb::exec {

/// Buffers have a size and no memory; a launch, a copy or an upload does nothing. Nothing can be read.
class CountingExecutor final : public Executor {
 public:
  /// sorts_apart: sorts need second arrays, as they do on a device.
  explicit CountingExecutor(bool sorts_apart = false)
      : sorts_apart_(sorts_apart), other_keys_(*this, "sort scratch"), other_values_(*this, "sort scratch") {}
  std::string_view name() const override { return "counting"; }
  void sort(Key*, std::uint32_t* values, Index n, int) override {
    if (!sorts_apart_) return;
    other_keys_.grow(n);
    if (values) other_values_.grow(n);
  }
  void exclusive_scan(Index*, Index) override {}
  void begin_capture() override {}
  std::unique_ptr<LaunchGraph> end_capture() override { return std::make_unique<RecordedGraph>(); }
  void replay(const LaunchGraph&) override {}
  void synchronize() override {}
  void upload(void*, const void*, std::size_t) override {}
  /// Errors: std::logic_error, always.
  void download(void*, const void*, std::size_t) override {
    throw std::logic_error("a counting executor has no values");
  }
  void copy(void*, const void*, std::size_t) override {}
  void fill_bytes(void*, unsigned char, std::size_t) override {}
  void trim() override { other_keys_.free(), other_values_.free(); }
  bool counts_only() const override { return true; }

 protected:
  void launch(const KernelInfo&, Index, const void*) override {}
  /// Addresses that differ; nothing is there.
  void* allocate_bytes(std::size_t bytes) override {
    if (bytes == 0) return nullptr;
    next_ += 256;
    return reinterpret_cast<void*>(next_);  // NOLINT(performance-no-int-to-ptr)
  }
  void release_bytes(void*) override {}

 private:
  bool sorts_apart_;
  std::uintptr_t next_ = 0;
  Buffer<Key> other_keys_;
  Buffer<std::uint32_t> other_values_;
};

}  // namespace bb::exec
