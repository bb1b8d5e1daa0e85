// How kappa is chosen so that formulations are comparable, and what a single contact does under a load.
// Generic over BarrierFunction: no formula of a shape is written here. Host only, cold paths.
#pragma once

#include <optional>
#include <string_view>

#include "core/barrier/shape.hpp"

namespace bb {

/// The kappa-free law of a shape: rho(u) = d_hat b''(d)/|b'(d)| at d = u d_hat, so that a contact at rest
/// under load f has stiffness K = rho(u) f/d_hat. Errors: ConfigError unless 0 < u < 1 and b' is finite and
/// not 0 there. Source: docs/design.md, Matching; any shape.
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

/// kappa (N/m) from the constant of a published convention; `key` names it as configs do:
///   kappa_N_per_m        kappa itself
///   kappa_a_J            kappa_a (1 - d/d_hat)^3 with shape cubic: 3 kappa_a/(2 d_hat^2)
///   kappa_p_N            kappa_p/(2 d_hat) (d - d_hat)^2 with shape quadratic: kappa_p/(2 d_hat)
///   kappa_ipc_N_per_m3   kappa_IPC f(d^2; d_hat^2) with argument squared_gap: kappa_IPC d_hat^2
/// Errors: ConfigError at the key for another key, a value that is not > 0 or d_hat not > 0.
double kappa_from_convention(std::string_view key, double value, double d_hat);

}  // namespace bb
