#include "core/exec/cuda/device_executor.hpp"

#include <cuda_runtime_api.h>

#include <algorithm>

#include "core/exec/cuda/block_size.hpp"
#include "core/exec/cuda/device.hpp"
#include "core/exec/cuda/kernel_table.hpp"
#include "core/exec/cuda/loaded_code.hpp"

namespace bb::cuda {

using exec::ExecutionError;
using exec::Index;

constexpr std::size_t remembered = 8;  // kernels that a message names
const std::string local_memory = "local memory of kernels";

KernelTable& kernel_table() {
  static KernelTable table = [] {
    KernelTable all;
    add_kernels_of_modules(all);
    return all;
  }();
  return table;
}

namespace {

/// All 0 where it cannot be queried.
cudaFuncAttributes attributes_of(const DeviceKernel& kernel) {
  cudaFuncAttributes of{};
  if (cudaFuncGetAttributes(&of, kernel.function) == cudaSuccess) return of;
  cudaGetLastError();  // the launch reports what is wrong
  return {};
}

/// Bytes of the card that a kernel's local memory takes; 0 where it cannot be queried.
std::size_t local_memory_of(const cudaFuncAttributes& of) {
  int processors = 0, threads = 0;
  if (cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, 0) != cudaSuccess ||
      cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerMultiProcessor, 0) != cudaSuccess) {
    cudaGetLastError();  // the launch reports what is wrong
    return 0;
  }
  return of.localSizeBytes * static_cast<std::size_t>(processors) * static_cast<std::size_t>(threads);
}

}  // namespace

std::size_t local_memory_of_kernels() {
  std::size_t most = 0;
  kernel_table().for_each(
      [&](const DeviceKernel& kernel) { most = std::max(most, local_memory_of(attributes_of(kernel))); });
  return most;
}

class DeviceExecutor::Graph final : public exec::LaunchGraph {
 public:
  Graph(cudaGraphExec_t graph, std::vector<const exec::KernelInfo*> launched)
      : executable(graph), kernels(std::move(launched)) {}
  ~Graph() override { cudaGraphExecDestroy(executable); }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;
  std::size_t size() const override { return kernels.size(); }

  cudaGraphExec_t executable;
  std::vector<const exec::KernelInfo*> kernels;
};

DeviceExecutor::DeviceExecutor(Index scan_part)
    : scan_part_(scan_part),
      other_keys_(*this, "sort scratch"),
      other_values_(*this, "sort scratch"),
      scratch_(*this, "sort scratch") {
  check(cudaStreamCreate(&stream_), "cudaStreamCreate");
}

DeviceExecutor::~DeviceExecutor() {
  cudaStreamSynchronize(stream_);
  cudaStreamDestroy(stream_);
}

void DeviceExecutor::check(int code, const std::string& what) const {
  if (code == cudaSuccess) return;
  std::string text = what + ": " + cudaGetErrorString(static_cast<cudaError_t>(code)) + " (CUDA error " +
                     std::to_string(code) + ")";
  if (!unfinished_.empty()) {
    text += "; launched before it, the latest first:";
    for (const exec::KernelInfo* kernel : unfinished_) text += " " + kernel->name();
    text += " (with CUDA_LAUNCH_BLOCKING=1 in the environment the message begins with the one that failed)";
  }
  throw ExecutionError(text);
}

void DeviceExecutor::wait(const std::string& what) {
  check(cudaStreamSynchronize(stream_), what);
  unfinished_.clear();
}

void DeviceExecutor::remember(const exec::KernelInfo& kernel) {
  if (!unfinished_.empty() && unfinished_.front() == &kernel) return;
  unfinished_.push_front(&kernel);
  if (unfinished_.size() > remembered) unfinished_.pop_back();
}

// --- launches

const DeviceKernel& DeviceExecutor::device_kernel(const exec::KernelInfo& kernel) {
  if (kernel.code) {
    std::shared_ptr<const DeviceKernel>& loaded = loaded_[kernel.code];
    if (!loaded) loaded = load_code(kernel);
    return *loaded;
  }
  const DeviceKernel* found = kernel_table().find(kernel.type);
  if (!found) {
    throw ExecutionError(kernel.name() + ": no device version; is it in kernels.inc of its module?");
  }
  if (found->bytes != kernel.bytes) {
    throw ExecutionError(kernel.name() + ": " + std::to_string(kernel.bytes) + " bytes on the host, " +
                         std::to_string(found->bytes) + " on the device");
  }
  return *found;
}

void DeviceExecutor::launch(const exec::KernelInfo& kernel, Index n, const void* f) {
  const DeviceKernel& found = device_kernel(kernel);
  const int threads = threads_of(found, kernel);
  const auto call = [&] {
    const int code = cuda::launch(found, f, n, threads, stream_);
    if (code == cudaSuccess) return;
    if (code == cudaErrorMemoryAllocation) refuse_local_memory(kernel);
    check(code, kernel.name() + " (" + std::to_string(n) + (kernel.blocks ? " blocks)" : ")"));
  };
  if (recording_) return recording_->add(kernel, n, f);
  if (capturing_) {
    captured_.push_back(&kernel);
    return call();
  }
  if (timed_) {
    timed(kernel, call);
  } else {
    call();
  }
  remember(kernel);
}

/// Threads of a block of a kernel. Code that was loaded counts in blocks of block_threads. From its first launch on the
/// driver keeps the local memory of the kernel that needs the most, for as many threads as the card holds at a time.
int DeviceExecutor::threads_of(const DeviceKernel& found, const exec::KernelInfo& kernel) {
  const auto known = threads_.find(&found);
  if (known != threads_.end()) return known->second;
  const cudaFuncAttributes of = attributes_of(found);
  const std::size_t bytes = local_memory_of(of);
  if (bytes > local_bytes_) {
    count_memory(local_memory, bytes - local_bytes_);
    local_bytes_ = bytes;
  }
  const bool fixed = found.blocks || kernel.code;
  return threads_[&found] = fixed ? exec::block_threads : threads_of_block(of.numRegs);
}

void DeviceExecutor::refuse_local_memory(const exec::KernelInfo& kernel) const {
  throw exec::OutOfMemory(memory().refusal(local_memory, local_bytes_) + "; " + kernel.name() +
                          " cannot be launched; " + memory_state());
}

void DeviceExecutor::timed(const exec::KernelInfo& kernel, const std::function<void()>& call) {
  cudaEvent_t begin = nullptr, end = nullptr;
  check(cudaEventCreate(&begin), "cudaEventCreate");
  check(cudaEventCreate(&end), "cudaEventCreate");
  check(cudaEventRecord(begin, stream_), "cudaEventRecord");
  call();
  check(cudaEventRecord(end, stream_), "cudaEventRecord");
  wait(kernel.name());
  float milliseconds = 0;
  check(cudaEventElapsedTime(&milliseconds, begin, end), "cudaEventElapsedTime");
  cudaEventDestroy(begin), cudaEventDestroy(end);
  KernelTime& time = times_[kernel.name()];
  ++time.launches;
  time.seconds += 1e-3 * static_cast<double>(milliseconds);
}

// --- graphs

void DeviceExecutor::begin_capture() {
  captured_.clear();
  if (timed_) {
    recording_ = std::make_unique<exec::RecordedGraph>();
    return;
  }
  check(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
  capturing_ = true;
}

std::unique_ptr<exec::LaunchGraph> DeviceExecutor::end_capture() {
  if (recording_) return std::move(recording_);
  capturing_ = false;
  cudaGraph_t graph = nullptr;
  check(cudaStreamEndCapture(stream_, &graph), "cudaStreamEndCapture");
  std::size_t nodes = 0;
  cudaGraphExec_t executable = nullptr;
  int code = cudaGraphGetNodes(graph, nullptr, &nodes);
  if (code == cudaSuccess && nodes == captured_.size()) code = cudaGraphInstantiate(&executable, graph, 0);
  cudaGraphDestroy(graph);
  check(code, "the graph of " + std::to_string(captured_.size()) + " kernels");
  if (nodes != captured_.size()) {
    throw ExecutionError("a graph has " + std::to_string(nodes) + " nodes instead of " +
                         std::to_string(captured_.size()) + " kernels");
  }
  return std::make_unique<Graph>(executable, std::move(captured_));
}

void DeviceExecutor::replay(const exec::LaunchGraph& graph) {
  if (const auto* recorded = dynamic_cast<const exec::RecordedGraph*>(&graph)) {
    recorded->for_each(
        [this](const exec::KernelInfo& kernel, Index n, const void* f) { launch(kernel, n, f); });
    return;
  }
  const Graph& own = dynamic_cast<const Graph&>(graph);
  for (const exec::KernelInfo* kernel : own.kernels) remember(*kernel);
  check(cudaGraphLaunch(own.executable, stream_), "cudaGraphLaunch");
}

void DeviceExecutor::synchronize() { wait("waiting for the card"); }

// --- memory

void DeviceExecutor::trim() {
  wait("waiting for the card");
  other_keys_.free(), other_values_.free(), scratch_.free();
}

void DeviceExecutor::upload(void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream_), "a copy to the card");
  wait("a copy to the card");
}
void DeviceExecutor::download(void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream_), "a copy from the card");
  wait("a copy from the card");
}
void DeviceExecutor::copy(void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream_), "a copy on the card");
}
void DeviceExecutor::fill_bytes(void* to, unsigned char byte, std::size_t bytes) {
  if (bytes == 0) return;
  check(cudaMemsetAsync(to, byte, bytes, stream_), "a fill on the card");
}

void* DeviceExecutor::allocate_bytes(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  const cudaError_t code = cudaMalloc(&memory, bytes);
  if (code == cudaErrorMemoryAllocation) {
    cudaGetLastError();  // it is reported here; the next launch shall not report it
    return nullptr;
  }
  check(code, "cudaMalloc");
  return memory;
}
// An error here is one of a kernel before it, which the next call reports.
void DeviceExecutor::release_bytes(void* memory) { cudaFree(memory); }

std::string DeviceExecutor::memory_state() const {
  std::size_t free = 0, total = 0;
  if (cudaMemGetInfo(&free, &total) != cudaSuccess) return "";
  return exec::bytes_text(free) + " of " + exec::bytes_text(total) + " free on the card";
}

// --- algorithms of the library

void DeviceExecutor::sort(exec::Key* keys, std::uint32_t* values, Index n, int bits) {
  if (n < 2 || bits == 0) return;
  other_keys_.grow(n);
  if (values) other_values_.grow(n);
  TwoArrays<exec::Key> k{{keys, other_keys_.data()}};
  TwoArrays<std::uint32_t> v{{values, values ? other_values_.data() : nullptr}};
  std::size_t bytes = 0;
  check(sort_by_key(nullptr, bytes, k, v, n, bits, stream_), "sort");
  scratch_.grow(static_cast<Index>(bytes));
  check(sort_by_key(scratch_.data(), bytes, k, v, n, bits, stream_), "sort");
  if (k.current == 1) copy(keys, k.array[1], static_cast<std::size_t>(n) * sizeof(exec::Key));
  if (values && v.current == 1) copy(values, v.array[1], static_cast<std::size_t>(n) * sizeof(std::uint32_t));
}

// In parts that the library can count; the sum so far goes to the next part by the host.
void DeviceExecutor::exclusive_scan(Index* values, Index n) {
  Index sum = 0;
  for (Index begin = 0; begin < n; begin += scan_part_) {
    const int part = static_cast<int>(std::min(scan_part_, n - begin));
    const bool last = begin + part == n;
    Index end[2] = {};  // the last value of the part, and what is before it
    if (!last) download(&end[0], values + begin + part - 1, sizeof(Index));
    std::size_t bytes = 0;
    check(scan_exclusive(nullptr, bytes, values + begin, part, sum, stream_), "scan");
    scratch_.grow(static_cast<Index>(bytes));
    check(scan_exclusive(scratch_.data(), bytes, values + begin, part, sum, stream_), "scan");
    if (last) return;
    download(&end[1], values + begin + part - 1, sizeof(Index));
    sum = end[0] + end[1];
  }
}

}  // namespace bb::cuda
