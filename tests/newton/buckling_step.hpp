// One step of a cloth that buckles, with contacts: small, and hard enough that the exact Hessian is not positive
// definite on the way.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/newton/small_scenes.hpp"

namespace bb::test {

constexpr double dt = 0.01, tolerance = 1e-6 * dt;  // s, m

/// A wavy cloth just above a floor, compressed in its plane to `width`, so that it buckles; contacts are active.
/// At 0.95 the step has several minima.
inline Scene buckling_cloth(double width = 0.95) {
  SceneBuilder builder("buckling cloth", false, Vec3d(0, 0, -9.81), "test");
  BodySpec spec = cloth_spec(9, 0, 0.02);
  spec.material.youngs = 20000;
  spec.material.bending = 1e-3;
  builder.add_body(spec);
  Obstacle floor;
  floor.name = "floor";
  floor.point = Vec3d(0, 0, -0.012);
  builder.add_obstacle(floor);
  Scene scene = builder.finish();
  for (Eigen::Index i = 0; i < scene.x0.cols(); ++i) {
    const double x = scene.x0(0, i), y = scene.x0(1, i);
    scene.x0(2, i) += 0.004 * (1 + std::sin(9 * x + 2 * y) * std::cos(7 * y - 1));
    scene.x0.col(i).head<2>() *= width;
  }
  return scene;
}

inline Method method_with(StepHessian hessian, double tol_velocity = 1e-6) {
  Method method = fixed_method("log", 30);
  method.hessian_mode = HessianMode::projected_full;
  for (const HessianChoice& choice : hessian_choices()) method.step_hessian[choice.name] = hessian;
  method.step_solver.tol_velocity = tol_velocity;
  method.step_solver.max_iterations = 2000;  // clamped matrices converge linearly
  return method;
}

class Watch final : public StepObserver {
 public:
  void on_matrix(StepSystem& step_system, int, int) override {
    NewtonSystem& system = step_system.on_host();
    differ += system.diagnosis().solved_is_clamped() ? 0 : 1;
    contacts = std::max(contacts, rows_of(system).size());
  }
  void on_iteration(const IterationReport& report) override {
    dx.push_back(report.dx_inf_m);
    largest_t = std::max(largest_t, report.hessian_t);
    estimate = report.error_estimate_m.value;
  }
  std::vector<double> dx;
  std::size_t contacts = 0;
  int differ = 0;
  double largest_t = 0, estimate = 0;
};

struct OneStep {
  Scene scene;
  Method method;
  Simulation simulation;
  Watch watch;
  StepReport report;

  explicit OneStep(Method given, double width = 0.95)
      : scene(buckling_cloth(width)),
        method(std::move(given)),
        simulation(scene, method, dt, 1),
        report(simulation.step(watch)) {}
  const Positions& x() const { return simulation.history().x; }
};

}  // namespace bb::test
