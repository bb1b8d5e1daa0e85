// From a run's config and what matching found to the Method that Newton runs.
#pragma once

#include <memory>
#include <optional>

#include "core/newton/method.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// What the matching rule decided; absent values are taken from the config.
struct Calibration {
  std::optional<double> kappa;  // N/m, fixed contact stiffness
  std::optional<double> k_s;    // N/m, fixed limit stiffness
  double scale = 1;             // factor on a contact policy that makes its own kappa
  double limit_scale = 1;       // factor on a limit policy that makes its own kappa_e
  bool limited = true;          // false: no element has a limit, so that its stiffness is never read
};

/// Errors: ConfigError when a fixed stiffness is neither given nor calibrated.
Method make_method(const RunConfig& config, const Calibration& calibration);

/// The two policies alone. Errors: as make_method.
std::unique_ptr<StiffnessPolicy> make_contact_policy(const PolicyConfig& policy,
                                                     const Calibration& calibration);
/// Null where no element has a limit.
std::unique_ptr<StiffnessPolicy> make_limit_policy(const PolicyConfig& policy,
                                                   const Calibration& calibration);

}  // namespace bb
