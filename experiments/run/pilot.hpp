// The pilot of matching: the scene once with the log barrier. Its states say which contacts and limited
// elements carry loads (pilot_demand.hpp), from which a matching rule makes stiffness (calibration.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/run/method.hpp"
#include "experiments/run/runner.hpp"

namespace bb {

/// What the weight alone asks for: the pilot starts from it, and it stands in where the pilot found nothing.
struct StaticLoads {
  double contact = 0;  // N per free vertex
  double limit = 0;    // N/m, weight over the side of a square of the limited area; 0 without a limit
};

/// What the pilot leaves. Memory: 24 bytes a vertex and step.
struct Pilot {
  RunConfig config;       // its own
  Calibration stiffness;  // kappa and k_s of its log barriers
  StaticLoads rest;
  std::vector<double> c;     // inertia weight of the integrator in each converged step
  std::vector<Positions> x;  // m, at the start, then at the end of each converged step
  std::string config_id;
  std::string stopped;  // why it ended early; empty when it did not

  int steps() const { return static_cast<int>(x.size()) - 1; }
};

/// The barrier of the pilot, to which the rules compare others.
BarrierFunction log_barrier();

/// Runs the pilot of this config, or returns the one that is known: pilots are kept by config id for the life
/// of the process, so that the formulations of a sweep share one.
/// Errors: ConfigError when the scene has no weight to start from; Interrupted.
const Pilot& run_pilot(const RunConfig& config, const Scene& scene, const RunOptions& options);

/// kappa (N/m) from which a policy with one global kappa starts in the run of this very config, unscaled:
/// the run is followed to its first contact, up to which the scale cannot change it. Nothing when it meets
/// none. Errors: ConfigError of the policy; Interrupted.
std::optional<double> policy_start(const RunConfig& config, const Scene& scene,
                                   const Calibration& calibration, const RunOptions& options);

}  // namespace bb
