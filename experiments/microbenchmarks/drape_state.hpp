// The drape scene in contact: five layers on a sphere, stopped in the middle of a run.
#pragma once

#include <memory>

#include "core/step_solvers/simulation.hpp"
#include "core/terms/contact.hpp"
#include "experiments/run/method.hpp"

namespace bb::bench {

/// Log barrier on the gap; fixed stiffness that carries the weight of all layers at half the activation
/// distance of one contact and of the limit.
struct DrapeState {
  RunConfig config;
  Scene scene;
  Method method;
  std::unique_ptr<Simulation> simulation;
  Positions dx;         // Newton direction at the state
  Positions x1;         // state + dx
  double factor_s = 0;  // median of five numeric factorisations of the matrix at the state
  bool all_layers_touch = false;

  NewtonSystem& system() { return simulation->system(); }
  Diagnosis& diagnosis() { return system().diagnosis(); }
  PositionsView x() { return system().view().x(); }
  std::size_t n_rows() { return contact_state(diagnosis().terms()).size(); }
};

/// 5 x n^2 vertices. Runs steps of a few Newton iterations until the sphere and every two neighbouring layers
/// are in contact. Made once for each n, then shared: benchmarks must leave the state as it is, or come last.
DrapeState& drape_state(int n);

}  // namespace bb::bench
