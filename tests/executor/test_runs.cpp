// Whole steps of an executor's engine end where those of the host's end: what terms take from step to step, and what they do where a step is
// cut, tried again or solved again. States: test_same_bits.cpp.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/energy/friction_law.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/executor/run_scenes.hpp"

namespace bb::exec_runs_test {
namespace {

using namespace bb::test;

constexpr double tolerance = 1e-6;  // m, after some steps of 1e-8 m each

struct RunCase {
  std::string name;
  Scene scene;
  int steps;
  std::function<Method()> method = cubic;
  std::function<bool(const RunEnd&)> shows = [](const RunEnd&) {
    return true;
  };                                                           // what the case is there for
  std::function<void(Method&)> change_there = [](Method&) {};  // of the executor's method alone
  double allowed = 2 * tolerance;                              // m
};

bool slides(const RunEnd& end) { return end.sliding > 10 && end.friction_work > 1e-6; }
bool bounces(const RunEnd& end) { return end.bounce_work > 1e-5; }
bool is_shorter(const RunEnd& end) { return *std::ranges::min_element(end.dt_s) < 0.999 * 0.01; }

Method with_step_solver(const std::string& name, const ParameterMap& parameters) {
  Method method = cubic();
  choose_step_solver(method, name);
  method.step_solver.parameters = parameters;
  return method;
}
Method with_elastic_kappa(const char* term, const char* refresh, const char* derivative = "dropped") {
  return method_with_policy("cubic", "elasticity_inclusive",
                            {{"mass_term", std::string(term)},
                             {"refresh", std::string(refresh)},
                             {"derivative", std::string(derivative)}});
}
/// f() with a change.
template <class Change>
std::function<Method()> with(const std::function<Method()>& f, const Change& change) {
  return [=] {
    Method out = f();
    change(out);
    return out;
  };
}

void add_policies(std::vector<RunCase>& out) {
  out.push_back({"ipc_adaptive", two_sheets(), 10,
                 [] { return method_with_policy("cubic", "ipc_adaptive", {}); },
                 [](const RunEnd& end) { return end.kappa_start > 0; }});
  out.push_back({"kappa of every iterate", two_sheets(), 10,
                 [] { return with_elastic_kappa("inertia", "per_iteration"); }});
  out.push_back(
      {"kappa of every step", two_sheets(), 10, [] { return with_elastic_kappa("inertia", "per_step"); }});
  out.push_back({"kappa with a potential", two_sheets(), 10,
                 [] { return with_elastic_kappa("scaled", "per_step", "included"); }});
  Scene limited = cloth_on_plate();
  std::fill(limited.limit.onset.begin(), limited.limit.onset.end(), 1e-3);
  const std::pair<Refresh, KappaDerivative> rules[] = {{Refresh::per_iteration, KappaDerivative::dropped},
                                                       {Refresh::per_step, KappaDerivative::dropped},
                                                       {Refresh::per_step, KappaDerivative::included}};
  for (const auto& [refresh, derivative] : rules) {
    const ElasticityInclusive rule{
        .mass_term = MassTerm::scaled, .refresh = refresh, .derivative = derivative};
    out.push_back({"kappa of the strain limit, rule " + std::to_string(out.size()), limited, 8,
                   with(cubic, [=](Method& m) { m.limit_stiffness = elastic_limit(rule); }),
                   [](const RunEnd& end) { return end.limit_load_max > 0; }});
  }
  for (const StepHessian choice : {StepHessian::blend, StepHessian::progressive}) {
    out.push_back({std::string(to_string(choice)), cloth_on_balls_and_bar(), 4, with(cubic, [=](Method& m) {
                     m.contact = {require_shape("log"), Argument::gap};
                     m.hessian_mode = HessianMode::projected_full;
                     for (const HessianChoice& term : hessian_choices()) m.step_hessian[term.name] = choice;
                   })});
  }
}

/// What bounds and cuts a step, where every option is seen in the state.
void add_bounds(std::vector<RunCase>& out) {
  Scene thrown = cloth_on_plate();
  thrown.v0.row(2).array() -= 1.5;  // a bound holds the first steps
  const auto accumulated = [] { return with_step_solver("accumulated_toi", {}); };
  out.push_back({"accumulated times of impact", thrown, 8, accumulated, is_shorter});
  for (const ParameterMap& parameters :
       {ParameterMap{{"target_toi", 0.9}}, ParameterMap{{"min_newton_steps", 4}}}) {
    out.push_back({parameters.begin()->first, thrown, 8,
                   [=] { return with_step_solver("accumulated_toi", parameters); }, is_shorter});
  }
  out.push_back({"without a mollifier", thrown, 8,
                 with(accumulated, [](Method& m) { m.contact_options.mollifier = Mollifier::none; })});
  out.push_back({"parked farther away", thrown, 8,
                 with(accumulated, [](Method& m) { m.contact_options.min_gap_fraction = 0.05; })});
  out.push_back({"part of a bound", cloth_on_plate(), 8, [] {
                   return with_step_solver("line_search", {{"cap_fraction", 0.3}});
                 }});
  SceneBuilder builder("sheet", false, Vec3d(0, 0, -10), "test");  // d_hat is longer than its edges
  builder.add_body(cloth_spec(5, 0.4, 0.3));
  out.push_back({"without the rest rule", builder.finish(), 4,
                 with(cubic, [](Method& m) { m.contact_options.rest_rule = RestRule::off; }),
                 [](const RunEnd& end) { return end.contacts > 100; }});
  for (const PlanarPairs pairs : {PlanarPairs::point_edge, PlanarPairs::vertex_vertex})
    out.push_back({"planar", planar_strips(pairs), 10, cubic,
                   [](const RunEnd& end) { return end.x.row(2).cwiseAbs().maxCoeff() == 0; }});
}

/// How a direction is solved for, and steps of a load.
void add_solves(std::vector<RunCase>& out) {
  out.push_back({"multilevel_schwarz", cloth_on_plate(), 8, with(cubic, [](Method& m) {
                   m.linear.parameters["resident_preconditioner"] = std::string("multilevel_schwarz");
                 })});
  out.push_back(
      {"inexact solves", cloth_on_plate(), 8, cubic, [](const RunEnd& end) { return end.solved_to > 1e-3; },
       [](Method& m) { m.linear.parameters["forcing"] = std::string("eisenstat_walker"); }, 10 * tolerance});
  out.push_back({"load steps without inertia", held_sheet(), 8,
                 [] { return fixed_method("cubic", 20, "quasi_static"); },
                 [](const RunEnd& end) {  // the load grows from step to step
                   return (end.x_of_steps[0] - end.x_of_steps[4]).cwiseAbs().maxCoeff() > 1e-4 &&
                          (end.x_of_steps[4] - end.x).cwiseAbs().maxCoeff() > 1e-4;
                 }});
}

/// Static and kinetic coefficients; loads of every iterate.
void add_friction_forms(std::vector<RunCase>& out) {
  out.push_back({"two coefficients", drawn_cloth(), 6,
                 with([] { return rubbing("static_kinetic", 0.1); },
                      [](Method& m) { m.friction.mu_static = 0.4, m.friction.kinetic_v = 0.1; }),
                 slides});
  const auto at_iterates = [](Method& m) {
    m.friction = rubbing("capped").friction;
    m.friction.refresh = FrictionRefresh::per_iteration;
  };
  out.push_back({"loads of every iterate", drawn_cloth(), 6, with(cubic, at_iterates), slides});
  out.push_back({"as published", drawn_cloth(), 6,
                 with([] { return with_step_solver("accumulated_toi", {}); },
                      [=](Method& m) {
                        at_iterates(m);
                        m.friction.hessian = FrictionHessian::secant;
                        m.friction.eps_m = 1e-4;
                      }),
                 slides});
}

void add_lagged(std::vector<RunCase>& out) {
  for (const std::string& law : friction_law_names())
    out.push_back({law, drawn_cloth(), 6, [=] { return rubbing(law); }, slides});
  Scene sides = drawn_cloth();
  sides.bodies[0].friction = 0.5, sides.bodies[1].friction = 0.1, sides.obstacles[0].friction = 0.8;
  for (const CombineRule rule : {CombineRule::min, CombineRule::max, CombineRule::mean}) {
    out.push_back(
        {"sides", sides, 4,
         with([] { return rubbing("smoothed_coulomb", 0); }, [=](Method& m) { m.friction.combine = rule; }),
         slides});
  }
  Scene sheets = touching(two_sheets(), 0.008);
  for (int v = 16; v < sheets.n_vertices(); ++v) sheets.v0(0, v) = 0.2;
  out.push_back({"all kinds of rows", sheets, 4,
                 with([] { return with_elastic_kappa("inertia", "per_step"); },
                      [](Method& m) {
                        m.friction = rubbing().friction;
                        m.hessian_mode = HessianMode::projected_full;
                      }),
                 slides});
  for (const int times : {2, 3}) {
    out.push_back({"solved again", drawn_cloth(), 5,
                   with([] { return rubbing(); }, [=](Method& m) { m.friction.lag_iterations = times; }),
                   slides});
  }
  out.push_back(
      {"restitution", bouncing(), 12, [] { return fixed_method("cubic", 200, "newmark"); }, bounces});
  out.push_back({"restitution and friction", bouncing(), 8,
                 with([] { return rubbing(); }, [](Method& m) { m.friction.lag_iterations = 2; }),
                 [](const RunEnd& end) { return bounces(end) && end.sliding + end.sticking > 5; }});
  const auto stiff = [] { return fixed_method("cubic", 40); };
  out.push_back({"moving obstacles", cloth_on_moving(false), 8, stiff,
                 [](const RunEnd& end) { return end.contacts > 40; }});
  out.push_back({"moving obstacles, curved", cloth_on_moving(false), 8,
                 with(stiff, [](Method& m) { m.hessian_mode = HessianMode::projected_full; })});
  const RunEnd still = run_steps(cloth_on_moving(false), rubbing("smoothed_coulomb", 0.4), 6);
  out.push_back(
      {"turning obstacles", cloth_on_moving(true), 6, [] { return rubbing("smoothed_coulomb", 0.4); },
       [=](const RunEnd& end) { return (end.x - still.x).cwiseAbs().maxCoeff() > 100 * tolerance; }});
  out.push_back({"rods and solids", rod_and_blocks(), 8});
  out.push_back({"driven", driven(), 8});
  out.push_back({"released pins", released(), 8, [] { return rubbing(); },
                 [](const RunEnd& end) { return end.x(2, 0) < 0.02 + 0.1 * 0.08 - 1e-4; }});  // it fell
}

TEST(ExecutorRun, EndsWhereTheHostEnds) {
  std::vector<RunCase> cases;
  add_policies(cases), add_bounds(cases), add_solves(cases), add_lagged(cases);
  add_friction_forms(cases);
  for (const RunCase& one : cases) {
    SCOPED_TRACE(one.name);
    const RunEnd end = expect_same_run(one.scene, one.method, one.steps, one.allowed, one.change_there);
    EXPECT_TRUE(one.shows(end));
  }
  EXPECT_GT(cases.size(), 30U);
}

TEST(ExecutorRun, TriesStepsAgainAsTheHostDoes) {
  for (const char* policy : {"fixed", "ipc_adaptive"}) {
    SCOPED_TRACE(policy);
    const auto method = [&](int cap, int retries) {
      Method out = std::string(policy) == "fixed" ? cubic() : method_with_policy("cubic", policy, {});
      out.step_solver.max_iterations = cap;
      out.step_solver.retries = retries;
      return out;
    };
    const RunEnd whole = run_steps(cloth_on_plate(), method(200, 0), 6);
    const int most = *std::ranges::max_element(whole.iterations);
    const RunEnd end = expect_same_run(
        cloth_on_plate(), [&] { return method(most - 1, 4); }, 8, tolerance);
    EXPECT_GT(*std::ranges::max_element(end.retries), 0);
    EXPECT_TRUE(is_shorter(end));
  }
}

struct FirstTolerances final : StepObserver {
  void on_iteration(const IterationReport& report) override {
    if (of.size() < 2) of.push_back(report.solve.linear.tolerance);
  }
  std::vector<double> of;
};

/// Corners that rise take more exact directions, until they are at their poses.
TEST(ExecutorRun, SolvesFurtherForPrescribedMotion) {
  const Scene scene = released();
  Method method = cubic();
  run_on_executor(method);
  method.linear.parameters["forcing"] = std::string("eisenstat_walker");
  Simulation simulation(scene, method, 0.01, 1);
  FirstTolerances tolerances;
  ASSERT_EQ(simulation.step(tolerances).status, StepStatus::converged);
  EXPECT_EQ(tolerances.of, (std::vector<double>{1e-3, 0.1}));
  EXPECT_NEAR(simulation.history().x(2, 0), scene.x0(2, 0) + 1e-3, 1e-12);
}

TEST(ExecutorRun, IsTheSameInEveryOrder) {
  const auto end = [](exec::Order order) {
    Method method = rubbing();
    run_on_executor(method, order);
    return run_steps(drawn_cloth(), std::move(method), 8);
  };
  const RunEnd first = end(exec::Order::threads);
  ASSERT_GT(first.contacts, 0u);
  ASSERT_TRUE(slides(first));
  for (const exec::Order order : {exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    const RunEnd other = end(order);
    EXPECT_EQ(other.x, first.x);
    EXPECT_EQ(other.iterations, first.iterations);
  }
}

TEST(ExecutorRun, RefusesOtherPrecisions) {
  Method method = cubic();
  method.precision = Precision::mixed;
  run_on_executor(method);
  EXPECT_THROW(Simulation(cloth_on_plate(), method, 0.01, 1), ConfigError);
}

}  // namespace
}  // namespace bb::exec_runs_test
