// Small scenes and methods that the engine of an executor and the CPU path both run.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "core/exec/host_executor.hpp"
#include "core/newton/executor/executor_engine.hpp"
#include "core/newton/newton_system.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::test {

/// A method for an executor: conjugate gradients, tight by default.
inline void use_executor_solver(Method& method, double tolerance = 1e-11) {
  method.linear.name = "pcg_resident";
  method.linear.parameters["forcing"] = std::string("fixed");
  method.linear.parameters["tol_rel"] = tolerance;
}

/// E on an executor of its own; prepare: before anything is evaluated.
inline MakePotential on_executor(
    const std::function<std::unique_ptr<exec::Executor>()>& make,
    const std::function<void(exec::ExecutorEngine&)>& prepare = [](exec::ExecutorEngine&) {}) {
  return [=](const Scene& scene, Method& method, const Plan& plan, const std::vector<std::uint8_t>& fixed,
             PhaseClock& clock) {
    auto out = std::make_unique<exec::ExecutorEngine>(make(), scene, method, plan, fixed, clock);
    prepare(*out);
    return out;
  };
}

/// A Newton system on that executor, whatever the method says.
class ExecutorSystem final : public NewtonSystem {
 public:
  ExecutorSystem(std::unique_ptr<exec::Executor> executor, const Scene& scene, Method& method,
                 const Plan& plan)
      : NewtonSystem(scene, put_on(executor, method), plan) {
    method.make_potential = nullptr;
  }
  exec::ExecutorEngine& engine() { return dynamic_cast<exec::ExecutorEngine&>(potential()); }
  const exec::MemoryLedger& memory() { return engine().memory(); }

 private:
  static Method& put_on(std::unique_ptr<exec::Executor>& executor, Method& method) {
    method.make_potential = on_executor([&executor] { return std::move(executor); });
    return method;
  }
};

/// Makes the method run on a host executor in that order.
inline void run_on_executor(Method& method, exec::Order order = exec::Order::threads) {
  use_executor_solver(method);
  method.make_potential = on_executor([order] { return std::make_unique<exec::HostExecutor>(order, 7u); });
}

/// A cloth of 5 x 5 vertices with bending and a strain limit, tilted, that falls on a smaller rigid plate and on the
/// floor beside it; two of its corners are pulled.
inline Scene cloth_on_plate() {
  SceneBuilder builder("cloth on plate", false, Vec3d(0, 0, -10), "test");
  BodySpec cloth = cloth_spec(5, 0.035, 0.02);
  for (int i = 0; i < cloth.mesh.vertices.cols(); ++i) {
    cloth.mesh.vertices(2, i) += 0.004 * cloth.mesh.vertices(0, i) + 0.002 * cloth.mesh.vertices(1, i);
  }
  cloth.material.youngs = 300;
  cloth.material.bending = 1e-3;
  cloth.material.springs = 5;
  cloth.material.limit = StrainLimitSpec{0.05, 0.05};
  PinSpec corners;
  corners.indices = {0, 4};
  corners.motion.velocity = Vec3d(0.05, 0, 0);
  cloth.pins = {corners};
  builder.add_body(cloth);
  BodySpec plate = cloth_spec(3, 0.012, 0.02);
  plate.name = "plate";
  plate.kind = BodyKind::rigid;
  plate.mesh.vertices.row(0) *= 0.4;
  plate.mesh.vertices.row(1) *= 0.4;
  builder.add_body(plate);
  Obstacle floor;
  floor.name = "floor";
  floor.point = Vec3d(0, 0, 0.004);
  builder.add_obstacle(floor);
  return builder.finish();
}

/// Two small sheets, one above the other, crossed by an angle: pairs of all kinds of 3D, some of edges close to parallel.
inline Scene two_sheets() {
  SceneBuilder builder("two sheets", false, Vec3d(0, 0, -10), "test");
  BodySpec lower = cloth_spec(4, 0.0, 0.03);
  lower.name = "lower";
  PinSpec rim;
  rim.indices = {0, 3, 12, 15};
  lower.pins = {rim};
  lower.material.youngs = 500;
  builder.add_body(lower);
  BodySpec upper = cloth_spec(3, 0.036, 0.03);
  upper.name = "upper";
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (int i = 0; i < upper.mesh.vertices.cols(); ++i) {
    const Vec3d x = upper.mesh.vertices.col(i);
    upper.mesh.vertices.col(i) =
        Vec3d(0.6 * (c * x[0] - s * x[1]), 0.6 * (s * x[0] + c * x[1]), x[2] + 0.003 * x[0]);
  }
  builder.add_body(upper);
  return builder.finish();
}

/// A coarse cloth over two balls and a bar between its vertices, some of its edges along the bar.
inline Scene cloth_on_balls_and_bar() {
  SceneBuilder builder("balls and bar", false, Vec3d(0, 0, -10), "test");
  BodySpec cloth = cloth_spec(4, 0.128, 0.03);
  cloth.material.bending = 1e-3;
  cloth.offset = 0.002;
  builder.add_body(cloth);
  const Vec3d middle = cloth.mesh.vertices.rowwise().mean();
  const auto add = [&](const char* name, ObstacleKind kind, double x, double y) {
    Obstacle o;
    o.name = name;
    o.kind = kind;
    o.point = middle + Vec3d(x, y, -0.128);
    o.axis = Vec3d::UnitY();
    o.radius = 0.1;
    builder.add_obstacle(o);
  };
  add("left", ObstacleKind::sphere, -0.35, 0.02);
  add("near", ObstacleKind::sphere, 0.02, -0.3);
  add("bar", ObstacleKind::cylinder, 0.4, 0);
  return builder.finish();
}

/// What is higher than 2 cm lowered, so that it touches at the start.
inline Scene touching(Scene scene, double by) {
  for (int v = 0; v < scene.n_vertices(); ++v) {
    if (scene.x0(2, v) > 0.02) scene.x0(2, v) -= by;
  }
  return scene;
}

inline Method method_with_policy(const std::string& shape, const std::string& policy,
                                 const ParameterMap& parameters) {
  Method method = fixed_method(shape, 20);
  PolicyConfig config;
  config.name = policy;
  config.parameters = parameters;
  method.stiffness = make_policy(config);
  return method;
}

struct RunEnd {
  Positions x;
  std::vector<Positions> x_of_steps;  // at the ends of all steps
  std::vector<StepStatus> status;
  std::vector<int> iterations, retries;
  std::vector<double> dt_s;
  std::size_t contacts = 0;  // at the ends of all steps
  double kappa_min = 0, kappa_max = 0,
         limit_load_max = 0;                  // N/m, of the last step that has one; of all steps
  double kappa_start = 0;                     // N/m, of a policy that starts itself
  int sticking = 0, sliding = 0;              // contacts with friction, of all steps
  double friction_work = 0, bounce_work = 0;  // J, of all steps
  double solved_to = 0;                       // largest relative residual that a linear solve was allowed
};

class LinearTolerances final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override {
    largest = std::max(largest, report.solve.linear.tolerance);
  }
  double largest = 0;
};

/// Goes on for so many steps, parts of steps counted.
inline RunEnd run_steps(Simulation& simulation, int steps) {
  LinearTolerances observer;
  RunEnd end;
  for (int i = 0; i < steps; ++i) {
    const StepReport report = simulation.step(observer);
    end.status.push_back(report.status);
    end.iterations.push_back(report.newton_iterations);
    end.retries.push_back(report.retries);
    end.dt_s.push_back(report.dt_s);
    end.contacts += report.contacts.total();
    if (report.kappa_min_N_per_m.finite()) end.kappa_min = report.kappa_min_N_per_m.value;
    if (report.kappa_max_N_per_m.finite()) end.kappa_max = report.kappa_max_N_per_m.value;
    end.sticking += report.friction_sticking, end.sliding += report.friction_sliding;
    if (report.friction_dissipation_J.finite()) end.friction_work += report.friction_dissipation_J.value;
    if (report.restitution_dissipation_J.finite()) end.bounce_work += report.restitution_dissipation_J.value;
    if (report.limit_load_max_N_per_m.finite())
      end.limit_load_max = std::max(end.limit_load_max, report.limit_load_max_N_per_m.value);
    end.x_of_steps.push_back(simulation.history().x);
  }
  end.x = simulation.history().x;
  end.solved_to = observer.largest;
  return end;
}

inline RunEnd run_steps(const Scene& scene, Method method, int steps, double dt = 0.01) {
  Simulation simulation(scene, method, dt, steps);
  RunEnd end = run_steps(simulation, steps);
  end.kappa_start = method.stiffness->state().kappa_start;
  return end;
}

/// Both runs are within a tolerance (m) after every step, with one status and length, and were in contact.
inline void expect_same_end(const RunEnd& there, const RunEnd& cpu, double tolerance) {
  EXPECT_EQ(there.status, cpu.status);
  EXPECT_EQ(there.retries, cpu.retries);
  ASSERT_EQ(there.dt_s.size(), cpu.dt_s.size());
  for (std::size_t i = 0; i < cpu.dt_s.size(); ++i) {
    EXPECT_NEAR(there.dt_s[i], cpu.dt_s[i], 1e-6 * cpu.dt_s[i]) << "step " << i;
    EXPECT_LT((there.x_of_steps[i] - cpu.x_of_steps[i]).cwiseAbs().maxCoeff(), tolerance) << "step " << i;
  }
  EXPECT_GT(cpu.contacts, 0u);
  EXPECT_EQ(there.contacts, cpu.contacts);
  EXPECT_EQ(there.sticking, cpu.sticking);
  EXPECT_EQ(there.sliding, cpu.sliding);
  EXPECT_NEAR(there.friction_work, cpu.friction_work, 1e-5 * cpu.friction_work);
  EXPECT_NEAR(there.bounce_work, cpu.bounce_work, 1e-5 * cpu.bounce_work);
  EXPECT_NEAR(there.kappa_min, cpu.kappa_min, 1e-6 * cpu.kappa_min);
  EXPECT_NEAR(there.kappa_max, cpu.kappa_max, 1e-6 * cpu.kappa_max);
  EXPECT_NEAR(there.kappa_start, cpu.kappa_start, 1e-6 * cpu.kappa_start);
}

/// The run on an executor, after comparing it with that on the CPU path. change: of the method on the executor alone.
inline RunEnd expect_same_run(
    const Scene& scene, const std::function<Method()>& method, int steps, double tolerance,
    const std::function<void(Method&)>& change = [](Method&) {}) {
  Method on_host = method(), elsewhere = method();
  use_executor_solver(on_host);
  run_on_executor(elsewhere);
  change(elsewhere);
  const RunEnd cpu = run_steps(scene, std::move(on_host), steps);
  RunEnd there = run_steps(scene, std::move(elsewhere), steps);
  expect_same_end(there, cpu, tolerance);
  EXPECT_GT((there.x - scene.x0).cwiseAbs().maxCoeff(), 1e-3);
  return there;
}

}  // namespace bb::test
