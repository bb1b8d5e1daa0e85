// Counts the buffers of a pipeline and computes nothing: what a scene needs is known before it runs, from the code that
// would allocate it.
#pragma once

#include "core/exec/executor.hpp"

namespace bb::exec {

/// Buffers have a size and no memory; a launch, a copy or an upload does nothing. Nothing can be read.
class CountingExecutor final : public Executor {
 public:
  std::string_view name() const override { return "counting"; }
  void sort(Key*, std::uint32_t*, Index, int) override {}
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
  bool counts_only() const override { return true; }

 protected:
  void launch(const KernelInfo&, Index, const void*) override {}
  void* allocate_bytes(std::size_t) override { return nullptr; }
  void release_bytes(void*) override {}
};

}  // namespace bb::exec
