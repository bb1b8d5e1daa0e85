// What is kept between steps: a run goes on from an archive of either path, on either path.
#include <gtest/gtest.h>

#include "core/base/archive/archive.hpp"
#include "tests/executor/run_scenes.hpp"

namespace bb::exec_archive_test {
namespace {

using test::RunEnd;

constexpr int steps = 8, before = 3;
constexpr double dt = 0.01;

/// A scene, a method, and the run of it that is kept after some steps.
struct Case {
  const char* name;
  Scene scene;
  std::function<Method()> method;
};

Method adapting(const char* integrator) {
  // kappa starts where it carries the weight, and doubles as long as gaps shrink
  Method out = test::method_with_policy("cubic", "ipc_adaptive",
                                        {{"kappa_min_N_per_m", 1e-3}, {"doubling_gap_m", 0.02}});
  out.integrator = make_integrator(integrator);
  return out;
}

std::vector<Case> cases() {
  const ParameterMap frozen = {{"mass_term", std::string("inertia")}, {"refresh", std::string("per_step")}};
  const auto in_parts = [] {
    Method out = adapting("implicit_euler");
    out.step_solver.max_iterations = 3;
    out.step_solver.retries = 6;
    return out;
  };
  Scene cloth = test::touching(test::cloth_on_plate(), 0.012);
  cloth.v0.row(2).array() -= 0.2;
  Scene bounced = test::drawn_cloth();
  bounced.bodies[0].restitution = 0.5;
  return {{"ipc_adaptive", cloth, [] { return adapting("implicit_euler"); }},
          {"bdf2", cloth, [] { return adapting("bdf2"); }},
          {"newmark", cloth, [] { return adapting("newmark"); }},
          {"elasticity_inclusive", cloth,
           [=] { return test::method_with_policy("cubic", "elasticity_inclusive", frozen); }},
          {"in the middle of a step", cloth, in_parts},
          {"restitution", bounced, [] { return test::rubbing(); }},
          {"driven", test::driven(), test::cubic}};
}

void set_path(Method& method, bool on_executor) {
  if (on_executor) {
    test::run_on_executor(method);
  } else {
    test::use_executor_solver(method);
  }
}

struct Ends {
  RunEnd straight, resumed;
  StiffnessPolicy::State kappa, kappa_resumed;
  int doublings_before = 0;  // of kappa, before the archive
  bool in_parts = false;     // the archive lies within a step
};

/// The end of a run, and that of one that goes on from its archive, each on its path.
Ends run_both(const Case& of, bool from_executor, bool to_executor) {
  Method whole = of.method(), again = of.method();
  set_path(whole, from_executor);
  set_path(again, to_executor);
  Simulation simulation(of.scene, whole, dt, steps), resumed(of.scene, again, dt, steps);
  test::run_steps(simulation, before);
  Ends out;
  out.doublings_before = whole.stiffness->state().doublings;
  out.in_parts = simulation.time() < dt * (simulation.nominal_steps() + 1) - dt / 100 &&
                 simulation.time() > dt * simulation.nominal_steps() + dt / 100;
  Archive archive;
  simulation.keep(archive);
  Archive read(archive.bytes());
  resumed.keep(read);
  EXPECT_TRUE(read.at_end());
  EXPECT_EQ(again.stiffness->state().kappa, whole.stiffness->state().kappa);
  simulation.drop_caches();
  out.straight = test::run_steps(simulation, steps - before);
  out.resumed = test::run_steps(resumed, steps - before);
  EXPECT_EQ(resumed.time(), simulation.time());
  out.kappa = whole.stiffness->state();
  out.kappa_resumed = again.stiffness->state();
  return out;
}

TEST(ExecutorArchive, GoesOnToTheBitOnTheHost) {
  for (const Case& each : cases()) {
    SCOPED_TRACE(each.name);
    const Ends ends = run_both(each, true, true);
    EXPECT_EQ(ends.resumed.x, ends.straight.x);
    EXPECT_EQ(ends.resumed.iterations, ends.straight.iterations);
    EXPECT_EQ(ends.kappa_resumed.kappa, ends.kappa.kappa);
    EXPECT_GT(ends.straight.contacts, 0u);
    EXPECT_EQ(ends.straight.bounce_work > 0, std::string(each.name) == "restitution");
  }
}

TEST(ExecutorArchive, GoesOnFromPathToPath) {
  int doublings = 0, in_parts = 0;
  for (const Case& each : cases()) {
    for (const bool from_executor : {false, true}) {
      SCOPED_TRACE(std::string(each.name) + (from_executor ? " to the CPU" : " from the CPU"));
      const Ends ends = run_both(each, from_executor, !from_executor);
      const RunEnd &there = from_executor ? ends.straight : ends.resumed,
                   &cpu = from_executor ? ends.resumed : ends.straight;
      test::expect_same_end(there, cpu, 1e-6);
      EXPECT_EQ(ends.kappa_resumed.doublings, ends.kappa.doublings);
      doublings += ends.kappa.doublings - ends.doublings_before;
      in_parts += ends.in_parts ? 1 : 0;
    }
  }
  EXPECT_GT(doublings, 0);
  EXPECT_EQ(in_parts, 2);
}

}  // namespace
}  // namespace bb::exec_archive_test
