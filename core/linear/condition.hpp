// Condition numbers of the matrix that is solved. A status word goes with every number. `cond`, never kappa:
// that word is the contact stiffness.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/linear/block_system.hpp"

namespace bb {

enum class Scaling { none, jacobi, block_jacobi };
enum class ConditionStatus { ok, lower_bound, singular, not_pd, not_converged };
std::string_view to_string(ConditionStatus status);
std::string_view to_string(Scaling scaling);

struct ConditionEstimate {
  double lambda_min = 0, lambda_max = 0, cond = 0;  // NaN where unknown
  ConditionStatus status = ConditionStatus::ok;
  std::string method;            // "ritz", "inverse_power+lanczos", "shift_invert", "dense"
  double residual = 0;           // max |A v - lambda v| / |A| of the two pairs
  int solves = 0, products = 0;  // triangular solves, matrix products used
  double seconds = 0;
};

struct ConditionOptions {
  int tier = 2;  // 1 inverse power and Lanczos, 2 Spectra round the CHOLMOD factor, 3 dense (tests)
  Scaling scaling = Scaling::none;
  std::uint64_t seed = 1;  // of the start vector, recorded
};

/// Errors: none; failure is a status. Cost: tier 2 at most 25 solves and 40 products with one factorisation.
class ConditionEstimator {
 public:
  ConditionEstimator();
  ~ConditionEstimator();
  ConditionEstimate estimate(const ReducedSystem& system, const ConditionOptions& options);

 private:
  struct Data;
  std::unique_ptr<Data> data_;  // keeps the factor's analysis while pattern_id stays
};

}  // namespace bb
