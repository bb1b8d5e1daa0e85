// What the stand-in for cuDSS computes: Eigen's sparse Cholesky on the stand-in's device memory, in its stream, when
// somebody waits.
#include "tests/standin/cudss/objects.hpp"

namespace standin {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// The upper triangle by rows is the lower one by columns.
Sparse lower_of(const cudssMatrix& a) {
  return Eigen::Map<const Sparse>(a.n, a.n, a.entries, a.row_start, a.column, a.value);
}

/// Whether a row holds its diagonal and then ascending columns behind it.
bool is_upper(const cudssMatrix& a) {
  if (a.row_start[0] != 0 || a.row_start[a.n] != a.entries) return false;
  for (int i = 0; i < a.n; ++i) {
    if (a.row_start[i] == a.row_start[i + 1] || a.column[a.row_start[i]] != i) return false;
    for (int k = a.row_start[i] + 1; k < a.row_start[i + 1]; ++k) {
      if (a.column[k] <= a.column[k - 1] || a.column[k] >= a.n) return false;
    }
  }
  return true;
}

bool same_pattern(const cudssData& data, const cudssMatrix& a) {
  return static_cast<int>(data.column.size()) == a.entries &&
         static_cast<int>(data.row_start.size()) == a.n + 1 &&
         std::equal(data.row_start.begin(), data.row_start.end(), a.row_start) &&
         std::equal(data.column.begin(), data.column.end(), a.column);
}

cudssStatus_t put(const cudssContext& handle, std::function<void()> work) {
  const cudaError_t code = enqueue(handle.stream, [work = std::move(work)] {
    work();
    return cudaSuccess;
  });
  return code == cudaSuccess ? CUDSS_STATUS_SUCCESS : CUDSS_STATUS_EXECUTION_FAILED;
}

}  // namespace

cudssStatus_t analyze(const cudssContext& handle, cudssData& data, const cudssMatrix& a) {
  finish();
  if (!is_upper(a)) return refuse("a matrix that is no upper triangle by rows");
  ++cudss().analyses;
  data.row_start.assign(a.row_start, a.row_start + a.n + 1);
  data.column.assign(a.column, a.column + a.entries);
  data.factor.analyzePattern(lower_of(a));
  data.analyzed = true;
  data.factorized = false;
  if (data.memory) return refuse("a second analysis with the same data");
  const bool allocated =
      handle.memory.device_alloc(handle.memory.ctx, &data.memory, cudss().factor_bytes, handle.stream) == 0;
  return allocated ? CUDSS_STATUS_SUCCESS : CUDSS_STATUS_ALLOC_FAILED;
}

// Where it fails the number stays until it is set to 0: later factors are no better.
cudssStatus_t factorize(const cudssContext& handle, cudssData& data, const cudssMatrix& a) {
  if (!data.analyzed) return refuse("a factorisation before the analysis");
  if (!same_pattern(data, a)) return refuse("a factorisation of another pattern than that of the analysis");
  ++cudss().factorizations;
  return put(handle, [&data, a] {
    data.factor.factorize(lower_of(a));
    if (data.info == 0 && data.factor.info() != Eigen::Success) data.info = 7;
    data.factorized = data.info == 0;
  });
}

cudssStatus_t solve(const cudssContext& handle, cudssData& data, const cudssMatrix& b, const cudssMatrix& x) {
  finish();
  if (!data.factorized) return refuse("a solve without a factor");
  ++cudss().solves;
  return put(handle, [&data, b, x] {
    using Vector = Eigen::VectorXd;
    Eigen::Map<Vector>(x.value, x.n) = data.factor.solve(Eigen::Map<const Vector>(b.value, b.n));
  });
}

}  // namespace standin
