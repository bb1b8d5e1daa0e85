// Settings that a device does not have.
#include <fmt/format.h>

#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/reader.hpp"

namespace bb {

void refuse_restitution(const RunConfig& config, const std::string& allowed, const Complain& complain) {
  const auto refuse = [&](const char* list, std::size_t i, const std::optional<double>& e) {
    if (e && *e < 1)
      complain(fmt::format("/scene/{}/{}/restitution", list, i), fmt::format("{}", *e), allowed);
  };
  for (std::size_t i = 0; i < config.scene.bodies.size(); ++i) {
    refuse("bodies", i, config.scene.bodies[i].spec.restitution);
  }
  for (std::size_t i = 0; i < config.scene.obstacles.size(); ++i) {
    refuse("obstacles", i, config.scene.obstacles[i].restitution);
  }
}

/// Kernels pair all bodies.
void refuse_collisions(const SceneConfig& scene, const std::string& on, const Complain& complain) {
  const std::string here = on + ": its kernels collide all pairs as ccd";
  if (!scene.collisions.empty()) complain("/scene/collisions", "a choice", "none " + here);
  const auto refuse = [&](const char* list, std::size_t i, const std::string& group) {
    if (group.empty()) return;
    complain(fmt::format("/scene/{}/{}/collision_group", list, i), '"' + group + '"', "none " + here);
  };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    refuse("bodies", i, scene.bodies[i].spec.collision_group);
  }
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    refuse("obstacles", i, scene.obstacles[i].collision_group);
  }
}

void check_device(const RunConfig& config, const Complain& complain) {
  if (config.device == Device::cpu) return;
  const std::string on = fmt::format("with device {}", word_of(config.device));
  refuse_collisions(config.scene, on, complain);
  if (config.precision != Precision::full) {
    complain("/precision", '"' + word_of(config.precision) + '"', "double " + on);
  }
  if (const auto rule = config.contact.step_bound.value_or(StepBoundRule::accd); bounds_each_vertex(rule)) {
    complain("/contact/step_bound", '"' + word_of(rule) + '"',
             "accd " + on + ": no kernel bounds each vertex by itself");
  }
  if (const auto weighting = config.contact.weighting.value_or(ContactWeighting::none);
      weighting != ContactWeighting::none) {
    complain("/contact/weighting", '"' + word_of(weighting) + '"',
             "none " + on + ": its kernels count every pair as one");
  }
  if (const auto model = config.contact.model.value_or(ContactModel::all_pairs);
      model != ContactModel::all_pairs) {
    complain("/contact/model", '"' + word_of(model) + '"',
             "all_pairs " + on + ": its kernels know no other pairs");
  }
  if (is_numeric(config.contact.hessian_mode)) {
    complain("/contact/hessian_mode", '"' + word_of(config.contact.hessian_mode) + '"',
             "gauss_newton or projected_full " + on);
  }
  if (!needs_of(config).step_bound || needs_of(config).multipliers) {
    complain("/step_solver/name", '"' + config.step_solver.name + '"', "another step solver " + on);
  }
  const LinearSolverEntry* solver = find_named(linear_solvers(), config.linear_solver.name);
  if (!solver || solver->matrix != MatrixPlace::executor) {
    complain("/linear_solver/name", '"' + config.linear_solver.name + '"',
             fmt::format("{} {}: the matrix stays where it is assembled",
                         linear_solver_at(MatrixPlace::executor).name, on));
  }
}

}  // namespace bb
