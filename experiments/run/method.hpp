// From a run's config and what matching found to the Method that Newton runs.
#pragma once

#include <optional>

#include "core/newton/method.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// What the matching rule decided; absent values are taken from the config.
struct Calibration {
  std::optional<double> kappa;  // N/m, fixed contact stiffness
  std::optional<double> k_s;    // N/m, fixed limit stiffness
  double scale = 1;             // factor on a contact policy that makes its own kappa
};

/// Errors: ConfigError when a fixed stiffness is neither given nor calibrated.
Method make_method(const RunConfig& config, const Calibration& calibration);

/// True when the contact (limit) stiffness is a number that somebody has to supply.
bool needs_kappa(const PolicyConfig& policy);

}  // namespace bb
