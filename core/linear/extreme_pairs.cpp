#include "core/linear/extreme_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/linear/lanczos.hpp"

namespace bb {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
constexpr double kTol = 2e-4;        // of an eigenvalue, relative; half of the 1e-3 promised is left to spare
constexpr double kProof = 8e-4;      // of an eigenvalue, relative: distance of a shift that certifies it
constexpr double kProvable = 1e-13;  // of lambda_max: a shift below it is decided by rounding
constexpr int kMaxShifts = 6;        // from the narrowest interval to the widest in steps of six
constexpr int kMaxProofs = 12;     // factorisations that certify one end: from the widest interval to kProof
constexpr int kMaxSolves = 25;     // tier 2
constexpr int kMaxProducts = 40;   // tier 2
constexpr int kShiftedSolves = 5;  // round a shifted factor, plus one that polishes the vector
constexpr double kRetryShift = 1e-8;  // of lambda_max, when A itself cannot be factorised

/// B and its inverses, counting every use.
class ScaledMatrix {
 public:
  ScaledMatrix(FactoredMatrix& matrix, const BlockScaling& scaling, ConditionEstimate& counts)
      : m_(matrix), s_(scaling), counts_(counts) {}

  void multiply(const VecXd& v, VecXd& out) {
    u_ = v;
    s_.solve_upper(u_);
    m_.product.multiply(u_, out);
    s_.solve_lower(out);
    ++counts_.products;
  }
  void solve(CholmodFactor& factor, const VecXd& v, VecXd& out) {
    u_ = v;
    s_.multiply_lower(u_);
    factor.solve(u_, out);
    s_.multiply_upper(out);
    ++counts_.solves;
  }
  /// Rayleigh quotient of B at v in long double: accurate to 1e-18 |B|, where double would leave 1e-16 |B|.
  /// The residual |B v - lambda v| / |v| is raised in counts.residual, still absolute.
  double rayleigh(const VecXd& v) {
    u_ = v;
    s_.solve_upper(u_);
    m_.product.multiply_long(u_, au_);
    ++counts_.products;
    long double numerator = 0;
    for (Eigen::Index i = 0; i < u_.size(); ++i) numerator += au_[static_cast<std::size_t>(i)] * u_[i];
    const double lambda = static_cast<double>(numerator / s_.quadratic(u_));
    VecXd bv(u_.size());
    for (Eigen::Index i = 0; i < u_.size(); ++i)
      bv[i] = static_cast<double>(au_[static_cast<std::size_t>(i)]);
    s_.solve_lower(bv);
    counts_.residual = std::max(counts_.residual, (bv - lambda * v).norm() / v.norm());
    return lambda;
  }
  /// Factorises sign * (A - sigma D).
  bool factorize_shifted(double sign, double sigma) {
    m_.shifted_system.lower = m_.system->lower;
    m_.shifted_system.block_start = m_.system->block_start;
    m_.shifted_system.pattern_id = m_.system->pattern_id;
    s_.add_to(m_.shifted_system.lower, sign, -sign * sigma);
    ++counts_.factorizations;
    return m_.shifted.factorize(m_.shifted_system) == LinearStatus::ok;
  }

  FactoredMatrix& matrix() { return m_; }
  Eigen::Index n() const { return m_.product.n(); }

 private:
  FactoredMatrix& m_;
  const BlockScaling& s_;
  ConditionEstimate& counts_;
  VecXd u_;
  std::vector<long double> au_;
};

/// One end of the spectrum on its way.
struct End {
  double lambda = not_known;
  VecXd vector;
  bool resolved = false;
  bool shifted = false;              // found round a factorisation of its own
  double uncertainty = 0;            // residual relative to the eigenvalue of the operator in use
  double proven_inside = not_known;  // the end is known to lie beyond this; NaN when nothing is proven
};

void take(const LanczosEnd& ritz, End& end) {
  end.vector = ritz.vector;
  end.resolved = ritz.converged(kTol);
  end.uncertainty = ritz.residual / std::abs(ritz.value);
}

/// Where a factor proves the end of the spectrum to lie: between `outside` (the factor exists) and `inside`.
/// Halved until it is kProof wide, first tried right beyond `inside`, where a Ritz value usually sits.
void certify(ScaledMatrix& b, double sign, double outside, End& end) {
  // A failed shift may have proven more than the Ritz value.
  const bool known = sign * (end.lambda - end.proven_inside) > 0;
  double inside = known ? end.proven_inside : end.lambda;
  const auto wide = [&] { return std::abs(inside - outside) > kProof * std::abs(inside); };
  const double close = inside * (1 - 0.99 * sign * kProof);
  for (int test = 0; test < kMaxProofs && wide(); ++test) {
    const double sigma = test == 0 ? close : inside + (outside - inside) / 2;
    (b.factorize_shifted(sign, sigma) ? outside : inside) = sigma;
  }
  end.resolved = !wide();
  if (inside == end.lambda) return;
  end.proven_inside = inside;
  end.lambda = inside + (outside - inside) / 2;
}

/// Whether the shift that proves an end is above the rounding of its factorisation.
bool provable(const End& end, double largest) { return kProof * std::abs(end.lambda) > kProvable * largest; }

/// Shifts just beyond the end that `end` approximates from inside and repeats Lanczos from its vector. A
/// factor that exists proves the shift to lie beyond the whole spectrum, one that does not exist that it lies
/// inside.
/// @param sign +1 the small end, A - sigma D; -1 the large end, sigma D - A
void resolve_by_shift(ScaledMatrix& b, double sign, double largest, End& end) {
  end.shifted = true;
  // Where eigenvalues lie dense the error is about a third of the residual; a failed factorisation tells if
  // not: the start vector had next to nothing of the last eigenvector.
  double width = std::clamp(end.uncertainty, 5e-4, 0.3);
  const double start = end.lambda;
  double sigma = start * (1 - sign * width);
  for (int shift = 1; !b.factorize_shifted(sign, sigma); ++shift) {
    if (shift == kMaxShifts) return;
    end.proven_inside = sigma;
    width = std::min(6 * width, 0.9);
    sigma = start * (1 - sign * width);
  }
  const auto op = [&b](const VecXd& x, VecXd& y) { b.solve(b.matrix().shifted, x, y); };
  // d lambda / lambda = width * d theta / theta, so the operator's own tolerance may be wider by 1 / width.
  const double tol = std::min(kTol / width, 0.05);
  const LanczosEnd ritz = lanczos_largest(op, end.vector, kShiftedSolves, tol);
  if (!(ritz.value > 0)) return;
  b.solve(b.matrix().shifted, ritz.vector, end.vector);
  end.lambda = sigma + sign / ritz.value;
  const bool disproven = sign * (end.lambda - end.proven_inside) > 0;
  end.resolved = ritz.converged(tol) && !disproven;
  if (!end.resolved || provable(end, largest)) certify(b, sign, sigma, end);
}

/// A small residual may belong to a neighbour of the end. A factor of the matrix shifted by kProof beyond it
/// exists only when nothing lies there; without one the end is looked for again. Not asked where the shift is
/// within the rounding of the factorisation.
void prove_end(ScaledMatrix& b, double sign, double largest, End& end) {
  if (!provable(end, largest)) return;
  const double sigma = end.lambda * (1 - sign * kProof);
  if (b.factorize_shifted(sign, sigma)) return;
  end.resolved = false;
  end.proven_inside = sigma;
  end.uncertainty = 6 * kProof;
  resolve_by_shift(b, sign, largest, end);
}

End largest_end(ScaledMatrix& b, std::uint64_t seed, int n_products, double& smallest_ritz) {
  const auto op = [&b](const VecXd& x, VecXd& y) { b.multiply(x, y); };
  const LanczosEnd ritz = lanczos_largest(op, seeded_vector(b.n(), seed), n_products, kTol);
  smallest_ritz = ritz.smallest;
  End end;
  take(ritz, end);
  end.lambda = ritz.value;
  return end;
}

/// B + kRetryShift lambda_max is factorised in place of B; lambda_min may then be of either sign.
void estimate_without_factor(ScaledMatrix& b, const End& top, double smallest_ritz, std::uint64_t seed,
                             ConditionEstimate& e) {
  e.method = "shift_invert, sigma = -1e-8 lambda_max";
  e.status = ConditionStatus::not_pd;
  e.lambda_min = smallest_ritz < 0 ? smallest_ritz : not_known;  // a negative Ritz value proves the point
  e.cond = not_known;
  const double sigma = -kRetryShift * top.lambda;
  if (!(top.lambda > 0) || !b.factorize_shifted(1, sigma)) {
    if (top.lambda == 0 && smallest_ritz == 0) e.status = ConditionStatus::singular;
    return;
  }
  const auto op = [&b](const VecXd& x, VecXd& y) { b.solve(b.matrix().shifted, x, y); };
  const LanczosEnd ritz = lanczos_largest(op, seeded_vector(b.n(), seed), kMaxSolves - 1, kTol);
  VecXd v;
  b.solve(b.matrix().shifted, ritz.vector, v);
  v.normalize();
  e.lambda_min = b.rayleigh(v);
  classify(e, ritz.converged(kTol));
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

ConditionEstimate estimate_tier1(FactoredMatrix& matrix, const BlockScaling& scaling, std::uint64_t seed) {
  ConditionEstimate e = start_estimate("inverse_power+lanczos");
  ScaledMatrix b(matrix, scaling, e);
  double smallest_ritz = 0;
  const End top = largest_end(b, seed, 20, smallest_ritz);
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

ConditionEstimate estimate_tier2(FactoredMatrix& matrix, const BlockScaling& scaling, std::uint64_t seed) {
  ConditionEstimate e = start_estimate("shift_invert");
  ScaledMatrix b(matrix, scaling, e);
  double smallest_ritz = 0;
  End top = largest_end(b, seed, kMaxProducts - 2, smallest_ritz);
  e.lambda_max = top.lambda;
  if (!matrix.positive) {
    estimate_without_factor(b, top, smallest_ritz, seed + 1, e);
    e.residual /= std::abs(e.lambda_max);
    return e;
  }
  if (top.resolved) {
    prove_end(b, -1, top.lambda, top);
  } else if (top.lambda > 0) {
    resolve_by_shift(b, -1, top.lambda, top);
  }
  const auto op = [&b, &matrix](const VecXd& x, VecXd& y) { b.solve(matrix.factor, x, y); };
  const int n_solves = kMaxSolves - e.solves - (kShiftedSolves + 1);  // the rest is for the shifted factor
  const LanczosEnd ritz = lanczos_largest(op, seeded_vector(b.n(), seed + 1), n_solves, kTol);
  End bottom;
  take(ritz, bottom);
  bottom.lambda = 1 / ritz.value;
  if (bottom.resolved) {
    prove_end(b, 1, top.lambda, bottom);
  } else if (ritz.value > 0) {
    resolve_by_shift(b, 1, top.lambda, bottom);
  }
  // Damps what a product with B would magnify.
  if (!bottom.shifted) b.solve(matrix.factor, ritz.vector, bottom.vector);
  bottom.vector.normalize();
  top.vector.normalize();
  const double rayleigh_min = b.rayleigh(bottom.vector), rayleigh_max = b.rayleigh(top.vector);
  // Solves leave an error of eps cond in 1 / theta; the Rayleigh quotient does not, once its vector is
  // polished. Kept unless a factorisation has proven more.
  const bool bottom_stands = bottom.resolved && !(rayleigh_min > bottom.proven_inside);
  e.lambda_min = bottom_stands ? rayleigh_min : bottom.lambda;
  const bool top_stands = !(rayleigh_max < top.proven_inside);
  e.lambda_max = top_stands ? rayleigh_max : top.lambda;
  if (top.shifted || bottom.shifted) e.method = "shift_invert, shifted to the end of the spectrum";
  classify(e, bottom.resolved && top.resolved);
  e.residual /= std::abs(e.lambda_max);
  return e;
}

}  // namespace bb
