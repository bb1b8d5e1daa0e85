// The pilot of matching: the scene once with the log barrier, for the loads that the rules work with and for
// the contact and the limited element that carried them (calibration.hpp).
#pragma once

#include <optional>
#include <string>

#include "core/energy/strain_stiffness.hpp"
#include "core/newton/stiffness_update.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/runner.hpp"

namespace bb {

/// What the weight alone asks for: the pilot starts from it, and it stands in where the pilot found nothing.
struct StaticLoads {
  double contact = 0;  // N per free vertex
  double limit = 0;    // N/m, weight over the side of a square of the limited area; 0 without a limit
};

/// A limited element as a policy of the limit sees it.
struct LimitColumns {
  Vec3d x[3];                 // m, at the start of the step
  Mat<double, 9, 9> hessian;  // of the assembled elastic matrix, N/m
  Vec3d vertex_mass;          // kg
  double element_mass = 0;    // kg
  double area = 0;            // m^2, at rest
};

/// What the pilot leaves: largest loads over converged states, and who carried them.
struct PilotLoads {
  double contact = 0;  // N, kappa |b'| per unit multiplicity; 0: it met no contact
  double limit = 0;    // N/m; 0: the limit was never active
  StaticLoads rest;
  double dt = 0, c = 1;  // s, inertia weight of the integrator
  PolicyColumns row;     // the contact; read only when contact > 0
  LimitColumns element;  // the limited element; read only when limit > 0
  std::string config_id;
  std::string stopped;  // why it ended early; empty when it did not
};

/// The barrier of the pilot, to which the rules compare others.
BarrierFunction log_barrier();

/// Runs the pilot of this config, or returns the one that is known: pilots are kept by config id for the life
/// of the process, so that the formulations of a sweep share one.
/// Errors: ConfigError when the scene has no weight to start from; Interrupted.
const PilotLoads& run_pilot(const RunConfig& config, const Scene& scene, const RunOptions& options);

/// kappa (N/m) from which a policy with one global kappa starts in the run of this very config, unscaled:
/// the run is followed to its first contact, up to which the scale cannot change it. Nothing when it meets
/// none. Errors: ConfigError of the policy; Interrupted.
std::optional<double> policy_start(const RunConfig& config, const Scene& scene,
                                   const Calibration& calibration, const RunOptions& options);

}  // namespace bb
