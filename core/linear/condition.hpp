// Condition numbers of the matrix that is solved. A status word goes with every number. `cond`, never kappa:
// that word is the contact stiffness.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/linear/block_system.hpp"

namespace bb {

enum class Scaling { none, jacobi, block_jacobi };
enum class ConditionStatus { ok, lower_bound, singular, not_pd, not_converged };
/// ritz: the Ritz values of a PCG solve. inverse_power: inverse power and Lanczos. spectra: Spectra round the CHOLMOD factor.
/// dense: all eigenvalues, for tests. lanczos: our Lanczos round the factor. Records have the number of an estimator (`tier`).
enum class Estimator { ritz, inverse_power, spectra, dense, lanczos };
/// Which ends of the spectrum a factor of the shifted matrix has proven to be the last, to 8e-4 of them.
enum class ProvenEnds { none, smallest, largest, both };
std::string_view to_string(ConditionStatus status);
std::string_view to_string(ProvenEnds proof);
std::string_view to_string(Estimator estimator);
std::string_view to_string(Scaling scaling);

/// Beyond it rounding decides lambda_min: such a matrix has this cond, as a lower bound.
inline constexpr double largest_known_cond = 1e14;

struct ConditionEstimate {
  double lambda_min = 0, lambda_max = 0, cond = 0;  // NaN where unknown
  ConditionStatus status = ConditionStatus::ok;
  ProvenEnds proof = ProvenEnds::none;  // spectra and lanczos
  // "ritz", "inverse_power+lanczos", "dense"; "spectra" or "lanczos", followed by what an end took beside it:
  // ", smallest by lanczos" where Spectra did not converge, ", largest shifted to" where a factor of its own was needed;
  // "lanczos, sigma = -1e-8 lambda_max" where the matrix itself has no factor.
  std::string method;
  double residual = 0;           // max |A v - lambda v| / |A| of the two pairs
  int solves = 0, products = 0;  // triangular solves, matrix products used
  int factorizations = 0;        // beyond the first one shared by the scalings: proofs and shifts of the ends
  double seconds = 0;
};

inline constexpr int default_max_solves = 60, default_max_products = 200;

struct ConditionOptions {
  Estimator estimator = Estimator::spectra;
  Scaling scaling = Scaling::none;
  std::uint64_t seed = 1;  // of the start vector, recorded
  // spectra: what it may take for the small and for the large end before our Lanczos takes over.
  int max_solves = default_max_solves, max_products = default_max_products;
};

/// ritz: what PCG leaves behind, LinearReport::ritz_min and ritz_max. Ritz values lie inside the spectrum,
/// so the status is lower_bound; not_converged (all NaN) when there are none, as after a breakdown.
ConditionEstimate condition_from_ritz(double ritz_min, double ritz_max);

/// Errors: failure is a status; ConfigError only for the estimator ritz and a malformed system.
/// Cost: inverse_power one factorisation, 4 solves, 21 products. lanczos at most 25 solves and 40 products, spectra its budget of
/// both before that; each two factorisations or a few more: each end is proven by a factor of the matrix shifted
/// 8e-4 beyond it, which exists only when no eigenvalue lies there. The proof is left out, and a small residual
/// decides alone, for an eigenvalue below 1.25e-10 lambda_max, whose shift rounding would swallow. dense:
/// n <= 3000, O(n^3).
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
