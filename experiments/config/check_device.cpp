// Settings that a device does not have.
#include <fmt/format.h>

#include "core/solvers/linear_solvers.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/reader.hpp"

namespace bb {

void refuse_friction(const RunConfig& config, const std::string& allowed, const Complain& complain) {
  const auto refuse = [&](const std::string& pointer, double mu) {
    if (mu > 0) complain(pointer, fmt::format("{}", mu), allowed);
  };
  refuse("/friction/mu", config.friction.mu);
  for (std::size_t i = 0; i < config.scene.bodies.size(); ++i) {
    refuse(fmt::format("/scene/bodies/{}/friction", i), config.scene.bodies[i].spec.friction.value_or(0));
  }
  for (std::size_t i = 0; i < config.scene.obstacles.size(); ++i) {
    refuse(fmt::format("/scene/obstacles/{}/friction", i), config.scene.obstacles[i].friction.value_or(0));
  }
}

void check_device(const RunConfig& config, const Complain& complain) {
  if (config.device == Device::cpu) return;
  const std::string on = fmt::format("with device {}", word_of(config.device));
  refuse_friction(config, "0 " + on + ": friction runs with device cpu only", complain);
  for (std::size_t i = 0; i < config.scene.obstacles.size(); ++i) {
    if (config.scene.obstacles[i].motion.is_static()) continue;
    complain(fmt::format("/scene/obstacles/{}/motion", i), "an obstacle that moves",
             "no motion " + on + ": its kernels know obstacles that stand still");
  }
  if (!config.scene.gravity_keys.empty()) {
    complain("/scene/gravity_schedule", "gravity over time", "gravity_m_per_s2 " + on);
  }
  if (config.precision != Precision::full) {
    complain("/precision", '"' + word_of(config.precision) + '"', "double " + on);
  }
  if (is_numeric(config.contact.hessian_mode)) {
    complain("/contact/hessian_mode", '"' + word_of(config.contact.hessian_mode) + '"',
             "gauss_newton or projected_full " + on);
  }
  if (!needs_of(config).step_bound) {
    complain("/step_solver/name", '"' + config.step_solver.name + '"', "another step solver " + on);
  }
  const LinearSolverEntry* solver = find_named(linear_solvers(), config.linear_solver.name);
  if (!solver || solver->matrix != MatrixPlace::executor) {
    complain("/linear_solver/name", '"' + config.linear_solver.name + '"',
             fmt::format("{} {}: the matrix stays where it is assembled",
                         linear_solver_at(MatrixPlace::executor).name, on));
  }
  for (const auto& [term, choice] : config.hessian.parameters) {
    if (choice != ParameterValue(std::string("progressive"))) continue;
    complain("/hessian/" + term, "\"progressive\"", "another choice " + on);
  }
}

}  // namespace bb
