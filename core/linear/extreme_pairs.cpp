#include "core/linear/extreme_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/linear/lanczos.hpp"
#include "core/linear/scaled_matrix.hpp"
#include "core/linear/spectra_end.hpp"
#include "core/linear/spectrum_end.hpp"

namespace bb {
namespace {

constexpr int most_lanczos_solves = 25, most_lanczos_products = 40;
constexpr double kRetryShift = 1e-8;  // of lambda_max, when A itself cannot be factorised

/// A pair that Lanczos left, of the operator in use.
void take(const LanczosEnd& ritz, SpectrumEndPair& end) {
  end.vector = ritz.vector;
  end.resolved = ritz.converged(end_tolerance);
  end.uncertainty = ritz.residual / std::abs(ritz.value);
}

/// A pair that Spectra found.
void take(SpectraEnd&& found, SpectrumEndPair& end) {
  end.vector = std::move(found.vector);
  end.resolved = true;
  end.uncertainty = end_tolerance;
}

SymmetricOperator products_with(ScaledMatrix& b) {
  return [&b](const VecXd& x, VecXd& y) { b.multiply(x, y); };
}

SpectrumEndPair largest_by_lanczos(ScaledMatrix& b, std::uint64_t seed, int n_products,
                                   double& smallest_ritz) {
  const LanczosEnd ritz =
      lanczos_largest(products_with(b), seeded_vector(b.n(), seed), n_products, end_tolerance);
  smallest_ritz = ritz.smallest;
  SpectrumEndPair end;
  take(ritz, end);
  end.lambda = ritz.value;
  return end;
}

/// B + kRetryShift lambda_max is factorised in place of B; lambda_min may then be of either sign.
void estimate_without_factor(ScaledMatrix& b, const SpectrumEndPair& top, double smallest_ritz,
                             std::uint64_t seed, ConditionEstimate& e) {
  e.method = "lanczos, sigma = -1e-8 lambda_max";
  e.status = ConditionStatus::not_pd;
  e.lambda_min = smallest_ritz < 0 ? smallest_ritz : not_known;  // a negative Ritz value proves the point
  e.cond = not_known;
  const double sigma = -kRetryShift * top.lambda;
  if (!(top.lambda > 0) || !b.factorize_shifted(1, sigma)) {
    if (top.lambda == 0 && smallest_ritz == 0) e.status = ConditionStatus::singular;
    return;
  }
  const auto op = [&b](const VecXd& x, VecXd& y) { b.solve(b.matrix().shifted, x, y); };
  const LanczosEnd ritz =
      lanczos_largest(op, seeded_vector(b.n(), seed), most_lanczos_solves - 1, end_tolerance);
  VecXd v;
  b.solve(b.matrix().shifted, ritz.vector, v);
  v.normalize();
  e.lambda_min = b.rayleigh(v);
  classify(e, ritz.converged(end_tolerance));
}

/// The large end of B, before it is proven.
SpectrumEndPair largest_end(ScaledMatrix& b, const ConditionOptions& options) {
  SpectrumEndPair end;
  if (options.estimator == Estimator::spectra) {
    SpectraEnd found = spectra_largest(products_with(b), seeded_vector(b.n(), options.seed),
                                       options.max_products, end_tolerance);
    if (found.converged) {
      end.lambda = found.value;
      take(std::move(found), end);
      return end;
    }
  }
  double unused = 0;
  end = largest_by_lanczos(b, options.seed, most_lanczos_products - 2, unused);
  end.by_lanczos = options.estimator == Estimator::spectra;
  return end;
}

/// The small end of B, round the factor of A, before it is proven. solves_before: by Lanczos for the large end.
SpectrumEndPair smallest_end(ScaledMatrix& b, const ConditionOptions& options, int solves_before) {
  const SymmetricOperator solve = [&b](const VecXd& x, VecXd& y) { b.solve(b.matrix().factor, x, y); };
  const VecXd start = seeded_vector(b.n(), options.seed + 1);
  SpectrumEndPair end;
  if (options.estimator == Estimator::spectra) {
    SpectraEnd found = spectra_smallest_inverted(solve, start, options.max_solves, end_tolerance);
    if (found.converged) {
      end.lambda = 1 / found.value;
      take(std::move(found), end);
      return end;
    }
  }
  // what is left is for the shifted factor
  const int n_solves = most_lanczos_solves - solves_before - most_shifted_solves;
  const LanczosEnd ritz = lanczos_largest(solve, start, n_solves, end_tolerance);
  take(ritz, end);
  end.lambda = 1 / ritz.value;
  end.by_lanczos = options.estimator == Estimator::spectra;
  return end;
}

/// Proves an end, or looks for it beyond where it was found.
void settle(ScaledMatrix& b, double sign, double largest, SpectrumEndPair& end) {
  if (end.resolved) {
    prove_end(b, sign, largest, end);
  } else if (end.lambda > 0 && std::isfinite(end.lambda)) {
    resolve_by_shift(b, sign, largest, end);
  }
}

/// What found both ends, and which of them a factor proves.
void name_method(const SpectrumEndPair& bottom, const SpectrumEndPair& top, Estimator estimator,
                 ConditionEstimate& e) {
  e.method = estimator == Estimator::spectra ? "spectra" : "lanczos";
  const auto add = [&e](const SpectrumEndPair& end, const std::string& name) {
    if (end.by_lanczos) e.method += ", " + name + " by lanczos";
    if (end.shifted) e.method += ", " + name + " shifted to";
  };
  add(bottom, "smallest");
  add(top, "largest");
  e.proof = bottom.proven ? (top.proven ? ProvenEnds::both : ProvenEnds::smallest)
                          : (top.proven ? ProvenEnds::largest : ProvenEnds::none);
}

ConditionEstimate start_estimate(const char* method) {
  ConditionEstimate e;
  e.method = method;
  e.lambda_min = e.lambda_max = e.cond = not_known;
  return e;
}

}  // namespace

void classify(ConditionEstimate& e, bool resolved) {
  constexpr double kEps = std::numeric_limits<double>::epsilon();
  e.cond = not_known;
  if (!std::isfinite(e.lambda_min) || !std::isfinite(e.lambda_max)) {
    e.status = ConditionStatus::not_converged;
  } else if (e.lambda_min <= kEps * e.lambda_max) {
    // Entries of A are known to eps |A|: a smaller eigenvalue has no sign of its own.
    const bool negative = e.lambda_min < -1e-14 * std::abs(e.lambda_max) || e.lambda_max < 0;
    e.status = negative ? ConditionStatus::not_pd : ConditionStatus::singular;
  } else if (e.lambda_max > largest_known_cond * e.lambda_min) {
    e.cond = largest_known_cond;
    e.status = ConditionStatus::lower_bound;
  } else {
    e.cond = std::max(1.0, e.lambda_max / e.lambda_min);
    e.status = resolved ? ConditionStatus::ok : ConditionStatus::lower_bound;
  }
}

ConditionEstimate estimate_inverse_power(FactoredMatrix& matrix, const BlockScaling& scaling,
                                         std::uint64_t seed) {
  ConditionEstimate e = start_estimate("inverse_power+lanczos");
  ScaledMatrix b(matrix, scaling, e);
  double smallest_ritz = 0;
  const SpectrumEndPair top = largest_by_lanczos(b, seed, 20, smallest_ritz);
  // A Ritz value is inside the spectrum up to some eps |B|; 1e-12 covers that a thousand times.
  e.lambda_max = top.lambda * (1 - 1e-12);
  if (!matrix.positive) {
    estimate_without_factor(b, top, smallest_ritz, seed + 1, e);
  } else {
    VecXd v = seeded_vector(b.n(), seed + 1), next;
    for (int step = 0; step < 4; ++step) {
      b.solve(matrix.factor, v, next);
      v = next.normalized();
    }
    e.lambda_min = b.rayleigh(v);
    classify(e, false);
  }
  e.residual /= std::abs(e.lambda_max);
  return e;
}

ConditionEstimate estimate_ends(FactoredMatrix& matrix, const BlockScaling& scaling,
                                const ConditionOptions& options) {
  ConditionEstimate e = start_estimate("lanczos");
  ScaledMatrix b(matrix, scaling, e);
  if (!matrix.positive) {  // nothing to shift and invert
    double smallest_ritz = 0;
    const SpectrumEndPair top = largest_by_lanczos(b, options.seed, most_lanczos_products - 2, smallest_ritz);
    e.lambda_max = top.lambda;
    estimate_without_factor(b, top, smallest_ritz, options.seed + 1, e);
    e.residual /= std::abs(e.lambda_max);
    return e;
  }
  SpectrumEndPair top = largest_end(b, options);
  settle(b, -1, top.lambda, top);
  SpectrumEndPair bottom = smallest_end(b, options, e.solves);
  settle(b, 1, top.lambda, bottom);
  // Damps what a product with B would magnify.
  if (!bottom.shifted) {
    const VecXd found = bottom.vector;
    b.solve(matrix.factor, found, bottom.vector);
  }
  bottom.vector.normalize();
  top.vector.normalize();
  const double rayleigh_min = b.rayleigh(bottom.vector), rayleigh_max = b.rayleigh(top.vector);
  // Solves leave an error of eps cond in 1 / theta; the Rayleigh quotient does not, once its vector is
  // polished. Kept unless a factorisation has proven more.
  const bool bottom_stands = bottom.resolved && !(rayleigh_min > bottom.proven_inside);
  e.lambda_min = bottom_stands ? rayleigh_min : bottom.lambda;
  const bool top_stands = !(rayleigh_max < top.proven_inside);
  e.lambda_max = top_stands ? rayleigh_max : top.lambda;
  name_method(bottom, top, options.estimator, e);
  classify(e, bottom.resolved && top.resolved);
  e.residual /= std::abs(e.lambda_max);
  return e;
}

}  // namespace bb
