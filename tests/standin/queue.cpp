// Streams, events and graphs of the stand-in: queues of work.
#include <algorithm>
#include <deque>
#include <set>
#include <utility>

#include "tests/standin/cudart.hpp"

using Work = std::function<cudaError_t()>;

struct CUgraph_st {
  std::vector<Work> nodes;
};
struct CUgraphExec_st {
  std::vector<Work> nodes;
};
struct CUstream_st {};
struct CUevent_st {
  bool recorded = false;
};

namespace {

std::deque<Work>& queue() {
  static std::deque<Work> work;
  return work;
}
std::set<cudaStream_t>& streams() {
  static std::set<cudaStream_t> known;
  return known;
}
struct Capture {
  cudaStream_t stream = nullptr;
  bool active = false, spoiled = false;
  std::vector<Work> nodes;
};
Capture& capture() {
  static Capture one;
  return one;
}
cudaError_t& last_error() {
  static cudaError_t code = cudaSuccess;
  return code;
}

}  // namespace

namespace standin {

Settings& settings() {
  static Settings one;
  return one;
}
Counts& counts() {
  static Counts one;
  return one;
}
cudaError_t& broken() {
  static cudaError_t code = cudaSuccess;
  return code;
}

void reset() {
  const std::size_t in_use = counts().in_use;
  settings() = {}, counts() = {}, capture() = {};
  counts().in_use = in_use;
  broken() = last_error() = cudaSuccess;
  queue().clear();
}

bool known_stream(cudaStream_t stream) { return !stream || streams().count(stream) > 0; }
bool capturing() { return capture().active; }
cudaError_t spoil_capture() {
  capture().spoiled = true;
  return result(cudaErrorStreamCaptureUnsupported);
}

cudaError_t result(cudaError_t code) {
  if (broken() != cudaSuccess) code = broken();
  if (code != cudaSuccess) last_error() = code;
  return code;
}

cudaError_t enqueue(cudaStream_t stream, Work work) {
  if (!known_stream(stream)) return result(cudaErrorInvalidResourceHandle);
  if (capture().active && capture().stream == stream) {
    capture().nodes.push_back(std::move(work));
  } else {
    queue().push_back(std::move(work));
  }
  return result(cudaSuccess);
}

cudaError_t finish() {
  while (!queue().empty()) {
    const Work work = std::move(queue().front());
    queue().pop_front();
    if (broken() != cudaSuccess) continue;
    broken() = work();
  }
  return result(cudaSuccess);
}

}  // namespace standin

using namespace standin;

extern "C" {

cudaError_t cudaGetLastError() { return std::exchange(last_error(), broken()); }
cudaError_t cudaPeekAtLastError() { return last_error(); }

cudaError_t cudaStreamCreate(cudaStream_t* stream) {
  *stream = new CUstream_st;
  streams().insert(*stream);
  return result(cudaSuccess);
}
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  finish();
  if (streams().erase(stream) == 0) return result(cudaErrorInvalidResourceHandle);
  delete stream;
  return result(cudaSuccess);
}
cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  if (capturing()) return spoil_capture();
  ++counts().waits;
  if (!known_stream(stream)) return result(cudaErrorInvalidResourceHandle);
  return finish();
}
cudaError_t cudaDeviceSynchronize() { return cudaStreamSynchronize(nullptr); }

cudaError_t cudaEventCreate(cudaEvent_t* event) {
  *event = new CUevent_st;
  return result(cudaSuccess);
}
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  return enqueue(stream, [event] {
    event->recorded = true;
    return cudaSuccess;
  });
}
/// Time does not pass here: a millisecond between any two.
cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t begin, cudaEvent_t end) {
  *milliseconds = 1;
  return result(begin->recorded && end->recorded ? cudaSuccess : cudaErrorNotReady);
}
cudaError_t cudaEventDestroy(cudaEvent_t event) {
  delete event;
  return result(cudaSuccess);
}

cudaError_t cudaStreamBeginCapture(cudaStream_t stream, cudaStreamCaptureMode) {
  if (capturing() || !stream || !known_stream(stream)) return result(cudaErrorIllegalState);
  capture() = {};
  capture().stream = stream;
  capture().active = true;
  return result(cudaSuccess);
}
cudaError_t cudaStreamEndCapture(cudaStream_t stream, cudaGraph_t* graph) {
  if (!capturing() || capture().stream != stream) return result(cudaErrorIllegalState);
  capture().active = false;
  if (capture().spoiled) return result(cudaErrorStreamCaptureInvalidated);
  *graph = new CUgraph_st{std::move(capture().nodes)};
  if (settings().forget_a_node) (*graph)->nodes.pop_back();
  return result(cudaSuccess);
}
cudaError_t cudaGraphGetNodes(cudaGraph_t graph, cudaGraphNode_t* nodes, size_t* n) {
  if (nodes) return result(cudaErrorInvalidValue);  // nothing reads them
  *n = graph->nodes.size();
  return result(cudaSuccess);
}
cudaError_t cudaGraphInstantiate(cudaGraphExec_t* executable, cudaGraph_t graph, unsigned long long) {
  *executable = new CUgraphExec_st{graph->nodes};
  ++counts().graphs;
  return result(cudaSuccess);
}
cudaError_t cudaGraphDestroy(cudaGraph_t graph) {
  delete graph;
  return result(cudaSuccess);
}
cudaError_t cudaGraphExecDestroy(cudaGraphExec_t executable) {
  finish();
  delete executable;
  return result(cudaSuccess);
}
cudaError_t cudaGraphLaunch(cudaGraphExec_t executable, cudaStream_t stream) {
  if (capturing()) return spoil_capture();
  ++counts().replays;
  for (const Work& node : executable->nodes) {
    if (const cudaError_t code = enqueue(stream, node); code != cudaSuccess) return code;
  }
  return result(cudaSuccess);
}

}  // extern "C"
