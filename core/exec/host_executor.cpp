#include "core/exec/host_executor.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>

namespace bb::exec {

template <class T>
void make_order(Order order, Index n, std::mt19937_64& random, std::vector<T>& out) {
  out.resize(static_cast<std::size_t>(n));
  std::iota(out.begin(), out.end(), T{0});
  if (order == Order::reverse) std::reverse(out.begin(), out.end());
  if (order == Order::shuffled) std::shuffle(out.begin(), out.end(), random);
}
template void make_order(Order, Index, std::mt19937_64&, std::vector<int>&);
template void make_order(Order, Index, std::mt19937_64&, std::vector<Index>&);

void HostExecutor::launch(const KernelInfo& kernel, Index n, const void* f) {
  if (capture_) return capture_->add(kernel, n, f);
  run(kernel, n, f);
}

// On threads a launch of few items runs at once: one that is small costs less than to hand it out. Ranges begin at multiples of
// the lanes, so that the last one alone has items that are taken one by one.
void HostExecutor::run(const KernelInfo& kernel, Index n, const void* f) {
  if (order_ == Order::threads) {
    if (n <= kernel.grain) return kernel.run(f, nullptr, 0, n, nullptr);
    const Index lanes = kernel.lanes, groups = (n + lanes - 1) / lanes;
    tbb::parallel_for(tbb::blocked_range<Index>(0, groups, static_cast<std::size_t>(kernel.grain / lanes)),
                      [&](const auto& range) {
                        kernel.run(f, nullptr, lanes * range.begin(), std::min(lanes * range.end(), n),
                                   nullptr);
                      });
    return;
  }
  std::vector<int> threads;
  make_order(order_, block_threads, random_, threads);
  make_order(order_, n, random_, items_);
  kernel.run(f, items_.data(), 0, n, threads.data());
}

void HostExecutor::replay(const LaunchGraph& graph) {
  dynamic_cast<const RecordedGraph&>(graph).for_each(
      [this](const KernelInfo& kernel, Index n, const void* f) { run(kernel, n, f); });
}

// Least significant digit first, 11 bits a pass.
void HostExecutor::sort(Key* keys, std::uint32_t* values, Index n, int bits) {
  constexpr int digit = 11;
  const auto size = static_cast<std::size_t>(n);
  sorted_keys_.resize(size);
  if (values) sorted_values_.resize(size);
  for (int shift = 0; shift < bits; shift += digit) {
    const Key mask = (Key{1} << std::min(digit, bits - shift)) - 1;
    place_.assign(static_cast<std::size_t>(mask) + 1, 0);
    for (std::size_t i = 0; i < size; ++i) ++place_[keys[i] >> shift & mask];
    std::exclusive_scan(place_.begin(), place_.end(), place_.begin(), std::uint32_t{0});
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t to = place_[keys[i] >> shift & mask]++;
      sorted_keys_[to] = keys[i];
      if (values) sorted_values_[to] = values[i];
    }
    std::copy_n(sorted_keys_.data(), size, keys);
    if (values) std::copy_n(sorted_values_.data(), size, values);
  }
}

void HostExecutor::exclusive_scan(Index* values, Index n) {
  std::exclusive_scan(values, values + n, values, Index{0});
}

// Fresh memory holds NaN: what a kernel reads before it was written shows.
void* HostExecutor::allocate_bytes(std::size_t bytes) {
  void* memory = bytes == 0 ? nullptr : std::malloc(bytes);
  if (memory) memset(memory, 0xff, bytes);
  return memory;
}
void HostExecutor::release_bytes(void* memory) { std::free(memory); }
void HostExecutor::copy(void* to, const void* from, std::size_t bytes) {
  if (bytes > 0) memmove(to, from, bytes);
}
void HostExecutor::fill_bytes(void* to, unsigned char byte, std::size_t bytes) {
  if (bytes > 0) memset(to, byte, bytes);
}

}  // namespace bb::exec
