// How checks across sections say what contradicts what, and those that have a file of their own.
#pragma once

#include <string>
#include <utility>
#include <vector>

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

/// Says of every restitution below 1 what is allowed.
void refuse_restitution(const RunConfig& config, const std::string& allowed, const Complain& complain);
/// Says of every coefficient of friction above 0 what is allowed.
void refuse_friction(const RunConfig& config, const std::string& allowed, const Complain& complain);
/// What kernels do not have (check_device.cpp).
void check_device(const RunConfig& config, const Complain& complain);

}  // namespace bb
