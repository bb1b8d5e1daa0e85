// The functions of cudss.h that barrierbench calls, as a shared library of its own. Every argument is held against what
// the real library would read.
#include <set>

#include "tests/standin/cudss/objects.hpp"

using namespace standin;

namespace {

template <class T>
std::set<const T*>& alive() {
  static std::set<const T*> all;
  return all;
}
template <class T>
bool lives(const T* object) {
  return alive<T>().count(object) > 0;
}
template <class T>
cudssStatus_t create(T** out) {
  *out = new T;
  alive<T>().insert(*out);
  ++cudss().objects;
  return CUDSS_STATUS_SUCCESS;
}
template <class T>
cudssStatus_t destroy(T* object) {
  if (alive<T>().erase(object) == 0) return refuse("an object is destroyed that does not live");
  finish();
  delete object;
  --cudss().objects;
  return CUDSS_STATUS_SUCCESS;
}

bool fails(const char* name) { return cudss().failing == name; }

const char* phase_name(int phase) {
  return phase == CUDSS_PHASE_ANALYSIS        ? "analysis"
         : phase == CUDSS_PHASE_FACTORIZATION ? "factorization"
                                              : "solve";
}

}  // namespace

namespace standin {
cudssStatus_t refuse(const std::string& fault) {
  if (cudss().fault.empty()) cudss().fault = fault;
  return CUDSS_STATUS_INVALID_VALUE;
}
}  // namespace standin

#define FAIL_IF_ASKED(name) \
  if (fails(name)) return cudss().status

extern "C" {

cudssStatus_t cudssGetProperty(libraryPropertyType property, int* value) {
  FAIL_IF_ASKED("cudssGetProperty");
  if (property != MAJOR_VERSION) return refuse("another property than the major version");
  *value = cudss().major;
  return CUDSS_STATUS_SUCCESS;
}

cudssStatus_t cudssCreate(cudssHandle_t* handle) {
  FAIL_IF_ASKED("cudssCreate");
  return create(handle);
}
cudssStatus_t cudssDestroy(cudssHandle_t handle) {
  if (!alive<cudssData>().empty()) return refuse("the handle is destroyed before its data");
  return destroy(handle);
}
cudssStatus_t cudssSetStream(cudssHandle_t handle, cudaStream_t stream) {
  FAIL_IF_ASKED("cudssSetStream");
  if (!lives(handle) || !stream || !known_stream(stream)) return refuse("a stream that is none");
  handle->stream = stream;
  return CUDSS_STATUS_SUCCESS;
}
cudssStatus_t cudssSetDeviceMemHandler(cudssHandle_t handle, const cudssDeviceMemHandler_t* memory) {
  FAIL_IF_ASKED("cudssSetDeviceMemHandler");
  if (!lives(handle) || !memory->device_alloc || !memory->device_free || memory->name[0] == 0) {
    return refuse("a memory handler without functions or name");
  }
  handle->memory = *memory;
  return CUDSS_STATUS_SUCCESS;
}

cudssStatus_t cudssConfigCreate(cudssConfig_t* config) {
  FAIL_IF_ASKED("cudssConfigCreate");
  return create(config);
}
cudssStatus_t cudssConfigDestroy(cudssConfig_t config) { return destroy(config); }
cudssStatus_t cudssConfigSet(cudssConfig_t config, cudssConfigParam_t setting, const void* value,
                             size_t bytes) {
  FAIL_IF_ASKED("cudssConfigSet");
  if (!lives(config) || bytes != sizeof(int)) return refuse("a setting of another size");
  if (setting == CUDSS_CONFIG_DETERMINISTIC_MODE) {
    memcpy(&config->deterministic, value, bytes);
  } else if (setting == CUDSS_CONFIG_MATCHING_ALG) {
    memcpy(&config->matching, value, bytes);
  } else {
    return CUDSS_STATUS_NOT_SUPPORTED;
  }
  return CUDSS_STATUS_SUCCESS;
}

cudssStatus_t cudssDataCreate(const cudssHandle_t handle, cudssData_t* data) {
  FAIL_IF_ASKED("cudssDataCreate");
  return lives(handle) ? create(data) : refuse("data of a handle that does not live");
}
cudssStatus_t cudssDataDestroy(cudssHandle_t handle, cudssData_t data) {
  if (!lives(handle) || !lives(data)) return refuse("data is destroyed that does not live");
  if (data->memory)
    handle->memory.device_free(handle->memory.ctx, data->memory, cudss().factor_bytes, handle->stream);
  return destroy(data);
}
cudssStatus_t cudssDataGet(const cudssHandle_t handle, const cudssData_t data, cudssDataParam_t what,
                           void* value, size_t bytes, size_t* written) {
  if (!lives(handle) || !lives(data) || !data->analyzed) return refuse("a question before the analysis");
  finish();
  if (what == CUDSS_DATA_INFO) {
    FAIL_IF_ASKED("CUDSS_DATA_INFO");
    if (bytes != sizeof data->info) return refuse("CUDSS_DATA_INFO of another size");
    memcpy(value, &data->info, bytes);
  } else if (what == CUDSS_DATA_LU_NNZ) {
    FAIL_IF_ASKED("CUDSS_DATA_LU_NNZ");
    if (bytes != sizeof(std::int64_t)) return refuse("CUDSS_DATA_LU_NNZ of another size");
    memcpy(value, &cudss().factor_nonzeros, bytes);
  } else {
    return CUDSS_STATUS_NOT_SUPPORTED;
  }
  *written = bytes;
  return CUDSS_STATUS_SUCCESS;
}
cudssStatus_t cudssDataSet(const cudssHandle_t handle, cudssData_t data, cudssDataParam_t what,
                           const void* value, size_t bytes) {
  FAIL_IF_ASKED("cudssDataSet");
  if (!lives(handle) || !lives(data)) return refuse("data that does not live");
  if (what != CUDSS_DATA_INFO || bytes != sizeof data->info) return CUDSS_STATUS_NOT_SUPPORTED;
  memcpy(&data->info, value, bytes);
  return CUDSS_STATUS_SUCCESS;
}

cudssStatus_t cudssMatrixCreateCsr(cudssMatrix_t* matrix, int64_t rows, int64_t columns, int64_t entries,
                                   const void* row_start, const void* row_end, const void* column,
                                   const void* values, cudaDataType_t offset_type, cudaDataType_t index_type,
                                   cudaDataType_t value_type, cudssMatrixType_t type,
                                   cudssMatrixViewType_t view, cudssIndexBase_t base) {
  FAIL_IF_ASKED("cudssMatrixCreateCsr");
  if (offset_type != CUDA_R_32I || index_type != CUDA_R_32I || value_type != CUDA_R_64F) {
    return refuse("other types than 32-bit integers and doubles");
  }
  if (type != CUDSS_MTYPE_SPD || view != CUDSS_MVIEW_UPPER || base != CUDSS_BASE_ZERO || row_end ||
      rows != columns) {
    return refuse("no upper triangle of a symmetric positive definite matrix, from 0");
  }
  const cudssMatrix given{static_cast<int>(rows), static_cast<int>(entries),
                          static_cast<const int*>(row_start), static_cast<const int*>(column),
                          const_cast<double*>(static_cast<const double*>(values))};
  if (!there(given.row_start, given.n + 1) || !there(given.column, given.entries) ||
      !there(given.value, given.entries)) {
    return refuse("a matrix that is not on the device");
  }
  create(matrix);
  **matrix = given;
  return CUDSS_STATUS_SUCCESS;
}
cudssStatus_t cudssMatrixCreateDn(cudssMatrix_t* matrix, int64_t rows, int64_t columns, int64_t stride,
                                  const void* values, cudaDataType_t type, cudssLayout_t layout) {
  FAIL_IF_ASKED("cudssMatrixCreateDn");
  if (columns != 1 || stride != rows || type != CUDA_R_64F || layout != CUDSS_LAYOUT_COL_MAJOR) {
    return refuse("no column of doubles");
  }
  cudssMatrix given;
  given.n = static_cast<int>(rows);
  given.value = const_cast<double*>(static_cast<const double*>(values));
  if (!there(given.value, given.n)) return refuse("a vector that is not on the device");
  create(matrix);
  **matrix = given;
  return CUDSS_STATUS_SUCCESS;
}
cudssStatus_t cudssMatrixDestroy(cudssMatrix_t matrix) { return destroy(matrix); }

cudssStatus_t cudssExecute(cudssHandle_t handle, int phase, const cudssConfig_t config, cudssData_t data,
                           const cudssMatrix_t a, cudssMatrix_t x, const cudssMatrix_t b) {
  FAIL_IF_ASKED(phase_name(phase));
  if (!lives(handle) || !lives(config) || !lives(data) || !lives(a) || !lives(x) || !lives(b)) {
    return refuse("an object that does not live");
  }
  if (!handle->stream || !handle->memory.device_alloc) return refuse("no stream or no memory handler");
  if (config->deterministic != 1 || config->matching != CUDSS_MATCHING_ALG_NONE)
    return refuse("other settings");
  if (!there(a->row_start, a->n + 1) || !there(a->column, a->entries) || !there(a->value, a->entries) ||
      !there(b->value, b->n) || !there(x->value, x->n) || b->n != a->n || x->n != a->n) {
    return refuse("memory that is not on the device, or of another size");
  }
  switch (phase) {
    case CUDSS_PHASE_ANALYSIS:
      return analyze(*handle, *data, *a);
    case CUDSS_PHASE_FACTORIZATION:
      return factorize(*handle, *data, *a);
    case CUDSS_PHASE_SOLVE:
      return solve(*handle, *data, *b, *x);
    default:
      return CUDSS_STATUS_NOT_SUPPORTED;
  }
}

}  // extern "C"
