// A Newton system on an executor: states that feasibility alone judged, its copy on the host, saddles, what it refuses. States and runs beside
// the host: test_same_bits.cpp, test_runs.cpp.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include <functional>

#include "tests/executor/both_systems.hpp"
#include "tests/executor/run_scenes.hpp"
#include "tests/newton/saddle_scenes.hpp"

namespace bb::exec_system_test {
namespace {

using test::Both;
using test::run_on_executor;
using test::touching_method;

constexpr double dt = 0.01;

/// The state that a step without energies ends with says what it would, energies of the iterate included.
TEST(ExecutorSystem, AcceptsWhatFeasibilityAloneJudged) {
  for (const bool first_asks : {false, true}) {
    Both known(test::touching(test::cloth_on_plate(), 0.012), touching_method),
        late(test::touching(test::cloth_on_plate(), 0.012), touching_method);
    for (Both* both : {&known, &late}) {
      ASSERT_EQ(both->resident.find_direction().linear.status, LinearStatus::ok);
      both->resident.scale_direction(30);
      both->resident.prepare_motion(MotionEnd::free, true);
      IterationReport report;
      const double alpha = 0.5 * both->resident.bound_motion(report);
      EXPECT_FALSE(both->resident.try_feasible(1e200));
      if (both == &known) {
        ASSERT_TRUE(both->resident.try_motion(alpha).has_value());
      } else {
        ASSERT_TRUE(both->resident.try_feasible(alpha));
      }
      both->resident.accept();
    }
    StepNumbers a, b;
    if (first_asks) known.resident.view().report_end(a), late.resident.view().report_end(b);
    for (const TermGroup group : {TermGroup::load, TermGroup::elastic, TermGroup::contact}) {
      EXPECT_NE(known.resident.view().energy(group), 0);
      EXPECT_EQ(late.resident.view().energy(group), known.resident.view().energy(group));
    }
    if (!first_asks) known.resident.view().report_end(a), late.resident.view().report_end(b);
    ASSERT_GT(a.contacts.total(), 0U);
    EXPECT_GT(a.contact_load_sum_N.value, 0);
    EXPECT_EQ(b.contact_load_sum_N.value, a.contact_load_sum_N.value);
    const auto from = known.resident.try_motion(1e-3), to = late.resident.try_motion(1e-3);
    ASSERT_TRUE(from && to);
    EXPECT_NE(from->change, 0);
    EXPECT_EQ(to->change, from->change);
  }
}

/// Friction and restitution of the step that it is in, which the copy does not find from the iterate.
TEST(ExecutorSystem, ShowsItsStateToTheCpu) {
  for (const double restitution : {0.0, 0.5}) {
    Scene scene = test::drawn_cloth();
    if (restitution > 0) scene.bodies[0].restitution = restitution;
    Both both(scene, [] {
      Method method = test::rubbing();
      method.hessian_mode = HessianMode::projected_full;
      method.friction.lag_iterations = 2;
      return method;
    });
    for (int step = 0; step < 3; ++step) {
      if (step > 0) {
        const Positions x = both.resident.view().x();
        both.resident.end_step();
        Prediction falling;
        falling.x_tilde = x - Positions::Constant(3, x.cols(), 2e-3);
        both.resident.begin_step(x, falling, dt, 1);
        both.resident.assemble();
      }
      ASSERT_EQ(both.resident.find_direction().linear.status, LinearStatus::ok);
      both.resident.prepare_motion(MotionEnd::on_target, true);
      IterationReport report;
      ASSERT_TRUE(both.resident.try_motion(0.9 * both.resident.bound_motion(report)).has_value());
      both.resident.accept();
      EXPECT_TRUE(both.resident.renew_lag());  // so that it is not that of the start
      both.resident.assemble();
    }
    NewtonSystem& seen = both.resident.on_host();
    EXPECT_EQ(seen.view().x(), both.resident.view().x());
    EXPECT_GT(contact_state(seen.diagnosis().terms()).size(), 0u);
    const double friction = both.resident.view().energy(TermGroup::friction);
    EXPECT_GT(friction, 1e-9);
    EXPECT_NEAR(seen.view().energy(TermGroup::friction), friction, 1e-13 * friction);
    const Positions found = both.resident.view().gradient(), expected = seen.view().gradient();
    for (int v = 0; v < scene.n_vertices(); ++v) {  // rows have no force at given vertices on an executor
      if (scene.mass[static_cast<std::size_t>(v)] == 0) continue;
      EXPECT_LE((found.col(v) - expected.col(v)).cwiseAbs().maxCoeff(),
                1e-13 * expected.cwiseAbs().maxCoeff());
    }
    EXPECT_NEAR(both.resident.view().energy(), seen.view().energy(), 1e-13 * std::abs(seen.view().energy()));
  }
}

/// Sums over the loads of every two owners, bodies as they are and obstacles as -2 - o: load, load times gap.
std::map<std::set<int>, std::pair<double, double>> sums_of(const Scene& scene,
                                                           const std::vector<ContactLoad>& loads) {
  std::map<std::set<int>, std::pair<double, double>> out;
  for (const ContactLoad& each : loads) {
    std::set<int> owners;
    for (const int id : each.key) {
      if (id != -1) owners.insert(id < 0 ? id : scene.body[static_cast<std::size_t>(id)]);
    }
    auto& [load, moment] = out[owners];
    load += each.load_N;
    moment += each.load_N * each.gap_rel;
  }
  return out;
}

/// Compares what the CPU is shown at every step's end with what the system has.
class CompareWithCpu final : public StepObserver {
 public:
  void on_step(StepSystem& system, const StepReport& report, const Positions&) override {
    NewtonSystem& seen = system.on_host();
    EXPECT_EQ(seen.view().x(), system.view().x());
    for (const TermGroup group : {TermGroup::elastic, TermGroup::limit, TermGroup::contact}) {
      const double own = system.view().energy(group);
      EXPECT_NEAR(seen.view().energy(group), own, 1e-9 * std::abs(own) + 1e-16) << "step " << report.step;
      n_energies += own > 0;
    }
    EXPECT_EQ(seen.diagnosis().rhs().size(), seen.view().n_free());
    n_rows += contact_state(seen.diagnosis().terms()).size();
    StepNumbers numbers;
    seen.view().report_end(numbers);
    const auto expected = sums_of(system.view().scene(), numbers.contact_loads),
               found = sums_of(system.view().scene(), report.contact_loads);
    ASSERT_EQ(found.size(), expected.size()) << "step " << report.step;
    for (const auto& [owners, sums] : expected) {
      ASSERT_TRUE(found.contains(owners));
      EXPECT_NEAR(found.at(owners).first, sums.first, 1e-9 * sums.first) << "step " << report.step;
      EXPECT_NEAR(found.at(owners).second, sums.second, 1e-9 * sums.second) << "step " << report.step;
      pairs.insert(owners);
    }
  }
  std::set<std::set<int>> pairs;  // with load
  int n_energies = 0;
  std::size_t n_rows = 0;
};

TEST(ExecutorRun, IsShownToTheCpuWithItsStiffness) {
  const ParameterMap frozen = {{"mass_term", std::string("inertia")}, {"refresh", std::string("per_step")}},
                     potential = {{"mass_term", std::string("scaled")},
                                  {"refresh", std::string("per_step")},
                                  {"derivative", std::string("included")}};
  const std::pair<const char*, ParameterMap> policies[] = {{"fixed", {{"kappa_N_per_m", 20.0}}},
                                                           {"elasticity_inclusive", frozen},
                                                           {"elasticity_inclusive", potential}};
  for (const auto& [name, parameters] : policies) {
    SCOPED_TRACE(std::string(name) + " " + std::to_string(parameters.size()));
    Method method = test::method_with_policy("cubic", name, parameters);
    run_on_executor(method);
    const Scene scene = test::cloth_on_plate();
    Simulation simulation(scene, method, dt, 10);
    CompareWithCpu observer;
    for (int i = 0; i < 10; ++i) simulation.step(observer);
    EXPECT_GT(observer.n_energies, 10);
    EXPECT_GT(observer.n_rows, 0u);
    const std::set<std::set<int>> both = {{0, 1}, {-2, 0}};  // the plate, the floor
    EXPECT_EQ(observer.pairs, both);
  }
}

TEST(ExecutorSystem, RefusesWhatHasNoDeviceForm) {
  const Scene scene = test::two_sheets();
  const auto message = [&](const std::function<void(Method&)>& change) {
    Method method = test::fixed_method("cubic", 20);
    run_on_executor(method);
    change(method);
    try {
      Simulation simulation(scene, method, dt, 1);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(message([](Method&) {}), "nothing");
  EXPECT_NE(message([](Method& m) { m.linear = {}; }).find("pcg_resident"), std::string::npos);
  // a shape without a kernel runs where the executor is the processor
  EXPECT_EQ(
      message([](Method& m) { m.contact.shape.name = "of a plugin", m.contact.shape.launches = nullptr; }),
      "nothing");
}

/// Steps of sheets between two planes, on the CPU and resident: the same word for the end, from both sides of it.
TEST(ExecutorSystem, SaysTheSameOfSaddles) {
  for (const double speed : {0.2, -0.2}) {
    for (const SaddleRule rule : {SaddleRule::report, SaddleRule::escape}) {
      test::SheetCase sheet;
      sheet.speed = speed;
      std::array<StepReport, 2> ends;
      std::array<double, 2> height{};
      for (const std::size_t resident : {0, 1}) {
        Scene scene = test::driven_sheet(sheet);
        Method method = test::saddle_method(rule);
        if (resident == 1) test::run_on_executor(method);
        Simulation simulation(scene, method, test::sheet_dt, 1);
        StepObserver nobody;
        ends[resident] = simulation.step(nobody);
        height[resident] = simulation.history().x.row(2).cwiseAbs().maxCoeff();
        ASSERT_EQ(ends[resident].status, StepStatus::converged) << ends[resident].detail;
        ASSERT_GT(ends[resident].contacts.total(), 0U);
        for (const Pin& pin : scene.pins) {  // an escape moves no prescribed vertex
          EXPECT_EQ(simulation.history().x.col(pin.vertex), Vec3d(pin_pose(scene, pin, test::sheet_dt)));
        }
      }
      const bool saddle = speed > 0 && rule == SaddleRule::report;
      EXPECT_EQ(ends[0].end_proof, saddle ? EndProof::saddle : EndProof::factor);
      EXPECT_EQ(ends[1].end_proof, saddle ? EndProof::saddle : EndProof::lanczos);
      EXPECT_EQ(ends[0].escapes > 0, ends[1].escapes > 0);
      EXPECT_EQ(height[0] > 1e-3, height[1] > 1e-3);
      EXPECT_GT(ends[1].end_check_iterations, 0);
      EXPECT_EQ(ends[0].saddle_curvature_N_per_m.finite(), ends[1].saddle_curvature_N_per_m.finite());
    }
  }
}

}  // namespace
}  // namespace bb::exec_system_test
