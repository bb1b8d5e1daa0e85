// How checks across sections say what contradicts what, and those that have a file of their own.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/barrier/shape.hpp"
#include "core/math/error.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// Appends violations whose place is a pointer into the file `source`.
struct Complain {
  const std::string& source;
  std::vector<Violation>& violations;
  void operator()(const std::string& pointer, std::string found, std::string allowed) const {
    violations.push_back({source + "#" + pointer, std::move(found), std::move(allowed)});
  }
};

/// A barrier of a known shape; nothing for an unknown name, which has a violation already.
std::optional<BarrierFunction> barrier_of(const std::string& shape, Argument argument);
/// Says of every restitution below 1 what is allowed.
void refuse_restitution(const RunConfig& config, const std::string& allowed, const Complain& complain);
/// Whether some coefficient of friction is above 0.
bool has_friction(const RunConfig& config);
/// Says of every coefficient of friction above 0 what is allowed.
void refuse_friction(const RunConfig& config, const std::string& allowed, const Complain& complain);
/// What coefficients, laws and the lagging of friction require of each other and of the step solver (check_friction.cpp).
void check_friction(const RunConfig& config, const Complain& complain);
/// Names of the step solvers whose steps end in a minimum of E.
std::string solvers_with_minimum();
/// Names of the step solvers whose contact rows carry forces at the end of a step.
std::string solvers_with_forces();
/// What files beside the record require (check_output.cpp).
void check_output(const RunConfig& config, const Complain& complain);
/// What steps of chosen length require of the other sections (check_step_size.cpp).
void check_step_size(const RunConfig& config, const Complain& complain);
/// What a step solver requires of the other sections (check_step_solver.cpp).
void check_step_solver(const RunConfig& config, const Complain& complain);
/// What matching requires of them (check_matching.cpp).
void check_matching(const RunConfig& config, const Complain& complain);
/// What kernels do not have (check_device.cpp).
void check_device(const RunConfig& config, const Complain& complain);

}  // namespace bb
