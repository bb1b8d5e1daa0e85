// The decisions of a step of accumulated_toi on numbers that are written down: when enough of the step was reached,
// what of a direction counts as advanced, and what ends the step without that.
#include <gtest/gtest.h>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/scripted_system.hpp"

namespace bb::accumulated_scripted_test {
namespace {

using test::Change;
using test::ScriptedIteration;
using test::ScriptedSystem;

constexpr double dt = 0.5, extension = 1.25;

struct Settings {
  double target = 0.25;
  int least = 1, most = 40;
  SaddleRule rule = SaddleRule::ignore;
};

/// A step on a script: what it reports of the step and of every iteration.
struct Advanced : private StepObserver {
  explicit Advanced(std::vector<ScriptedIteration> script, const Settings& settings = {})
      : system(std::move(script)) {
    StepSolverOptions options;
    options.name = "accumulated_toi";
    options.max_iterations = settings.most;
    options.saddle = settings.rule;
    options.parameters["target_toi"] = settings.target;
    options.parameters["min_newton_steps"] = settings.least;
    options.parameters["max_dx_m"] = 1.0;
    const auto integrator = make_integrator("implicit_euler");
    History history;
    history.x = history.x_prev = system.view().x();
    history.v = history.a = history.v_prev = Positions::Zero(3, 1);
    const StepTask task{0, dt, 1, &history, integrator.get(), [](double, Positions&) {}};
    Prediction used;
    report = make_step_solver(options)->advance(system, task, used, *this);
  }
  double reached() const { return report.dt_s / dt; }
  int passes() const { return static_cast<int>(iterations.size()); }

  ScriptedSystem system;
  StepReport report;
  std::vector<IterationReport> iterations;

 private:
  void on_iteration(const IterationReport& one) override { iterations.push_back(one); }
};

/// Directions of 0.1 m, of which this part (of 1.25 times them) is free.
ScriptedIteration free_for(double bound) {
  ScriptedIteration out{.dx = 0.1};
  out.bound = bound;
  return out;
}

TEST(AccumulatedScripted, AStepIsOverWhereTheTargetIsReached) {
  // one pass for each part, and the one that reduces the error
  EXPECT_EQ(Advanced({free_for(1)}).passes(), 2);
  EXPECT_EQ(Advanced({free_for(0.25)}).passes(), 2);
  EXPECT_EQ(Advanced({free_for(0.2499)}).passes(), 3);
  EXPECT_EQ(Advanced({free_for(0.13)}, {.target = 0.25}).passes(), 4);  // 0.13, 0.2431, 0.3415
  EXPECT_NEAR(Advanced({free_for(0.13)}).reached(), 1 - 0.87 * 0.87 * 0.87, 1e-15);
  EXPECT_NEAR(Advanced({free_for(0.5), free_for(0.2)}, {.target = 0.55}).reached(), 0.5 + 0.5 * 0.2, 1e-15);
  EXPECT_EQ(Advanced({free_for(1)}, {.target = 1}).passes(), 2);
  for (const int least : {1, 2, 5}) EXPECT_EQ(Advanced({free_for(1)}, {.least = least}).passes(), least + 1);
}

/// Of a direction that is longer than max_dx_m the part that was cut off is not advanced.
TEST(AccumulatedScripted, WhatWasCutOffADirectionIsNotAdvanced) {
  for (const auto& [dx, alpha] : {std::pair{0.999, 1.0}, {1.001, 1 / 1.001}, {4.0, 0.25}, {5.0, 0.2}}) {
    const Advanced step({{.dx = dx}, free_for(1)});
    EXPECT_DOUBLE_EQ(step.iterations[0].alpha, alpha);
    EXPECT_EQ(step.passes(), alpha >= 0.25 ? 2 : 3);
    if (alpha >= 0.25) {
      EXPECT_NEAR(step.reached(), alpha, 1e-15);
    }
  }
  ScriptedIteration cut{.dx = 2};
  cut.bound = 0.6;
  EXPECT_DOUBLE_EQ(Advanced({cut, free_for(1)}).iterations[0].alpha, 0.5 * 0.6);
}

/// The motion that is tried is the bound's part of the direction, not of 1.25 times it; states that are not feasible
/// are halved.
TEST(AccumulatedScripted, InfeasibleStatesAreHalved) {
  ScriptedIteration one = free_for(0.8);
  one.change = [](double part) -> Change {
    if (part * extension > 0.3) return std::nullopt;
    return EnergyChange{5, 1};  // E is not compared
  };
  const Advanced step({one, free_for(1)}, {.target = 0.1});
  ASSERT_GE(step.system.feasible_asked.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_DOUBLE_EQ(step.system.feasible_asked[i], std::ldexp(0.8, -static_cast<int>(i)) / extension);
  EXPECT_TRUE(step.system.tried.empty());  // no energy is requested
  EXPECT_STREQ(step.iterations[0].energy_change_J.status, no_energies_compared);
  EXPECT_DOUBLE_EQ(step.iterations[0].alpha, 0.2);
  EXPECT_EQ(step.iterations[0].line_search_trials, 3);
}

TEST(AccumulatedScripted, AStepThatCannotMoveEndsWhereItIs) {
  ScriptedIteration stuck = free_for(0);
  const Advanced at_pose({free_for(0.1), stuck});
  EXPECT_EQ(at_pose.report.status, StepStatus::step_collapse);
  EXPECT_EQ(at_pose.system.accepted, 1);
  stuck.at_target = false;
  EXPECT_EQ(Advanced({free_for(0.1), stuck}).report.status, StepStatus::pin_infeasible);
  const Advanced in_the_last_pass({free_for(0.5), free_for(0)});
  EXPECT_EQ(in_the_last_pass.report.status, StepStatus::step_collapse);
  EXPECT_NEAR(in_the_last_pass.reached(), 0.5, 1e-15);
}

TEST(AccumulatedScripted, AStepWithoutIterationsLeftKeepsWhatItReached) {
  const Advanced step({free_for(0.1)}, {.target = 0.9, .most = 2});
  EXPECT_EQ(step.report.status, StepStatus::iteration_cap);
  EXPECT_EQ(step.passes(), 2);
  EXPECT_NEAR(step.reached(), 1 - 0.9 * 0.9, 1e-15);
  EXPECT_EQ(Advanced({free_for(0.1)}, {.target = 0.19, .most = 2}).report.status, StepStatus::converged);
}

/// The matrix of the last pass is looked at, and no other; a saddle is reported and not left.
TEST(AccumulatedScripted, TheEndIsLookedAtInTheLastPassAlone) {
  for (const SaddleRule rule : {SaddleRule::ignore, SaddleRule::report, SaddleRule::escape}) {
    ScriptedIteration saddle = free_for(0.2);
    saddle.end = EndProof::saddle, saddle.curvature = -3;
    const Advanced step({saddle}, {.target = 0.4, .rule = rule});
    ASSERT_EQ(step.passes(), 4);
    const bool looked = rule != SaddleRule::ignore;
    EXPECT_EQ(step.system.checks, looked ? 1 : 0);
    EXPECT_EQ(step.iterations.back().end_checks, looked ? 1 : 0);
    EXPECT_EQ(step.report.end_proof, looked ? EndProof::saddle : EndProof::not_checked);
    EXPECT_EQ(step.report.escapes, 0);
    EXPECT_TRUE(step.system.aimed.empty());
    EXPECT_EQ(step.report.saddle_curvature_N_per_m.finite(), looked);
  }
}

}  // namespace
}  // namespace bb::accumulated_scripted_test
