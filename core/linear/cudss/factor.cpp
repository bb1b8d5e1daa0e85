#include "core/linear/cudss/factor.hpp"

#include <algorithm>
#include <cmath>

#include "core/exec/cuda/device.hpp"
#include "core/exec/cuda/device_executor.hpp"
#include "core/linear/stopwatch.hpp"

namespace bb::cudss {

Factor::Factor(const Library& library)
    : library_(library),
      executor_(cuda::make_device_executor()),
      memory_(*executor_),
      row_start_(*executor_, "matrix rows"),
      column_(*executor_, "matrix columns"),
      value_(*executor_, "matrix values"),
      b_(*executor_, "right-hand side"),
      x_(*executor_, "solution") {
  make_handle();
  configure();
}

void Factor::make_handle() {
  cudssHandle_t handle = nullptr;
  const cudssStatus_t made = library_.cudssCreate(&handle);
  handle_ = {handle, library_.cudssDestroy};  // also where it failed half-way
  check(made, "cudssCreate");
  const cudssDeviceMemHandler_t memory = memory_.handler();
  check(library_.cudssSetDeviceMemHandler(handle, &memory), "cudssSetDeviceMemHandler");
  check(library_.cudssSetStream(handle, dynamic_cast<cuda::DeviceExecutor&>(*executor_).stream()),
        "cudssSetStream");
}

/// The same bits in every run; no permutation for the sake of the diagonal, which is positive.
void Factor::configure() {
  cudssConfig_t config = nullptr;
  const cudssStatus_t made = library_.cudssConfigCreate(&config);
  config_ = {config, library_.cudssConfigDestroy};
  check(made, "cudssConfigCreate");
  const int deterministic = 1;
  check(
      library_.cudssConfigSet(config, CUDSS_CONFIG_DETERMINISTIC_MODE, &deterministic, sizeof deterministic),
      "cudssConfigSet of CUDSS_CONFIG_DETERMINISTIC_MODE");
  const cudssMatchingAlg_t matching = CUDSS_MATCHING_ALG_NONE;
  check(library_.cudssConfigSet(config, CUDSS_CONFIG_MATCHING_ALG, &matching, sizeof matching),
        "cudssConfigSet of CUDSS_CONFIG_MATCHING_ALG");
}

void Factor::check(cudssStatus_t status, const char* what) {
  const std::exception_ptr memory_error = memory_.take_error();
  if (status == CUDSS_STATUS_SUCCESS && !memory_error) return;
  analyzed_ = false;
  if (memory_error) std::rethrow_exception(memory_error);
  const std::string text = std::string("cuDSS: ") + what + ": " + status_text(status);
  if (status == CUDSS_STATUS_ALLOC_FAILED) throw exec::OutOfMemory(text);
  throw exec::ExecutionError(text);
}

void Factor::execute(cudssPhase_t phase, const char* what) {
  check(library_.cudssExecute(handle_.get(), phase, config_.get(), data_.get(), matrix_.get(),
                              solution_.get(), rhs_.get()),
        what);
  executor_->synchronize();
}

/// The values are there already: cuDSS is reported where everything lies.
void Factor::set_pattern(const ReducedSystem& system) {
  const auto& lower = system.lower;
  const auto n = static_cast<std::size_t>(lower.rows()), entries = static_cast<std::size_t>(lower.nonZeros());
  matrix_.reset(), rhs_.reset(), solution_.reset(), data_.reset();
  row_start_.upload({lower.outerIndexPtr(), n + 1});
  column_.upload({lower.innerIndexPtr(), entries});
  b_.resize(lower.rows()), x_.resize(lower.rows());

  cudssData_t data = nullptr;
  check(library_.cudssDataCreate(handle_.get(), &data), "cudssDataCreate");
  data_ = {data, [this](cudssData_t own) { library_.cudssDataDestroy(handle_.get(), own); }};
  cudssMatrix_t matrix = nullptr;
  check(
      library_.cudssMatrixCreateCsr(&matrix, lower.rows(), lower.rows(), lower.nonZeros(), row_start_.data(),
                                    nullptr, column_.data(), value_.data(), CUDA_R_32I, CUDA_R_32I,
                                    CUDA_R_64F, CUDSS_MTYPE_SPD, CUDSS_MVIEW_UPPER, CUDSS_BASE_ZERO),
      "cudssMatrixCreateCsr");
  matrix_ = {matrix, library_.cudssMatrixDestroy};
  const auto vector = [&](exec::Buffer<double>& buffer) {
    cudssMatrix_t dense = nullptr;
    check(library_.cudssMatrixCreateDn(&dense, buffer.size(), 1, buffer.size(), buffer.data(), CUDA_R_64F,
                                       CUDSS_LAYOUT_COL_MAJOR),
          "cudssMatrixCreateDn");
    return Owned<cudssMatrix>(dense, library_.cudssMatrixDestroy);
  };
  rhs_ = vector(b_), solution_ = vector(x_);
}

void Factor::analyze() {
  execute(CUDSS_PHASE_ANALYSIS, "the analysis");
  std::int64_t nonzeros = 0;
  std::size_t written = 0;
  check(library_.cudssDataGet(handle_.get(), data_.get(), CUDSS_DATA_LU_NNZ, &nonzeros, sizeof nonzeros,
                              &written),
        "cudssDataGet of CUDSS_DATA_LU_NNZ");
  factor_nonzeros_ = static_cast<double>(nonzeros);
}

LinearStatus Factor::run_factorization() {
  execute(CUDSS_PHASE_FACTORIZATION, "the factorisation");
  std::size_t written = 0;
  check(library_.cudssDataGet(handle_.get(), data_.get(), CUDSS_DATA_INFO, &info_, sizeof info_, &written),
        "cudssDataGet of CUDSS_DATA_INFO");
  if (info_ == 0) return LinearStatus::ok;
  const int none = 0;  // cuDSS keeps it until it is reset
  check(library_.cudssDataSet(handle_.get(), data_.get(), CUDSS_DATA_INFO, &none, sizeof none),
        "cudssDataSet of CUDSS_DATA_INFO");
  return LinearStatus::matrix_indefinite;
}

LinearStatus Factor::factorize(const ReducedSystem& system) {
  analyzed_last_ = false;
  analyze_s_ = factor_s_ = 0;
  const std::span<const double> values(system.lower.valuePtr(),
                                       static_cast<std::size_t>(system.lower.nonZeros()));
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    return LinearStatus::non_finite;
  }
  analyzed_last_ = !key_.same_as_last(system) || !analyzed_;
  analyzed_ = !analyzed_last_;
  const Stopwatch upload;
  value_.upload(values);
  factor_s_ = upload.seconds();
  if (analyzed_last_) {
    const Stopwatch analysis;
    set_pattern(system);
    analyze();
    analyzed_ = true;
    analyze_s_ = analysis.seconds();
  }
  const Stopwatch factorization;
  const LinearStatus status = run_factorization();
  factor_s_ += factorization.seconds();
  return status;
}

void Factor::solve(const VecXd& b, VecXd& x) {
  const auto n = static_cast<std::size_t>(b.size());
  b_.upload({b.data(), n});
  execute(CUDSS_PHASE_SOLVE, "the solve");
  x.resize(b.size());
  x_.download({x.data(), n});
}

std::string Factor::failure(const ReducedSystem&) const {
  return "cuDSS found it not positive definite (CUDSS_DATA_INFO " + std::to_string(info_) + ")";
}

}  // namespace bb::cudss
