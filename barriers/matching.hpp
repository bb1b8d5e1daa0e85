// How kappa is chosen so that formulations are comparable, and what a single contact does under a load.
// Generic over BarrierFunction: no formula of a shape is written here. Host only, cold paths.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/barrier/shape.hpp"

namespace bb {

/// The kappa-free law of a shape: rho(u) = d_hat b''(d)/|b'(d)| at d = u d_hat, so that a contact at rest
/// under load f has stiffness K = rho(u) f/d_hat. Errors: ConfigError unless 0 < u < 1 and b' is finite and
/// not 0 there. Source: docs/theory/barriers.md, Matching; any shape.
double rho(const BarrierFunction& barrier, double u);

/// Rest state of one contact of stiffness kappa under a load.
struct Equilibrium {
  bool above_capacity = false;      // load >= capacity: no rest state, d and stiffness are absent
  std::optional<double> d;          // m, the largest gap with kappa |b'(d)| = load
  std::optional<double> stiffness;  // N/m, K = kappa b''(d); negative where the force falls towards contact
  std::optional<double> capacity;   // N, sup of kappa |b'|; absent when unbounded
};

/// Largest gap in balance, by scanning from d_hat down and bisection to adjacent doubles.
/// @param kappa N/m > 0   @param d_hat m > 0   @param load N > 0
/// Errors: ConfigError for other values. Cost: about 2,000 evaluations of the shape.
Equilibrium equilibrium(const BarrierFunction& barrier, double kappa, double d_hat, double load);

/// Matching rule equal_force: kappa (N/m) = load/|b'(theta d_hat)|.
/// Errors: ConfigError unless load > 0, d_hat > 0, 0 < theta < 1 and b' is finite and not 0 there.
double match_equal_force(const BarrierFunction& barrier, double d_hat, double load, double theta = 0.1);

/// Matching rule equal_curvature: kappa (N/m) = curvature/b''(theta d_hat), curvature in N/m.
/// Errors: ConfigError unless curvature > 0, d_hat > 0, 0 < theta < 1 and b'' is finite and > 0 there.
double match_equal_curvature(const BarrierFunction& barrier, double d_hat, double curvature,
                             double theta = 0.5);

/// A published constant that a fixed kappa can be given by instead, and the formulation it was published for.
struct KappaConvention {
  std::string name;  // of the setting
  std::string unit, doc;
  std::string shape;  // empty: any
  std::string argument;
  double (*kappa)(double value, double d_hat);  // N/m; both > 0
};
const std::vector<KappaConvention>& kappa_conventions();

}  // namespace bb
