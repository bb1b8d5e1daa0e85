#include "experiments/run/step_energies.hpp"

#include <numeric>

namespace bb {
namespace {

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

void fill_energies(const NewtonSystem& system, StepRecord& step) {
  const EnergyState& state = system.state();
  const Scene& scene = system.scene();
  step.elastic_J = step.gravity_J = 0;
  for (const auto& family : state.element) step.elastic_J += sum_of(family);
  for (std::size_t i = 0; i < scene.mass.size(); ++i) {
    step.gravity_J -= scene.mass[i] * scene.gravity.dot(state.x.col(static_cast<Eigen::Index>(i)));
  }
  step.limit_J = sum_of(state.limit);
  step.contact_J = sum_of(state.contact) + sum_of(state.mollified_contact);
}

}  // namespace bb
