// Matching rules and the rest state of one contact.
#include "barriers/matching.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "barriers/named_entries.hpp"

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

/// A gap with the slope |b'| (m) and the curvature b'' there.
struct Sample {
  double d, slope, d2b;
};
Sample sample(const BarrierFunction& barrier, double d, double d_hat) {
  const ShapeTerms<double> terms = barrier.eval(d, d_hat);
  return {d, std::abs(terms.db), terms.d2b};
}

/// Halves [near, far] (far < near) down to adjacent doubles, keeping `beyond` false at near and true at far.
template <class Predicate>
void bisect(const BarrierFunction& barrier, double d_hat, Sample& near, Sample& far, Predicate beyond) {
  for (;;) {
    const double middle = far.d + (near.d - far.d) / 2;
    if (middle <= far.d || middle >= near.d) return;
    const Sample s = sample(barrier, middle, d_hat);
    (beyond(s) ? far : near) = s;
  }
}

/// Gaps in units of d_hat from 1 down to 0: a factor of two apart towards both ends, evenly spaced between,
/// so that the scale of any load is met and a hump wider than 1/256 is seen.
std::vector<double> ladder() {
  constexpr int even = 256;
  std::vector<double> u;
  for (int k = 53; k > 8; --k) u.push_back(1 - std::ldexp(1.0, -k));
  for (int i = even - 1; i > 0; --i) u.push_back(static_cast<double>(i) / even);
  for (int k = 9; k <= 1022; ++k) u.push_back(std::ldexp(1.0, -k));
  u.push_back(0);
  return u;
}

/// Samples from d_hat down, with the points where |b'| peaks (b'' changes sign) put in at full precision.
std::vector<Sample> scan(const BarrierFunction& barrier, double d_hat) {
  std::vector<Sample> samples;
  for (const double u : ladder()) {
    const Sample next = sample(barrier, u * d_hat, d_hat);
    if (!samples.empty()) {
      Sample near = samples.back(), far = next;
      if (near.d2b > 0 && far.d2b <= 0) {
        bisect(barrier, d_hat, near, far, [](const Sample& s) { return s.d2b <= 0; });
        samples.push_back(near.slope > far.slope ? near : far);
      }
    }
    samples.push_back(next);
    if (!std::isfinite(next.slope)) break;
  }
  return samples;
}

std::optional<double> max_slope_of(const BarrierFunction& barrier, const std::vector<Sample>& samples) {
  // b infinite at 0 over a bounded interval has an unbounded derivative
  if (barrier.shape.infinite_at_zero) return std::nullopt;
  double slope = 0;
  for (const Sample& s : samples) slope = std::max(slope, s.slope);
  if (!std::isfinite(slope)) return std::nullopt;
  return slope;
}

}  // namespace

double rho(const BarrierFunction& barrier, double u) {
  const ShapeTerms<double> terms = inside(barrier, 1.0, u, "u");
  return terms.d2b / slope_inside(barrier, 1.0, u, "u");
}

std::optional<double> max_slope(const BarrierFunction& barrier, double d_hat) {
  require(positive(d_hat), "d_hat", d_hat, "a number > 0");
  return max_slope_of(barrier, scan(barrier, d_hat));
}

Equilibrium equilibrium(const BarrierFunction& barrier, double kappa, double d_hat, double load) {
  require(positive(kappa), "kappa", kappa, "a number > 0");
  require(positive(d_hat), "d_hat", d_hat, "a number > 0");
  require(positive(load), "load", load, "a number > 0");
  const std::vector<Sample> samples = scan(barrier, d_hat);
  const double target = load / kappa;

  Equilibrium result;
  if (const std::optional<double> slope = max_slope_of(barrier, samples)) {
    result.capacity = kappa * *slope;
    result.above_capacity = load >= *result.capacity;
  }
  const auto carries = [target](const Sample& s) { return s.slope >= target; };
  const auto first = std::find_if(samples.begin(), samples.end(), carries);
  if (result.above_capacity || first == samples.end()) {
    result.above_capacity = true;
    return result;
  }
  Sample far = *first;
  Sample near = first == samples.begin() ? sample(barrier, d_hat, d_hat) : *(first - 1);
  bisect(barrier, d_hat, near, far, carries);
  // The root lies between two adjacent doubles: interpolate the curvature, which near d_hat varies by more
  // than the rounding of d allows for.
  const double t = far.slope > near.slope && std::isfinite(far.slope)
                       ? (target - near.slope) / (far.slope - near.slope)
                       : 1.0;
  const bool at_edge = near.d >= d_hat;
  result.d = t < 0.5 && !at_edge ? near.d : far.d;
  result.stiffness = kappa * (at_edge ? far.d2b : near.d2b + t * (far.d2b - near.d2b));
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

double kappa_from_convention(std::string_view key, double value, double d_hat) {
  struct Convention {
    std::string name;
    double kappa;
  };
  const std::vector<Convention> conventions{{"kappa_N_per_m", value},
                                            {"kappa_a_J", 3 * value / (2 * d_hat * d_hat)},
                                            {"kappa_p_N", value / (2 * d_hat)},
                                            {"kappa_ipc_N_per_m3", value * d_hat * d_hat}};
  const Convention& convention = require_entry(conventions, key, "stiffness_policy");
  require(positive(value), convention.name.c_str(), value, "a number > 0");
  require(positive(d_hat), "d_hat", d_hat, "a number > 0");
  return convention.kappa;
}

}  // namespace bb
