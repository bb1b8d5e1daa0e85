// A replay of a calibration run finds the rest shapes that creep as they were in each step.
#include "experiments/run/calibration_replay.hpp"

#include "core/newton/energy_sum.hpp"
#include "core/step_solvers/simulation.hpp"
#include "tests/experiments/calibrated.hpp"

namespace bb::calibration_replay_test {
namespace {

using namespace test;

/// A sheet that hangs from one side over a floor, and whose hinges creep.
const char* const creeping = R"({"schema": "barrierbench.config/1",
  "scene": {"bodies": [{"name": "sheet", "transform": {"translate_m": [0, 0, 0.05]},
      "mesh": {"generator": "grid", "n_x": 4, "n_y": 3, "size_x_m": 0.4, "size_y_m": 0.3},
      "material": {"bending_J": 1e-3, "bending_yield_rad": 1e-3, "bending_creep_per_s": 20},
      "pins": [{"indices": [0, 4, 8]}]}],
    "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
  "formulation": {"name": "cubic", "d_hat_m": 0.005}, "matching": {"rule": "equal_force"},
  "time": {"dt_s": 0.01, "steps": 8}})";

/// What the bent sheet stores at the end of each step, J.
class Watch final : public StepObserver {
 public:
  void on_step(StepSystem& system, const StepReport&, const Positions&) override {
    elastic.push_back(system.view().energy(TermGroup::elastic));
  }
  std::vector<double> elastic;
};

TEST(CalibrationReplay, HasTheRestShapesOfEveryStep) {
  const RunConfig config = parsed(creeping, {});
  const Scene scene = build_scene(config);
  const std::shared_ptr<const CalibrationRun> calibration_run = run_calibration(config, scene, {});
  ASSERT_EQ(calibration_run->steps(), 8) << calibration_run->stopped;

  Method method = make_method(calibration_run->config, calibration_run->stiffness);
  Method never_stepped = make_method(calibration_run->config, calibration_run->stiffness);
  Simulation simulation(scene, method, config.time.dt, 8);
  Watch watch;
  for (int step = 0; step < 8; ++step) simulation.step(watch);

  CalibrationReplay replay(*calibration_run, scene);
  NewtonSystem fresh(scene, never_stepped);
  for (const int step : {7, 2, 5}) {
    const double expected = watch.elastic[static_cast<std::size_t>(step)];
    ASSERT_GT(expected, 1e-6);
    EXPECT_NEAR(total_energy(replay.assembled(step).terms(), TermGroup::elastic), expected, 1e-10 * expected);
    Prediction there;
    there.x_tilde = replay.end(step);
    fresh.begin_step(replay.end(step), there, config.time.dt, 1);
    fresh.assemble();
    EXPECT_GT(std::abs(fresh.view().energy(TermGroup::elastic) - expected), 1e-3 * expected) << "it crept";
  }
}

}  // namespace
}  // namespace bb::calibration_replay_test
