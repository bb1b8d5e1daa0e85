// What the stand-in reports of its card.
#include <cstring>

#include "tests/standin/cudart.hpp"

using namespace standin;

extern "C" {

cudaError_t cudaDriverGetVersion(int* version) {
  *version = settings().driver;
  return cudaSuccess;
}
cudaError_t cudaRuntimeGetVersion(int* version) {
  *version = settings().runtime;
  return cudaSuccess;
}
/// The count is written only on success, as CUDA has it.
cudaError_t cudaGetDeviceCount(int* count) {
  if (settings().count_code == cudaSuccess) *count = settings().count;
  return result(settings().count_code);
}
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* card, int) {
  *card = {};
  strcpy(card->name, "stand-in");
  card->major = settings().major;
  card->minor = settings().minor;
  return result(cudaSuccess);
}
cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* of, const void*) {
  *of = {};
  of->localSizeBytes = settings().local_bytes;
  of->numRegs = settings().registers;
  return result(cudaSuccess);
}
cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int) {
  if (attribute != cudaDevAttrMultiProcessorCount && attribute != cudaDevAttrMaxThreadsPerMultiProcessor) {
    return result(cudaErrorInvalidValue);
  }
  *value = attribute == cudaDevAttrMultiProcessorCount ? 2 : 1024;
  return result(cudaSuccess);
}
const char* cudaGetErrorString(cudaError_t code) {
  switch (code) {
    case cudaErrorInvalidValue:
      return "invalid argument";
    case cudaErrorMemoryAllocation:
      return "out of memory";
    case cudaErrorInvalidConfiguration:
      return "invalid configuration argument";
    case cudaErrorInvalidDeviceFunction:
      return "invalid device function";
    case cudaErrorLaunchOutOfResources:
      return "too many resources requested for launch";
    case cudaErrorIllegalAddress:
      return "an illegal memory access was encountered";
    case cudaErrorStreamCaptureUnsupported:
      return "operation not permitted when stream is capturing";
    case cudaErrorNoKernelImageForDevice:
      return "no kernel image is available for execution on the device";
    default:
      return "an error of the stand-in";
  }
}

}  // extern "C"
