// Settings that change what a step does, one by one: the resident pipeline ends where the CPU path ends.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/model/mesh/solid_generators.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/barriers/limit_policies.hpp"
#include "tests/executor/system_cases.hpp"

namespace bb::exec_settings_test {
namespace {

using test::expect_same_run;
using test::RunEnd;

constexpr double tolerance = 1e-6;  // m, after some steps of 1e-8 m each

Method cubic() { return test::fixed_method("cubic", 20); }

BodySpec planar_sheet(const char* name, int n_x, int n_y, double width, double bottom) {
  BodySpec out;
  out.name = name;
  const double height = width / (n_x - 1) * (n_y - 1);
  out.mesh = grid_mesh(n_x, n_y, width, height);
  out.mesh.vertices.row(1).array() += bottom + 0.5 * height;
  out.material.density = 0.3;
  out.material.youngs = 100;
  out.d_hat = 0.02;
  return out;
}

/// Two strips in the plane: the lower one on a disk, the upper one, turned a little, on it.
Scene planar_strips(PlanarPairs pairs) {
  SceneBuilder builder("strips", true, Vec3d(0, -10, 0), "test");
  builder.set_planar_pairs(pairs);
  BodySpec lower = planar_sheet("lower", 6, 2, 0.5, 0.31);
  PinSpec ends;
  ends.indices = {0, 5};
  lower.pins = {ends};
  builder.add_body(lower);
  BodySpec upper = planar_sheet("upper", 4, 2, 0.2, 0.425);
  for (int i = 0; i < upper.mesh.vertices.cols(); ++i)
    upper.mesh.vertices(1, i) += 0.02 * upper.mesh.vertices(0, i);
  upper.velocity = Vec3d(0, -0.2, 0);
  builder.add_body(upper);
  Obstacle disk;
  disk.name = "disk";
  disk.kind = ObstacleKind::sphere;
  disk.radius = 0.3;
  builder.add_obstacle(disk);
  return builder.finish();
}

TEST(ExecutorSettings, PlanarScenes) {
  for (const PlanarPairs pairs : {PlanarPairs::point_edge, PlanarPairs::vertex_vertex}) {
    SCOPED_TRACE(static_cast<int>(pairs));
    const Scene scene = planar_strips(pairs);
    const RunEnd end = expect_same_run(scene, cubic, 10, tolerance);
    EXPECT_EQ(end.x.row(2).cwiseAbs().maxCoeff(), 0);
  }
}

TEST(ExecutorSettings, Integrators) {
  for (const char* integrator : {"bdf2", "newmark"}) {
    SCOPED_TRACE(integrator);
    const auto method = [&] { return test::fixed_method("cubic", 20, integrator); };
    expect_same_run(test::touching(test::cloth_on_plate(), 0.012), method, 8, tolerance);
  }
}

/// A sheet whose rim is held, just above a floor.
Scene held_sheet() {
  SceneBuilder builder("held sheet", false, Vec3d(0, 0, -10), "test");
  BodySpec sheet = test::cloth_spec(5, 0.015, 0.02);
  sheet.material.bending = 1e-2;
  PinSpec rim;
  for (int i = 0; i < 25; ++i) {
    if (i % 5 == 0 || i % 5 == 4 || i < 5 || i >= 20) rim.indices.push_back(i);
  }
  sheet.pins = {rim};
  builder.add_body(sheet);
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

TEST(ExecutorSettings, LoadStepsWithoutInertia) {
  Method on_host = test::fixed_method("cubic", 20, "quasi_static"),
         resident = test::fixed_method("cubic", 20, "quasi_static");
  test::use_executor_solver(on_host);
  test::run_on_executor(resident);
  const Scene scene = held_sheet();
  Simulation cpu(scene, on_host, 0.01, 8), ours(scene, resident, 0.01, 8);
  for (int part = 0; part < 2; ++part) {  // at 3/8 and 6/8 of the load
    const RunEnd expected = test::run_steps(cpu, 3);
    test::expect_same_end(test::run_steps(ours, 3), expected, tolerance);
    EXPECT_GT((expected.x - scene.x0).cwiseAbs().maxCoeff(), 1e-4);
  }
}

struct FirstTolerances final : StepObserver {
  void on_iteration(const IterationReport& report) override {
    if (of.size() < 2) of.push_back(report.solve.linear.tolerance);
  }
  std::vector<double> of;
};

/// A rim that rises takes more exact directions, until it is at its pose.
TEST(ExecutorSettings, PrescribedMotionIsSolvedForFurther) {
  Scene scene = held_sheet();
  for (Pin& pin : scene.pins) pin.motion = static_cast<int>(scene.motions.size());
  scene.motions.emplace_back();
  scene.motions.back().velocity = Vec3d(0, 0, 0.1);
  Method method = test::fixed_method("cubic", 20);
  test::run_on_executor(method);
  method.linear.parameters["forcing"] = std::string("eisenstat_walker");
  Simulation simulation(scene, method, 0.01, 1);
  FirstTolerances tolerances;
  ASSERT_EQ(simulation.step(tolerances).status, StepStatus::converged);
  EXPECT_EQ(tolerances.of, (std::vector<double>{1e-3, 0.1}));
  EXPECT_NEAR(simulation.history().x(2, 0), scene.x0(2, 0) + 1e-3, 1e-12);
}

Method with_step_solver(const std::string& name, const ParameterMap& parameters) {
  Method method = cubic();
  choose_step_solver(method, name);
  method.step_solver.parameters = parameters;
  return method;
}

TEST(ExecutorSettings, AccumulatedTimesOfImpact) {
  const ParameterMap choices[] = {{}, {{"target_toi", 0.9}}, {{"min_newton_steps", 4}}};
  int shortened = 0;
  for (const ParameterMap& parameters : choices) {
    SCOPED_TRACE(parameters.empty() ? "defaults" : parameters.begin()->first);
    const auto method = [&] { return with_step_solver("accumulated_toi", parameters); };
    Scene scene = test::cloth_on_plate();
    scene.v0.row(2).array() -= 1.5;  // a bound holds the first steps
    const RunEnd end = expect_same_run(scene, method, 8, tolerance);
    for (const double dt : end.dt_s) shortened += dt < 0.999 * 0.01;
  }
  EXPECT_GT(shortened, 3);
}

/// d_hat is longer than the edges, so that every vertex has neighbours of its own sheet in reach.
TEST(ExecutorSettings, WithoutTheRestRule) {
  SceneBuilder builder("sheet", false, Vec3d(0, 0, -10), "test");
  builder.add_body(test::cloth_spec(5, 0.4, 0.3));
  const Scene scene = builder.finish();
  const auto with = [](RestRule rule) {
    Method method = cubic();
    method.contact_options.rest_rule = rule;
    return method;
  };
  const RunEnd on = test::run_steps(scene, with(RestRule::on), 4),
               off = expect_same_run(
                   scene, [&] { return with(RestRule::off); }, 4, tolerance);
  EXPECT_GT(off.contacts, on.contacts + 100);
  EXPECT_GT((off.x - on.x).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(ExecutorSettings, PartsOfABound) {
  for (const double cap : {0.3, 1.0}) {
    SCOPED_TRACE(cap);
    const auto method = [&] { return with_step_solver("line_search", {{"cap_fraction", cap}}); };
    expect_same_run(test::cloth_on_plate(), method, 8, tolerance);
  }
}

// Where bounds say how far a step gets, every option is seen in the state.
TEST(ExecutorSettings, OptionsOfContact) {
  const std::pair<const char*, std::function<void(Method&)>> changes[] = {
      {"without a mollifier", [](Method& m) { m.contact_options.mollifier = Mollifier::none; }},
      {"parked farther away", [](Method& m) { m.contact_options.ccd_park = 0.05; }},
      {"of the squared gap", [](Method& m) { m.contact.argument = Argument::squared_gap; }}};
  Scene scene = test::cloth_on_plate();
  scene.v0.row(2).array() -= 1.5;
  const RunEnd base = test::run_steps(scene, with_step_solver("accumulated_toi", {}), 8);
  for (const auto& [what, change] : changes) {
    SCOPED_TRACE(what);
    const auto method = [&change = change] {
      Method out = with_step_solver("accumulated_toi", {});
      change(out);
      return out;
    };
    const RunEnd end = expect_same_run(scene, method, 8, tolerance);
    EXPECT_GT((end.x - base.x).cwiseAbs().maxCoeff(), 10 * tolerance);
  }
}

/// A rod and a block of two models that fall on a floor.
Scene rod_and_blocks() {
  SceneBuilder builder("rod and blocks", false, Vec3d(0, 0, -10), "test");
  BodySpec rod;
  rod.name = "rod";
  rod.mesh = rod_mesh(6, Vec3d(0, 0, 0.015), Vec3d(0.3, 0.02, 0.025));
  rod.material.line_density = 0.1;
  rod.material.rod_stretching = 30;
  rod.material.rod_bending = 1e-3;
  rod.d_hat = 0.02;
  PinSpec end;
  end.indices = {0};
  rod.pins = {end};
  builder.add_body(rod);
  for (const char* model : {"stable_neo_hookean", "corotational"}) {
    BodySpec block;
    block.name = model;
    block.mesh = solid_box_mesh({1, 2, 1}, Vec3d(0.1, 0.2, 0.1));
    block.mesh.vertices.row(1).array() += *model == 's' ? 0.4 : 0.8;
    block.mesh.vertices.row(2).array() += 0.065;
    block.material.solid_model = model;
    block.material.solid_youngs = 2e3;
    block.material.solid_density = 20;
    block.d_hat = 0.02;
    builder.add_body(block);
  }
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

TEST(ExecutorSettings, RodsAndSolids) { expect_same_run(rod_and_blocks(), cubic, 8, tolerance); }

TEST(ExecutorSettings, OtherPrecisionsHaveNoKernels) {
  Method method = cubic();
  method.precision = Precision::mixed;
  test::run_on_executor(method);
  const Scene scene = test::cloth_on_plate();
  EXPECT_THROW(Simulation(scene, method, 0.01, 1), ConfigError);
}

TEST(ExecutorSettings, StiffnessOfTheStrainLimit) {
  const std::pair<Refresh, KappaDerivative> rules[] = {{Refresh::per_iteration, KappaDerivative::dropped},
                                                       {Refresh::per_step, KappaDerivative::dropped},
                                                       {Refresh::per_step, KappaDerivative::included}};
  for (const auto& [refresh, derivative] : rules) {
    SCOPED_TRACE(static_cast<int>(refresh) + 2 * static_cast<int>(derivative));
    const auto method = [refresh = refresh, derivative = derivative] {
      Method out = cubic();
      out.limit_stiffness =
          test::elastic_limit({.mass_term = MassTerm::scaled, .refresh = refresh, .derivative = derivative});
      return out;
    };
    Scene scene = test::cloth_on_plate();
    std::fill(scene.limit.onset.begin(), scene.limit.onset.end(), 1e-3);
    const RunEnd end = expect_same_run(scene, method, 8, tolerance);
    EXPECT_GT(end.limit_load_max, 0);
  }
}

TEST(ExecutorSettings, InexactSolvesAndClusters) {
  for (const char* preconditioner : {"block_jacobi", "multilevel_schwarz"}) {
    SCOPED_TRACE(preconditioner);
    Method on_host = cubic(), resident = cubic();
    test::use_executor_solver(on_host);
    test::run_on_executor(resident);
    resident.linear.parameters["resident_preconditioner"] = std::string(preconditioner);
    resident.linear.parameters["forcing"] = std::string("eisenstat_walker");
    const Scene scene = test::cloth_on_plate();
    const RunEnd cpu = test::run_steps(scene, std::move(on_host), 8);
    test::expect_same_end(test::run_steps(scene, std::move(resident), 8), cpu, 10 * tolerance);
  }
}

TEST(ExecutorSettings, StepsThatAreTriedAgain) {
  for (const char* policy : {"fixed", "ipc_adaptive"}) {
    SCOPED_TRACE(policy);
    const Scene scene = test::cloth_on_plate();
    const auto method = [&](int cap, int retries) {
      Method out = std::string(policy) == "fixed" ? cubic() : test::method_with_policy("cubic", policy, {});
      out.step_solver.max_iterations = cap;
      out.step_solver.retries = retries;
      return out;
    };
    const RunEnd whole = test::run_steps(scene, method(200, 0), 6);
    const int most = *std::max_element(whole.iterations.begin(), whole.iterations.end());
    const RunEnd end = expect_same_run(
        scene, [&] { return method(most - 1, 4); }, 8, tolerance);
    EXPECT_GT(*std::max_element(end.retries.begin(), end.retries.end()), 0);
    EXPECT_LT(*std::min_element(end.dt_s.begin(), end.dt_s.end()), 0.01);
  }
}

}  // namespace
}  // namespace bb::exec_settings_test
