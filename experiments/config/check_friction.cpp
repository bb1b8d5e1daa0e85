// What coefficients, laws and the lagging of friction require of each other and of the step solver.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/energy/friction_law.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/reader.hpp"

namespace bb {
namespace {

/// One coefficient or two of the run, a body or an obstacle.
struct SideFriction {
  std::string at;                        // pointer of the section that has both
  const char *sliding_key, *static_key;  // in it
  std::optional<double> sliding, at_rest;
  std::string sliding_place() const { return at + "/" + sliding_key; }
  std::string static_place() const { return at + "/" + static_key; }
};

std::vector<SideFriction> sides_of(const RunConfig& config) {
  std::vector<SideFriction> out;
  out.push_back({"/friction", "mu", "mu_static", config.friction.mu, config.friction.mu_static});
  const auto add = [&out](const char* list, std::size_t i, const auto& side) {
    out.push_back({fmt::format("/scene/{}/{}", list, i), "friction", "friction_static", side.friction,
                   side.friction_static});
  };
  for (std::size_t i = 0; i < config.scene.bodies.size(); ++i) add("bodies", i, config.scene.bodies[i].spec);
  for (std::size_t i = 0; i < config.scene.obstacles.size(); ++i)
    add("obstacles", i, config.scene.obstacles[i]);
  return out;
}

bool has_two_coefficients(const RunConfig& config) {
  const std::vector<std::string> laws = two_coefficient_laws();
  return std::find(laws.begin(), laws.end(), config.friction.law) != laws.end();
}

/// "nothing with law L, which has one coefficient; M has two".
std::string nothing_with_one(const RunConfig& config) {
  return fmt::format("nothing with law {}, which has one coefficient; two has {}", config.friction.law,
                     fmt::join(two_coefficient_laws(), ", "));
}

void check_coefficients(const RunConfig& config, const Complain& complain) {
  for (const SideFriction& side : sides_of(config)) {
    if (!side.at_rest) continue;
    const double sliding = side.sliding.value_or(config.friction.mu), at_rest = *side.at_rest;
    if (!has_two_coefficients(config)) {
      complain(side.static_place(), fmt::format("{}", at_rest), nothing_with_one(config));
    } else if (at_rest < sliding) {
      complain(side.static_place(), fmt::format("{}, below the kinetic coefficient {}", at_rest, sliding),
               fmt::format("a number >= {}, which {} is", sliding,
                           side.sliding ? side.sliding_place() : "/friction/mu"));
    }
  }
}

void check_scales(const RunConfig& config, const Complain& complain) {
  const FrictionConfig& friction = config.friction;
  if (!friction.kinetic_v) return;
  const std::string where = "/friction/kinetic_v_m_per_s", found = fmt::format("{}", *friction.kinetic_v);
  if (!has_two_coefficients(config)) {
    complain(where, found, nothing_with_one(config));
  } else if (friction.eps_m) {
    complain(where, found,
             "nothing: /friction/eps_m is no speed, and the coefficient is the kinetic one from 10 eps_m on");
  } else if (*friction.kinetic_v <= friction.eps_v) {
    complain(where, found, fmt::format("a number > {}, which /friction/eps_v_m_per_s is", friction.eps_v));
  }
}

/// E is another function at each iterate: a solver may compare its values at two states of one iteration, and nothing beyond.
bool takes_new_loads(const StepNeeds& needs) {
  return needs.minimum ? !needs.multipliers : needs.matrix && !needs.energies;
}

void check_refresh(const RunConfig& config, const Complain& complain) {
  const FrictionConfig& friction = config.friction;
  if (friction.refresh.value_or(FrictionRefresh::per_step) == FrictionRefresh::per_step) return;
  const StepNeeds needs = needs_of(config);
  std::vector<std::string> right;
  for (const StepSolverEntry& entry : step_solvers()) {
    if (takes_new_loads(entry.needs)) right.emplace_back(entry.name);
  }
  if (!takes_new_loads(needs)) {
    complain(
        "/friction/refresh", "\"per_iteration\"",
        fmt::format("per_step, or step solver {}: {} compares what it knows of several iterates, which have "
                    "another energy of friction each, or has loads that change between its solves alone",
                    fmt::join(right, ", "), config.step_solver.name));
  }
  if (friction.lag_iterations > 1) {
    complain("/friction/lag_iterations", fmt::format("{}", friction.lag_iterations),
             "1: with refresh per_iteration the loads are those of the iterate already");
  }
}

/// A matrix of friction that a step solver does not have.
void check_matrix(const RunConfig& config, const Complain& complain) {
  const StepNeeds needs = needs_of(config);
  const std::string& solver = config.step_solver.name;
  if (config.friction.hessian == FrictionHessian::adaptive && !needs.minimum) {
    complain("/friction/hessian", "\"adaptive\"",
             "exact or secant: the step solver " + solver +
                 " has no line search on E, these have one: " + solvers_with_minimum());
  }
  if (config.friction.hessian == FrictionHessian::secant && needs.minimum) {
    complain(
        "/friction/hessian", "\"secant\"",
        "exact or adaptive: the step solver " + solver + " proves the end of a step by the exact matrix");
  }
  if (config.friction.lag_iterations > 1 && !needs.minimum) {
    complain("/friction/lag_iterations", fmt::format("{}", config.friction.lag_iterations),
             "1: the step solver " + solver +
                 " solves a step once, these solve it again: " + solvers_with_minimum());
  }
}

}  // namespace

bool has_friction(const RunConfig& config) {
  const std::vector<SideFriction> sides = sides_of(config);
  return std::any_of(sides.begin(), sides.end(), [](const SideFriction& side) {
    return side.sliding.value_or(0) > 0 || side.at_rest.value_or(0) > 0;
  });
}

void refuse_friction(const RunConfig& config, const std::string& allowed, const Complain& complain) {
  const auto refuse = [&](const std::string& pointer, const std::optional<double>& mu) {
    if (mu.value_or(0) > 0) complain(pointer, fmt::format("{}", *mu), allowed);
  };
  for (const SideFriction& side : sides_of(config)) {
    refuse(side.sliding_place(), side.sliding);
    refuse(side.static_place(), side.at_rest);
  }
}

void check_friction(const RunConfig& config, const Complain& complain) {
  check_coefficients(config, complain);
  check_scales(config, complain);
  check_refresh(config, complain);
  check_matrix(config, complain);
}

}  // namespace bb
