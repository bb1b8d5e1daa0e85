// The whole step of the resident pipeline against NewtonSystem: numbers of one iterate, states of whole runs.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include <functional>

#include "tests/executor/both_systems.hpp"
#include "tests/executor/system_cases.hpp"
#include "tests/newton/saddle_scenes.hpp"

namespace bb::exec_system_test {
namespace {

using test::Both;
using test::expect_same_run;
using test::run_on_executor;
using test::run_steps;
using test::RunEnd;
using test::touching_method;

constexpr double dt = 0.01;

double relative(const Positions& a, const Positions& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

void expect_same_iterate(Both& both) {
  ASSERT_GT(contact_state(both.cpu.diagnosis().terms()).size(), 0u);
  ASSERT_GT(both.cpu.view().energy(TermGroup::contact), 0);
  EXPECT_NEAR(both.resident.view().energy(), both.cpu.view().energy(),
              1e-13 * std::abs(both.cpu.view().energy()));
  for (const TermGroup group : {TermGroup::load, TermGroup::elastic, TermGroup::limit, TermGroup::contact}) {
    EXPECT_NEAR(both.resident.view().energy(group), both.cpu.view().energy(group),
                1e-13 * (1 + std::abs(both.cpu.view().energy(group))));
  }
  EXPECT_LT(relative(both.resident.view().gradient(), both.cpu.view().gradient()), 1e-13);
  ASSERT_EQ(both.cpu.find_direction().linear.status, LinearStatus::ok);
  ASSERT_EQ(both.resident.find_direction().linear.status, LinearStatus::ok);
  const DirectionSize cpu = both.cpu.direction_size(), resident = both.resident.direction_size();
  ASSERT_GT(cpu.inf_m, 1e-6);
  EXPECT_NEAR(resident.inf_m, cpu.inf_m, 1e-9 * cpu.inf_m);
  EXPECT_NEAR(resident.slope_J, cpu.slope_J, 1e-9 * std::abs(cpu.slope_J));
  EXPECT_NEAR(resident.vertex_m, cpu.vertex_m, 1e-9 * cpu.vertex_m);
  for (StepSystem* system : both.systems()) {  // along a direction of free vertices
    system->set_target(system->view().x());
    ASSERT_EQ(system->find_direction().linear.status, LinearStatus::ok);
  }
  EXPECT_NEAR(both.resident.direction_curvature(), both.cpu.direction_curvature(),
              1e-9 * std::abs(both.cpu.direction_curvature()));
}

TEST(ExecutorSystem, HasTheNumbersOfTheIterate) {
  Both plate(test::touching(test::cloth_on_plate(), 0.012), touching_method);
  EXPECT_FALSE(plate.cpu.view().at_target());
  EXPECT_FALSE(plate.resident.view().at_target());
  expect_same_iterate(plate);
  EXPECT_TRUE(plate.resident.view().at_target());  // held
  Both sheets(test::touching(test::two_sheets(), 0.01), touching_method);
  expect_same_iterate(sheets);
}

TEST(ExecutorSystem, BoundsAndTriesTheSameMotions) {
  Both both(test::touching(test::cloth_on_plate(), 0.012), touching_method);
  for (StepSystem* system : both.systems())
    ASSERT_EQ(system->find_direction().linear.status, LinearStatus::ok);
  for (StepSystem* system : both.systems()) {
    system->scale_direction(30);  // far beyond contact
    system->prepare_motion(MotionEnd::free, true);
  }
  IterationReport a, b;
  const double bound = both.cpu.bound_motion(a);
  ASSERT_LT(bound, 1);
  ASSERT_GT(bound, 0);
  EXPECT_NEAR(both.resident.bound_motion(b), bound, 1e-9 * bound);
  EXPECT_EQ(both.resident.view().describe_bound(), both.cpu.view().describe_bound());
  EXPECT_GT(b.bound.queries, 0);
  for (const double part : {0.5, 0.9}) {
    const auto from = both.cpu.try_motion(part * bound), to = both.resident.try_motion(part * bound);
    ASSERT_TRUE(from && to);
    ASSERT_NE(from->change, 0);
    EXPECT_NEAR(to->change, from->change, 1e-9 * from->magnitude);
    EXPECT_NEAR(to->magnitude, from->magnitude, 1e-9 * from->magnitude);
  }
  EXPECT_FALSE(both.resident.try_motion(1e200).has_value());
  ASSERT_TRUE(both.resident.try_motion(0.5 * bound).has_value());
  const Positions before = both.resident.view().x();
  both.resident.accept();
  EXPECT_EQ(both.resident.view().x_before(), before);
  EXPECT_NE(both.resident.view().x(), before);
}

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

TEST(ExecutorSystem, ShowsItsStateToTheCpu) {
  Both both(test::touching(test::cloth_on_plate(), 0.012), touching_method);
  ASSERT_EQ(both.resident.find_direction().linear.status, LinearStatus::ok);
  both.resident.prepare_motion(MotionEnd::on_target, true);
  IterationReport report;
  ASSERT_TRUE(both.resident.try_motion(0.5 * both.resident.bound_motion(report)).has_value());
  both.resident.accept();
  both.resident.assemble();
  NewtonSystem& seen = both.resident.on_host();
  EXPECT_EQ(seen.view().x(), both.resident.view().x());
  EXPECT_GT(contact_state(seen.diagnosis().terms()).size(), 0u);
  EXPECT_LT(relative(both.resident.view().gradient(), seen.view().gradient()), 1e-13);
  EXPECT_NEAR(both.resident.view().energy(), seen.view().energy(), 1e-13 * std::abs(seen.view().energy()));
}

// --- whole runs

TEST(ExecutorRun, EndsWhereTheCpuEndsForEveryShape) {
  for (const char* shape : {"log", "log_squared", "quadratic", "cubic", "two_stage", "exponential"}) {
    SCOPED_TRACE(shape);
    expect_same_run(
        test::cloth_on_plate(), [&] { return test::fixed_method(shape, 20); }, 12, 1e-6);
  }
}

TEST(ExecutorRun, EndsWhereTheCpuEndsForEveryPolicy) {
  using Parameters = ParameterMap;
  const std::pair<const char*, Parameters> policies[] = {
      {"ipc_adaptive", {}},
      {"elasticity_inclusive", {{"mass_term", std::string("inertia")}}},
      {"elasticity_inclusive", {{"mass_term", std::string("inertia")}, {"refresh", std::string("per_step")}}},
      {"elasticity_inclusive",
       {{"mass_term", std::string("scaled")},
        {"refresh", std::string("per_step")},
        {"derivative", std::string("included")}}}};
  for (const auto& [name, parameters] : policies) {
    SCOPED_TRACE(std::string(name) + " " + std::to_string(parameters.size()));
    expect_same_run(
        test::two_sheets(), [&] { return test::method_with_policy("cubic", name, parameters); }, 10, 1e-6);
  }
}

TEST(ExecutorRun, EndsWhereTheCpuEndsForEveryHessian) {
  for (const HessianMode mode : {HessianMode::gauss_newton, HessianMode::projected_full}) {
    for (const StepHessian choice : all_step_hessians) {
      SCOPED_TRACE(std::string(to_string(choice)) + " " + std::to_string(static_cast<int>(mode)));
      const auto method = [&] {
        Method out = test::fixed_method("log", 20);
        out.hessian_mode = mode;
        for (const HessianChoice& term : hessian_choices()) out.step_hessian[term.name] = choice;
        return out;
      };
      expect_same_run(test::cloth_on_plate(), method, 8, 1e-6);
      expect_same_run(test::cloth_on_balls_and_bar(), method, 4, 1e-6);
    }
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

TEST(ExecutorRun, IsTheSameInEveryOrder) {
  const auto end = [](exec::Order order) {
    Method method = test::fixed_method("cubic", 20);
    run_on_executor(method, order);
    return run_steps(test::cloth_on_plate(), std::move(method), 8);
  };
  const RunEnd first = end(exec::Order::threads);
  ASSERT_GT(first.contacts, 0u);
  for (const exec::Order order : {exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    const RunEnd other = end(order);
    EXPECT_EQ(other.x, first.x);
    EXPECT_EQ(other.iterations, first.iterations);
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

/// Which part of a direction is rounding: the same on the CPU and resident, with coordinates of all sizes.
TEST(ExecutorSystem, SplitsDirectionsAtTheSameRounding) {
  Both both(test::touching(test::cloth_on_plate(), 0.012), touching_method);
  for (StepSystem* system : both.systems()) {
    system->set_target(system->view().x());
    ASSERT_EQ(system->find_direction().linear.status, LinearStatus::ok);
  }
  for (const double scale : {1.0, 1e-12, 1e-14, 1e-16}) {
    for (StepSystem* system : both.systems()) system->scale_direction(scale);
    const DirectionSize cpu = both.cpu.direction_size(), resident = both.resident.direction_size();
    EXPECT_EQ(std::max(cpu.beyond_m, cpu.rounding_m), cpu.inf_m);
    EXPECT_NEAR(resident.beyond_m, cpu.beyond_m, 1e-8 * cpu.inf_m);
    EXPECT_NEAR(resident.rounding_m, cpu.rounding_m, 1e-8 * cpu.inf_m);
    for (StepSystem* system : both.systems()) system->scale_direction(1 / scale);
  }
}

}  // namespace
}  // namespace bb::exec_system_test
