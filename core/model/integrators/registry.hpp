// The integrators by name. Built-ins come from registry.inc, plugins are added at run time.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/model/integrators/integrator.hpp"

namespace bb {

struct IntegratorEntry {
  std::string name, doc;
  std::vector<Parameter> parameters;  // its own, with defaults
  std::function<std::unique_ptr<Integrator>(const ParameterMap& complete)> make;
};

/// All integrators, built-ins first.
Registry<IntegratorEntry>& integrators();
/// Errors: ConfigError for an unknown name and for what own_parameters refuses.
std::unique_ptr<Integrator> make_integrator(const std::string& name, const ParameterMap& parameters = {});

}  // namespace bb
