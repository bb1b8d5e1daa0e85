// Kernels on a card, in one stream. No CUDA header, so that C++ files can use it.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <unordered_map>

#include "core/exec/buffer.hpp"
#include "core/exec/cuda/library.hpp"

namespace bb::cuda {

struct DeviceKernel;

/// Time of the launches of a kernel (profile()).
struct KernelTime {
  exec::Index launches = 0;
  double seconds = 0;
};

/// Errors of every call: ExecutionError, with the kernels that were launched since the last synchronisation, for a card
/// reports what a kernel did wrong later. Not for two threads at a time.
class DeviceExecutor : public exec::Executor {
 public:
  /// On the current device. scan_part: the longest scan in one call of the library.
  explicit DeviceExecutor(exec::Index scan_part = exec::Index{1} << 30);
  ~DeviceExecutor() override;
  DeviceExecutor(const DeviceExecutor&) = delete;
  DeviceExecutor& operator=(const DeviceExecutor&) = delete;

  std::string_view name() const override { return "cuda"; }
  void sort(exec::Key* keys, std::uint32_t* values, exec::Index n, int bits) override;
  void exclusive_scan(exec::Index* values, exec::Index n) override;
  void prepare(const exec::KernelInfo& kernel) override { device_kernel(kernel); }
  void begin_capture() override;
  std::unique_ptr<exec::LaunchGraph> end_capture() override;
  void replay(const exec::LaunchGraph& graph) override;
  void synchronize() override;
  void trim() override;
  void upload(void* to, const void* from, std::size_t bytes) override;
  void download(void* to, const void* from, std::size_t bytes) override;
  void copy(void* to, const void* from, std::size_t bytes) override;
  void fill_bytes(void* to, unsigned char byte, std::size_t bytes) override;
  std::string memory_state() const override;

  /// From now on every launch is waited for and timed, those of graphs that are captured later too: slow.
  void time_kernels() { timed_ = true; }
  /// For libraries, whose work goes between the launches.
  CUstream_st* stream() const { return stream_; }
  /// By the name of the kernel.
  const std::map<std::string, KernelTime>& profile() const { return times_; }

 protected:
  void launch(const exec::KernelInfo& kernel, exec::Index n, const void* f) override;
  void* allocate_bytes(std::size_t bytes) override;
  void release_bytes(void* memory) override;

 private:
  class Graph;
  void check(int code, const std::string& what) const;
  void wait(const std::string& what);
  void timed(const exec::KernelInfo& kernel, const std::function<void()>& call);
  void remember(const exec::KernelInfo& kernel);
  const DeviceKernel& device_kernel(const exec::KernelInfo& kernel);
  int threads_of(const DeviceKernel& found, const exec::KernelInfo& kernel);
  [[noreturn]] void refuse_local_memory(const exec::KernelInfo& kernel) const;

  CUstream_st* stream_ = nullptr;
  bool capturing_ = false, timed_ = false;
  std::unique_ptr<exec::RecordedGraph> recording_;  // in place of a capture when launches are timed
  std::vector<const exec::KernelInfo*> captured_;
  std::deque<const exec::KernelInfo*> unfinished_;  // the last ones since the last synchronisation
  std::map<std::string, KernelTime> times_;
  std::map<const DeviceCode*, std::shared_ptr<const DeviceKernel>> loaded_;
  std::unordered_map<const DeviceKernel*, int>
      threads_;                  // of a block; of kernels whose local memory is counted
  std::size_t local_bytes_ = 0;  // of the one that needs the most
  exec::Index scan_part_;
  exec::Buffer<exec::Key> other_keys_;
  exec::Buffer<std::uint32_t> other_values_;
  exec::Buffer<unsigned char> scratch_;
};

}  // namespace bb::cuda
