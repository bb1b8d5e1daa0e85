#include "core/linear/end_vectors.hpp"

#include "core/linear/block_scaling.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/lanczos.hpp"
#include "core/linear/symmetric_product.hpp"

namespace bb {
namespace {

constexpr double tolerance = 1e-6;    // residual relative to the eigenvalue, aimed at
constexpr double good_enough = 1e-2;  // the same, required
constexpr int most_solves = 60, most_products = 300;

std::optional<EndVector> unscale(const LanczosEnd& end, double lambda, const BlockScaling& scaling) {
  if (!end.converged(good_enough)) return std::nullopt;
  EndVector out{end.vector.normalized(), {}, lambda};
  out.unscaled = out.vector;
  scaling.solve_upper(out.unscaled);
  return out;
}

}  // namespace

std::optional<EndVectors> end_vectors(const ReducedSystem& system, Scaling kind, std::uint64_t seed) try {
  BlockScaling scaling;
  CholmodFactor factor;
  const Eigen::Index n = system.lower.rows();
  if (n == 0 || scaling.setup(system, kind) != LinearStatus::ok) return std::nullopt;
  if (factor.factorize(system) != LinearStatus::ok) return std::nullopt;
  SymmetricProduct product;
  product.update(system);

  VecXd work;
  const auto multiply = [&](const VecXd& v, VecXd& out) {
    work = v;
    scaling.solve_upper(work);
    product.multiply(work, out);
    scaling.solve_lower(out);
  };
  const auto solve = [&](const VecXd& v, VecXd& out) {
    work = v;
    scaling.multiply_lower(work);
    factor.solve(work, out);
    scaling.multiply_upper(out);
  };
  const VecXd start = seeded_vector(n, seed);
  const LanczosEnd low = lanczos_largest(solve, start, most_solves, tolerance);
  const LanczosEnd high = lanczos_largest(multiply, start, most_products, tolerance);
  auto smallest = unscale(low, 1 / low.value, scaling);
  auto largest = unscale(high, high.value, scaling);
  if (!smallest || !largest) return std::nullopt;
  return EndVectors{std::move(*smallest), std::move(*largest)};
} catch (const FactorTooLarge&) {
  return std::nullopt;
}

}  // namespace bb
