// A Newton system on an executor: states that feasibility alone judged, saddles, what it refuses. States and runs beside
// the host: test_same_bits.cpp, test_runs.cpp.
#include <gtest/gtest.h>

#include <array>
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
      ASSERT_EQ(both->there.find_direction().linear.status, LinearStatus::ok);
      both->there.scale_direction(30);
      both->there.prepare_motion(MotionEnd::free, true);
      IterationReport report;
      const double alpha = 0.5 * both->there.bound_motion(report);
      EXPECT_FALSE(both->there.try_feasible(1e200));
      if (both == &known) {
        ASSERT_TRUE(both->there.try_motion(alpha).has_value());
      } else {
        ASSERT_TRUE(both->there.try_feasible(alpha));
      }
      both->there.accept();
    }
    StepNumbers a, b;
    if (first_asks) known.there.view().report_end(a), late.there.view().report_end(b);
    for (const TermGroup group : {TermGroup::load, TermGroup::elastic, TermGroup::contact}) {
      EXPECT_NE(known.there.view().energy(group), 0);
      EXPECT_EQ(late.there.view().energy(group), known.there.view().energy(group));
    }
    if (!first_asks) known.there.view().report_end(a), late.there.view().report_end(b);
    ASSERT_GT(a.contacts.total(), 0U);
    EXPECT_GT(a.contact_load_sum_N.value, 0);
    EXPECT_EQ(b.contact_load_sum_N.value, a.contact_load_sum_N.value);
    const auto from = known.there.try_motion(1e-3), to = late.there.try_motion(1e-3);
    ASSERT_TRUE(from && to);
    EXPECT_NE(from->change, 0);
    EXPECT_EQ(to->change, from->change);
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

/// Steps of sheets between two planes, on the CPU and on an executor: the same word for the end, from both sides of it.
TEST(ExecutorSystem, SaysTheSameOfSaddles) {
  for (const double speed : {0.2, -0.2}) {
    for (const SaddleRule rule : {SaddleRule::report, SaddleRule::escape}) {
      test::SheetCase sheet;
      sheet.speed = speed;
      std::array<StepReport, 2> ends;
      std::array<double, 2> height{};
      for (const std::size_t there : {0, 1}) {
        Scene scene = test::driven_sheet(sheet);
        Method method = test::saddle_method(rule);
        if (there == 1) test::run_on_executor(method);
        Simulation simulation(scene, method, test::sheet_dt, 1);
        StepObserver nobody;
        ends[there] = simulation.step(nobody);
        height[there] = simulation.history().x.row(2).cwiseAbs().maxCoeff();
        ASSERT_EQ(ends[there].status, StepStatus::converged) << ends[there].detail;
        ASSERT_GT(ends[there].contacts.total(), 0U);
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
