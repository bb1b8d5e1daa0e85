// Matching rules and the rest state of one contact.
#include "barriers/matching.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/barrier/slope_scan.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

void require(bool ok, const char* where, double found, const char* allowed) {
  if (!ok) throw ConfigError(where, fmt::format("{}", found), allowed);
}
bool positive(double value) { return value > 0 && std::isfinite(value); }

/// Terms at theta d_hat, inside the support.
ShapeTerms<double> inside(const BarrierFunction& barrier, double d_hat, double theta, const char* name) {
  require(positive(d_hat), "d_hat", d_hat, "a number > 0");
  require(theta > 0 && theta < 1, name, theta, "a number in (0, 1)");
  return barrier.eval(theta * d_hat, d_hat);
}

double slope_inside(const BarrierFunction& barrier, double d_hat, double theta, const char* name) {
  const double slope = std::abs(inside(barrier, d_hat, theta, name).db);
  require(positive(slope), name, theta, "a value where b' is finite and not 0");
  return slope;
}

}  // namespace

double rho(const BarrierFunction& barrier, double u) {
  const ShapeTerms<double> terms = inside(barrier, 1.0, u, "u");
  return terms.d2b / slope_inside(barrier, 1.0, u, "u");
}

Equilibrium equilibrium(const BarrierFunction& barrier, double kappa, double d_hat, double load) {
  require(positive(kappa), "kappa", kappa, "a number > 0");
  require(positive(d_hat), "d_hat", d_hat, "a number > 0");
  require(positive(load), "load", load, "a number > 0");
  const std::vector<SlopeSample> samples = scan_slope(barrier, d_hat);
  const double target = load / kappa;

  Equilibrium result;
  if (const std::optional<double> slope = max_slope(barrier, samples)) {
    result.capacity = kappa * *slope;
    result.above_capacity = load >= *result.capacity;
  }
  const auto carries = [target](const SlopeSample& s) { return s.slope >= target; };
  const auto first = std::find_if(samples.begin(), samples.end(), carries);
  if (result.above_capacity || first == samples.end()) {
    result.above_capacity = true;
    return result;
  }
  SlopeSample far = *first;
  SlopeSample near = first == samples.begin() ? slope_sample(barrier, d_hat, d_hat) : *(first - 1);
  bisect_slope(barrier, d_hat, near, far, carries);
  // The root lies between two adjacent doubles: interpolate the curvature, which near d_hat varies by more
  // than the rounding of d allows for.
  const double t = far.slope > near.slope && std::isfinite(far.slope)
                       ? (target - near.slope) / (far.slope - near.slope)
                       : 1.0;
  const bool at_edge = near.d >= d_hat, unbounded = std::isinf(far.d2b);
  result.d = t < 0.5 && !at_edge ? near.d : far.d;
  result.stiffness = kappa * (at_edge || unbounded ? far.d2b : near.d2b + t * (far.d2b - near.d2b));
  return result;
}

double match_equal_force(const BarrierFunction& barrier, double d_hat, double load, double theta) {
  require(positive(load), "load", load, "a number > 0");
  return load / slope_inside(barrier, d_hat, theta, "theta");
}

double match_equal_curvature(const BarrierFunction& barrier, double d_hat, double curvature, double theta) {
  require(positive(curvature), "curvature", curvature, "a number > 0");
  const double d2b = inside(barrier, d_hat, theta, "theta").d2b;
  require(positive(d2b), "theta", theta, "a value where b'' is finite and > 0");
  return curvature / d2b;
}

const std::vector<KappaConvention>& kappa_conventions() {
  static const std::vector<KappaConvention> list = {
      {"kappa_a_J", "J", "kappa_a (1 - d/d_hat)^3, shape cubic", "cubic", "gap",
       [](double value, double d_hat) { return 3 * value / (2 * d_hat * d_hat); }},
      {"kappa_p_N", "N", "kappa_p/(2 d_hat) (d - d_hat)^2, shape quadratic", "quadratic", "gap",
       [](double value, double d_hat) { return value / (2 * d_hat); }},
      {"kappa_ipc_N_per_m3", "N/m^3", "kappa_IPC f(d^2; d_hat^2), argument squared_gap", "", "squared_gap",
       [](double value, double d_hat) { return value * d_hat * d_hat; }},
  };
  return list;
}

}  // namespace bb
