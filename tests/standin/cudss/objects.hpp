// The objects of the stand-in for cuDSS.
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "tests/standin/cudart.hpp"
#include "tests/standin/cudss/state.hpp"

struct cudssContext {
  cudaStream_t stream = nullptr;
  cudssDeviceMemHandler_t memory{};
};

struct cudssConfig {
  int deterministic = 0;
  cudssMatchingAlg_t matching = CUDSS_MATCHING_ALG_AUTO;
};

/// Sparse where row_start is set, else one column.
struct cudssMatrix {
  int n = 0, entries = 0;
  const int* row_start = nullptr;
  const int* column = nullptr;
  double* value = nullptr;
};

struct cudssData {
  bool analyzed = false, factorized = false;
  std::vector<int> row_start, column;  // of the analysis
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor;
  int info = 0;
  void* memory = nullptr;
};

namespace standin {

/// Keeps the first fault. @return CUDSS_STATUS_INVALID_VALUE
cudssStatus_t refuse(const std::string& fault);
/// Whether n values of a matrix lie on the device.
template <class T>
bool there(const T* values, int n) {
  return on_device(values, static_cast<std::size_t>(n) * sizeof(T));
}

cudssStatus_t analyze(const cudssContext& handle, cudssData& data, const cudssMatrix& a);
cudssStatus_t factorize(const cudssContext& handle, cudssData& data, const cudssMatrix& a);
cudssStatus_t solve(const cudssContext& handle, cudssData& data, const cudssMatrix& b, const cudssMatrix& x);

}  // namespace standin
