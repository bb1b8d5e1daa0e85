// What a Newton system holds: the vectors of a step in the memory of an executor, and the sum of terms on them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/exec/sums/vectors.hpp"
#include "core/model/scene/scene.hpp"
#include "core/newton/hessian_regularisation.hpp"
#include "core/newton/incremental_potential.hpp"
#include "core/newton/method.hpp"
#include "core/terms/plan.hpp"

namespace bb {

struct NewtonState {
  NewtonState(const Scene& scene, Method& method, const Plan& plan, PhaseClock& clock,
              const MakePotential& make);
  NewtonState(const NewtonState&) = delete;
  NewtonState& operator=(const NewtonState&) = delete;

  const Scene& scene;
  const Plan plan;
  const Precision precision;
  const std::vector<std::uint8_t> fixed;  // [3 n] prescribed or locked degrees of freedom
  const int n_free;
  std::unique_ptr<IncrementalPotential> potential;
  exec::Executor& executor;
  exec::VectorTools vectors;
  HessianRegularisation level;

  Column x, trial;      // the iterate; the trial, or the iterate before the last accept(), m
  Column end, dx;       // x + dx, and the direction
  Column g, force;      // N, gradient of E; [n] its norm at every vertex over free degrees of freedom
  Column x_n, x_tilde;  // m
  Column b, step;       // right-hand side (N) and solution (m) of a system
  Column work;
  Column aside;  // a direction of negative curvature at the iterate, or dx before its curvature correction
  Column body_size;  // [n] m
  double shift = 0;  // N/m, what add_tikhonov added
  // A share of the secant of terms is requested of the next iterate; is in the matrices of this one.
  bool secant_asked = false, secant = false;
  // What vectors found last is of x, of the trial.
  bool pins_seen = false, trial_pins_seen = false;
  // What vectors found last is of dx: its sizes, and with them g . dx.
  bool direction_seen = false;
  bool gradient_seen = false;  // its largest entry

  /// The first prescribed vertex (its number) that is not where directions lead it, -1 without one.
  exec::Index first_short_pin();
  /// For who will read it of the trial, should it be accepted.
  void look_at_trial_pins();
};

/// [3 n] 1 where a degree of freedom is prescribed or, in a planar scene, locked.
std::vector<std::uint8_t> fixed_dofs(const Scene& scene, const Plan& plan);
/// [n] m, size of the body of each vertex at rest: the largest side of its box.
std::vector<double> body_sizes(const Scene& scene);
/// Of the terms of the plan.
ExactHessians exact_hessians(const Plan& plan, const Method& method);
/// Of a method that is run without a config.
PlanOptions plan_options(const Method& method);

}  // namespace bb
