// Where kernels run and where their data lives: the one interface between what is launched and threads or a
// device. Launches are in order; a call that returns numbers to the host waits for all before it. Library algorithms
// (sort, scan) see integers only, so that their results are unique.
#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/exec/kernel_info.hpp"
#include "core/exec/memory_ledger.hpp"

namespace bb::exec {

/// A kernel, a copy or the device itself failed. what() names the kernel.
struct ExecutionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Launches that were captured, to be replayed with the same arguments.
class LaunchGraph {
 public:
  virtual ~LaunchGraph() = default;
  /// Kernels in it.
  virtual std::size_t size() const = 0;
};

class Board;

class Executor {
 public:
  virtual ~Executor() = default;
  virtual std::string_view name() const = 0;

  /// Runs f(i) for i in [0, n).
  template <class F>
  void each(Index n, const F& f) {
    if (n > 0) launch(each_info<F>(), n, &f);
  }
  /// The same of a kernel whose device code came after the program was built. info: of F, there as long as the executor.
  template <class F>
  void each(Index n, const F& f, const KernelInfo& info) {
    if (n > 0) launch(info, n, &f);
  }
  /// Loads the device code of a kernel that brings some. Errors: ExecutionError.
  virtual void prepare(const KernelInfo&) {}
  /// Runs n blocks of f.
  template <class F>
  void blocks(Index n, const F& f) {
    if (n > 0) launch(blocks_info<F>(), n, &f);
  }

  /// Sorts keys [n] by their lowest `bits` bits, ascending and stable; values [n], or null, travel along.
  virtual void sort(Key* keys, std::uint32_t* values, Index n, int bits) = 0;
  /// values[i] = sum of values[0, i), in place.
  virtual void exclusive_scan(Index* values, Index n) = 0;

  /// Between the two calls launches are kept and not run; nothing else may be called. The arguments are those of the
  /// capture: a graph is void once one of its buffers was resized.
  virtual void begin_capture() = 0;
  virtual std::unique_ptr<LaunchGraph> end_capture() = 0;
  virtual void replay(const LaunchGraph& graph) = 0;
  /// Waits for everything. Errors: ExecutionError.
  virtual void synchronize() = 0;

  // --- memory; use Buffer (buffer.hpp)
  const MemoryLedger& memory() const { return ledger_; }
  void limit_memory(std::size_t bytes) { ledger_.set_limit(bytes); }
  /// Errors: OutOfMemory, with the name of the buffer.
  void* allocate(const std::string& name, std::size_t bytes);
  void release(const std::string& name, void* memory, std::size_t bytes);
  virtual void upload(void* to, const void* from, std::size_t bytes) = 0;
  virtual void download(void* to, const void* from, std::size_t bytes) = 0;
  virtual void copy(void* to, const void* from, std::size_t bytes) = 0;
  /// Every byte of a region.
  virtual void fill_bytes(void* to, unsigned char byte, std::size_t bytes) = 0;
  /// Gives back what sorts and scans keep for the next one.
  virtual void trim() {}
  /// What is free of the memory that the executor works in, in words; empty where it is not queried.
  virtual std::string memory_state() const { return ""; }
  /// True when nothing is computed and nothing may be read: buffers are counted only.
  virtual bool counts_only() const { return false; }
  /// Whether the host reads and writes the memory of buffers in place.
  virtual bool in_host_memory() const { return false; }

 protected:
  virtual void launch(const KernelInfo& kernel, Index n, const void* f) = 0;
  /// Memory that is taken and no buffer: from now on of `name`. Errors: OutOfMemory when the limit is passed.
  void count_memory(const std::string& name, std::size_t bytes) { ledger_.add(name, bytes); }
  /// Null when memory runs out.
  virtual void* allocate_bytes(std::size_t bytes) = 0;
  virtual void release_bytes(void* memory) = 0;

 private:
  friend class Board;
  MemoryLedger ledger_;
  std::weak_ptr<Board> board_;
};

/// Launches kept as their bytes: the graph of executors without a device.
class RecordedGraph final : public LaunchGraph {
 public:
  void add(const KernelInfo& kernel, Index n, const void* f);
  std::size_t size() const override { return launches_.size(); }
  /// call(kernel, n, f) in order.
  template <class Call>
  void for_each(const Call& call) const {
    for (const Launch& l : launches_) call(*l.kernel, l.n, l.bytes.get());
  }

 private:
  struct Launch {
    const KernelInfo* kernel;
    Index n;
    std::unique_ptr<std::max_align_t[]> bytes;
  };
  std::vector<Launch> launches_;
};

}  // namespace bb::exec
