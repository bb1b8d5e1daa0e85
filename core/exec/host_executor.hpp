// Kernels on host threads, or on one thread in a chosen order: what depends on the order changes bits then.
#pragma once

#include <random>

#include "core/exec/executor.hpp"

namespace bb::exec {

/// threads: all threads of the process, forward within a block. The others are one thread; shuffled: items, blocks
/// and threads within a block anew at every launch.
enum class Order { threads, forward, reverse, shuffled };

class HostExecutor : public Executor {
 public:
  explicit HostExecutor(Order order = Order::threads, unsigned seed = 1) : order_(order), random_(seed) {}
  std::string_view name() const override { return "host"; }
  bool in_host_memory() const override { return true; }

  void sort(Key* keys, std::uint32_t* values, Index n, int bits) override;
  void exclusive_scan(Index* values, Index n) override;
  void begin_capture() override { capture_ = std::make_unique<RecordedGraph>(); }
  std::unique_ptr<LaunchGraph> end_capture() override { return std::move(capture_); }
  void replay(const LaunchGraph& graph) override;
  void synchronize() override {}
  void upload(void* to, const void* from, std::size_t bytes) override { copy(to, from, bytes); }
  void download(void* to, const void* from, std::size_t bytes) override { copy(to, from, bytes); }
  void copy(void* to, const void* from, std::size_t bytes) override;
  void fill_bytes(void* to, unsigned char byte, std::size_t bytes) override;

 protected:
  void launch(const KernelInfo& kernel, Index n, const void* f) override;
  void* allocate_bytes(std::size_t bytes) override;
  void release_bytes(void* memory) override;
  /// Runs a launch now.
  virtual void run(const KernelInfo& kernel, Index n, const void* f);
  Order order() const { return order_; }
  std::mt19937_64& random() { return random_; }

 private:
  Order order_;
  std::mt19937_64 random_;
  std::unique_ptr<RecordedGraph> capture_;
  std::vector<Index> items_;
  std::vector<Key> sorted_keys_;
  std::vector<std::uint32_t> sorted_values_, place_;
};

/// [n] 0, 1, ... in an order; `random` is read where it is shuffled.
template <class T>
void make_order(Order order, Index n, std::mt19937_64& random, std::vector<T>& out);

}  // namespace bb::exec
