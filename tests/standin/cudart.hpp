// A stand-in for the CUDA run time: the object files above it are nvcc's as they stand, their device memory is the heap,
// and their kernels are the translated PTX of tests/ptx. Work is queued and done as late as a card may do it: when
// somebody waits. This header is what tests set and read.
#pragma once

#include <cuda_runtime_api.h>

#include <functional>
#include <string>
#include <vector>

namespace standin {

/// What the stand-in pretends. Set before the calls that read it.
struct Settings {
  cudaError_t count_code = cudaSuccess;  // of cudaGetDeviceCount
  int count = 1, driver = 13000, runtime = 13000;
  int major = 9, minor = 0;
  std::size_t memory = std::size_t{1} << 32;  // bytes of the card
  std::size_t local_bytes = 0;  // of a thread of every kernel; the card holds two processors of 1024 threads
  int registers = 0;            // of every kernel
  int refuse_launch = -1;       // the launch of this number fails at once
  cudaError_t refuse_code = cudaErrorLaunchOutOfResources;  // with this
  int break_launch = -1;                                    // this one runs into an illegal address
  bool wrong_numbers = false;                               // every kernel writes nothing
  bool forget_a_node = false;                               // graphs have a node less than was captured
};

/// What happened since reset().
struct Counts {
  int launches = 0;  // requested, those of graphs once for each replay
  int graphs = 0;    // instantiated
  int replays = 0;
  int waits = 0;
  unsigned blocks = 0, threads = 0;  // of the last launch
  int libraries = 0;                 // of device code, loaded and not unloaded
  std::size_t in_use = 0;            // device memory
  std::string fault;                 // what a kernel did wrong, in the words of the PTX machine
};

Settings& settings();
Counts& counts();
/// Everything as at the start; what is queued is dropped, an error is forgotten. Memory stays.
void reset();

// --- between the files of the stand-in
/// Does work on a stream when somebody waits for it, or keeps it for a graph.
cudaError_t enqueue(cudaStream_t stream, std::function<cudaError_t()> work);
/// Everything that is queued. @return the error of the context
cudaError_t finish();
/// The error that every call reports after a kernel failed.
cudaError_t& broken();
/// Returns the code and keeps it for cudaGetLastError.
cudaError_t result(cudaError_t code);
bool capturing();
/// A call that must not come while launches are captured: the capture is void then.
cudaError_t spoil_capture();
/// Whether [p, p + bytes) is one device allocation's.
bool on_device(const void* p, std::size_t bytes);
bool known_stream(cudaStream_t stream);

}  // namespace standin
