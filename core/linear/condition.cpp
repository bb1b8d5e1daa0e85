// The condition estimator: shares one factorisation between scalings and sends each request to the estimator that it names.
#include "core/linear/condition.hpp"

#include <chrono>
#include <cmath>
#include <limits>

#include "core/linear/block_scaling.hpp"
#include "core/linear/condition_dense.hpp"
#include "core/linear/extreme_pairs.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

ConditionEstimate unknown(ConditionStatus status, std::string method) {
  ConditionEstimate e;
  e.lambda_min = e.lambda_max = e.cond = e.residual = undefined;
  e.status = status;
  e.method = std::move(method);
  return e;
}

bool has_full_diagonal(const Eigen::SparseMatrix<double>& lower) {
  for (int j = 0; j < lower.cols(); ++j) {
    const int begin = lower.outerIndexPtr()[j];
    if (begin == lower.outerIndexPtr()[j + 1] || lower.innerIndexPtr()[begin] != j) return false;
  }
  return true;
}

}  // namespace

std::string_view to_string(ConditionStatus status) {
  switch (status) {
    case ConditionStatus::ok:
      return "ok";
    case ConditionStatus::lower_bound:
      return "lower_bound";
    case ConditionStatus::singular:
      return "singular";
    case ConditionStatus::not_pd:
      return "not_pd";
    case ConditionStatus::not_converged:
      return "not_converged";
  }
  return "";
}

std::string_view to_string(ProvenEnds proof) {
  constexpr std::string_view words[] = {"none", "smallest", "largest", "both"};
  return words[static_cast<std::size_t>(proof)];
}

std::string_view to_string(Estimator estimator) {
  constexpr std::string_view words[] = {"ritz", "inverse_power", "spectra", "dense", "lanczos"};
  return words[static_cast<std::size_t>(estimator)];
}

std::string_view to_string(Scaling scaling) {
  switch (scaling) {
    case Scaling::none:
      return "none";
    case Scaling::jacobi:
      return "jacobi";
    case Scaling::block_jacobi:
      return "block_jacobi";
  }
  return "";
}

ConditionEstimate condition_from_ritz(double ritz_min, double ritz_max) {
  ConditionEstimate e = unknown(ConditionStatus::not_converged, "ritz");
  if (!(ritz_min > 0) || !(ritz_max >= ritz_min) || !std::isfinite(ritz_max)) return e;
  e.lambda_min = ritz_min;
  e.lambda_max = ritz_max;
  e.status = ConditionStatus::lower_bound;
  e.cond = std::min(ritz_max / ritz_min, largest_known_cond);
  return e;
}

struct ConditionEstimator::Data {
  FactoredMatrix matrix;
  ReducedSystem completed;  // a copy with explicit zeros, when a diagonal entry is not stored
  BlockScaling scaling;

  /// Checks, completes and, for all estimators but dense, factorises. Returns false for entries that are not finite.
  bool prepare(const ReducedSystem& system, Estimator estimator) {
    if (estimator == Estimator::ritz)
      throw ConfigError("condition estimator", "ritz", "inverse_power, spectra, dense or lanczos");
    matrix.system = &system;
    if (!has_full_diagonal(system.lower)) {
      completed = system;
      for (int j = 0; j < completed.lower.cols(); ++j) completed.lower.coeffRef(j, j) += 0.0;
      completed.lower.makeCompressed();
      completed.pattern_id = 0;
      matrix.system = &completed;
    }
    matrix.product.update(*matrix.system);
    if (!matrix.product.all_finite()) return false;
    if (estimator != Estimator::dense && matrix.product.n() > 0) {
      matrix.positive = matrix.factor.factorize(*matrix.system) == LinearStatus::ok;
    }
    return true;
  }

  ConditionEstimate run(const ConditionOptions& options) {
    constexpr const char* methods[] = {"", "inverse_power+lanczos", "spectra", "dense", "lanczos"};
    const Estimator estimator = options.estimator;
    const char* method = methods[static_cast<std::size_t>(estimator)];
    if (matrix.product.n() == 0) return unknown(ConditionStatus::not_converged, method);
    const LinearStatus status = scaling.setup(*matrix.system, options.scaling);
    if (status == LinearStatus::matrix_indefinite) return unknown(ConditionStatus::not_pd, method);
    if (status != LinearStatus::ok) return unknown(ConditionStatus::singular, method);
    if (estimator == Estimator::inverse_power) return estimate_inverse_power(matrix, scaling, options.seed);
    if (estimator == Estimator::dense) return estimate_dense(*matrix.system, scaling);
    return estimate_ends(matrix, scaling, options);
  }
};

ConditionEstimator::ConditionEstimator() : data_(std::make_unique<Data>()) {}
ConditionEstimator::~ConditionEstimator() = default;

ConditionEstimate ConditionEstimator::estimate(const ReducedSystem& system, const ConditionOptions& options) {
  const Clock::time_point start = Clock::now();
  ConditionEstimate e = unknown(ConditionStatus::not_converged, "entries that are not finite");
  try {
    if (data_->prepare(system, options.estimator)) e = data_->run(options);
  } catch (const FactorTooLarge&) {
    e = unknown(ConditionStatus::not_converged, "a factor that is too large");
  }
  e.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return e;
}

}  // namespace bb
