// Settings that contradict each other across sections.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/config/reader.hpp"

namespace bb {
namespace {

struct Complain {
  const std::string& source;
  std::vector<Violation>& violations;
  void operator()(const char* pointer, std::string found, std::string allowed) const {
    violations.push_back({source + "#" + pointer, std::move(found), std::move(allowed)});
  }
};

void check_step_solver(const RunConfig& config, const Complain& complain) {
  const StepSolverConfig& solver = config.step_solver;
  const bool literal = solver.name == "article_literal";
  if ((solver.name == "accumulated_toi" || literal) && config.integrator != "implicit_euler") {
    complain("/integrator/name", '"' + config.integrator + '"',
             "implicit_euler: the step solver is " + solver.name);
  }
  if (literal && config.formulation.argument != Argument::gap) {
    complain("/formulation/argument", "\"squared_gap\"", "gap: the step solver is article_literal");
  }
  if (literal && config.strain_limit.argument != Argument::gap) {
    complain("/strain_limit/argument", "\"squared_gap\"", "gap: the step solver is article_literal");
  }
  if (solver.name == "accumulated_toi" && solver.min_newton_steps > solver.max_iterations) {
    complain("/step_solver/min_newton_steps", fmt::format("{}", solver.min_newton_steps),
             fmt::format("an integer <= max_iterations = {}", solver.max_iterations));
  }
}

/// kappa of ipc_adaptive starts from the inertia of the contacts, which a quasi-static step does not have.
void check_policy(const RunConfig& config, const Complain& complain) {
  if (config.integrator != "quasi_static" || config.formulation.stiffness_policy.name != "ipc_adaptive")
    return;
  complain("/formulation/stiffness_policy/name", "\"ipc_adaptive\"",
           "another policy: it needs inertia, and the integrator is quasi_static");
}

/// Above this tolerance nothing falls: the first Newton step is already below it.
void check_tolerance(const RunConfig& config, const Complain& complain) {
  const double dt = config.time.dt, fall = 0.5 * config.scene.gravity.norm() * dt * dt;
  const bool falls = fall > 0 && config.integrator != "quasi_static";
  const double length = falls ? std::min(config.formulation.d_hat, fall) : config.formulation.d_hat;
  const double largest = 0.1 * length / dt;
  constexpr double rounding = 1 + 1e-12;  // the default sits exactly on the bound when the fall decides
  if (config.step_solver.tol_velocity > largest * rounding) {
    complain("/step_solver/tol_velocity_m_per_s", fmt::format("{}", config.step_solver.tol_velocity),
             fmt::format("a number <= {}, 0.1 min(d_hat, |g| dt^2/2)/dt (m/s)", largest));
  }
}

void check_protocol(const RunConfig& config, const Complain& complain) {
  const auto protocol = config.scene.parameters.find("protocol");
  const bool literal = protocol != config.scene.parameters.end() &&
                       protocol->second == ParameterValue(std::string("article_literal"));
  if (literal == (config.step_solver.name == "article_literal")) return;
  complain("/step_solver/name", '"' + config.step_solver.name + '"',
           literal
               ? "article_literal: it is the scene's protocol"
               : "another step solver: article_literal needs scene drape2d with protocol article_literal");
}

}  // namespace

void check_contradictions(const RunConfig& config, const std::string& source,
                          std::vector<Violation>& violations) {
  const Complain complain{source, violations};
  check_step_solver(config, complain);
  check_policy(config, complain);
  check_tolerance(config, complain);
  check_protocol(config, complain);
  if (config.passes.diagnose && config.diagnose.tier == 0 && config.linear_solver.name != "pcg") {
    complain("/diagnose/tier", "0", "1 or 2, or linear_solver pcg: tier 0 reads the Ritz values of PCG");
  }
  if (config.output.matrices && !config.passes.diagnose) {
    complain("/output/matrices", "true",
             "false, or passes.diagnose true: matrices are those of diagnosed iterations");
  }
}

}  // namespace bb
