// From a run's config and what matching found to the Method that Newton runs.
#pragma once

#include <memory>
#include <optional>

#include "core/newton/method.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// What the matching rule decided; absent values are taken from the config.
struct Calibration {
  std::optional<double> kappa;      // N/m, fixed contact stiffness
  std::optional<double> k_s;        // N/m, fixed limit stiffness
  double scale = 1;                 // factor on a contact policy that makes its own kappa
  double limit_scale = 1;           // factor on a limit policy that makes its own kappa_e
  bool limited = true;              // false: no triangle has a limit, so that its stiffness is never read
  std::optional<double> solid_k_s;  // Pa, fixed limit stiffness of solids
};

/// Errors: ConfigError when a fixed stiffness is neither given nor calibrated.
Method make_method(const RunConfig& config, const Calibration& calibration);

/// What contact reads of a config, for a run and for whoever looks at its start.
ContactOptions contact_options(const ContactConfig& contact);

/// The two policies alone. Errors: as make_method.
std::unique_ptr<StiffnessPolicy> make_contact_policy(const PolicyConfig& policy,
                                                     const Calibration& calibration);
/// Null where no triangle has a limit.
std::unique_ptr<StiffnessPolicy> make_limit_policy(const PolicyConfig& policy,
                                                   const Calibration& calibration);
/// That of tetrahedra; null where the limit does not act on solids.
std::unique_ptr<StiffnessPolicy> make_solid_limit_policy(const StrainLimitConfig& limit,
                                                         const Calibration& calibration);

}  // namespace bb
