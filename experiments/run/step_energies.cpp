#include "experiments/run/step_energies.hpp"

namespace bb {

void fill_energies(const StepSystem& system, StepRecord& step) {
  const Scene& scene = system.view().scene();
  step.gravity_J = 0;
  const Vec3d gravity = gravity_at(scene, step.t_s);
  for (std::size_t i = 0; i < scene.mass.size(); ++i) {
    step.gravity_J -= scene.mass[i] * gravity.dot(system.view().x().col(static_cast<Eigen::Index>(i)));
  }
  step.elastic_J = system.view().energy(TermGroup::elastic);
  step.limit_J = system.view().energy(TermGroup::limit);
  step.contact_J = system.view().energy(TermGroup::contact);
}

}  // namespace bb
