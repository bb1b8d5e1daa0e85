// A host executor that counts what a card would be slow at: launches, copies that the host waits for, allocations.
#pragma once

#include <map>
#include <string>

#include "core/exec/host_executor.hpp"

namespace bb::exec {

/// What was required of an executor. Launches of a graph are counted apart, and by kernel all together.
struct ExecutionCounts {
  struct Launches {
    Index launches = 0, items = 0;
  };
  Index launches = 0, replayed = 0, graphs = 0, sorts = 0, scans = 0;
  Index downloads = 0, uploads = 0, allocations = 0;
  std::map<std::string, Launches> by_kernel;  // as C++ writes its name

  /// Copies between host and executor: a card's host stands still meanwhile.
  Index waits() const { return downloads + uploads; }
  /// Items of all kernels whose name has this part.
  Index items(const std::string& part) const {
    Index out = 0;
    for (const auto& [name, of] : by_kernel) out += name.find(part) != std::string::npos ? of.items : 0;
    return out;
  }
};

class MeteredExecutor final : public HostExecutor {
 public:
  using HostExecutor::HostExecutor;
  const ExecutionCounts& counts() const { return counts_; }
  void clear() { counts_ = {}; }

  void sort(Key* keys, std::uint32_t* values, Index n, int bits) override {
    ++counts_.sorts;
    HostExecutor::sort(keys, values, n, bits);
  }
  void exclusive_scan(Index* values, Index n) override {
    ++counts_.scans;
    HostExecutor::exclusive_scan(values, n);
  }
  void replay(const LaunchGraph& graph) override {
    ++counts_.graphs;
    replaying_ = true;
    HostExecutor::replay(graph);
    replaying_ = false;
  }
  void upload(void* to, const void* from, std::size_t bytes) override {
    ++counts_.uploads;
    HostExecutor::upload(to, from, bytes);
  }
  void download(void* to, const void* from, std::size_t bytes) override {
    ++counts_.downloads;
    HostExecutor::download(to, from, bytes);
  }

 protected:
  void* allocate_bytes(std::size_t bytes) override {
    counts_.allocations += bytes > 0 ? 1 : 0;
    return HostExecutor::allocate_bytes(bytes);
  }
  void run(const KernelInfo& kernel, Index n, const void* f) override {
    ++(replaying_ ? counts_.replayed : counts_.launches);
    ExecutionCounts::Launches& of = counts_.by_kernel[kernel.name()];
    ++of.launches;
    of.items += n;
    HostExecutor::run(kernel, n, f);
  }

 private:
  ExecutionCounts counts_;
  bool replaying_ = false;
};

}  // namespace bb::exec
