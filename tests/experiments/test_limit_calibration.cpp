// Matching of the strain limit: what its stiffness carries of the loads that the calibration run met.
#include <algorithm>
#include <cmath>

#include "tests/energy/kappa_of_element.hpp"
#include "tests/experiments/calibrated.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::limit_calibration_test {
namespace {

using namespace test;

/// The limit of the pinned sheet: at its width, and frozen for a step at the wider gap that a slack element
/// had at the step's start, its own stiffness times s carries what the calibration run carried.
TEST(Calibration, ADynamicLimitCarriesTheCalibrationRunsLoads) {
  const std::string text =
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "pinned"},
    "formulation": "cubic_dynamic", "strain_limit": {"shape": "cubic"}, "matching": {"rule": "equal_force"}})";
  double scale[2];
  for (const bool lagged : {false, true}) {
    std::vector<std::string> changes;
    if (lagged) changes = {"/formulation=cubic_dynamic_lagged"};
    const Calibrated c = calibrated(text.c_str(), changes);
    EXPECT_EQ(c.record.limit_load_source, "pilot");
    EXPECT_GT(c.record.elements_considered, 100);
    EXPECT_NE(c.record.limit_element.find("sheet["), std::string::npos) << c.record.limit_element;
    EXPECT_GE(c.record.limit_step.value, 0);
    EXPECT_EQ(c.record.limit_scale.value, c.calibration.limit_scale);
    const Method method = make_method(c.config, c.calibration), unscaled = make_method(c.config, {});
    EXPECT_DOUBLE_EQ(test::kappa_of_element(*method.limit_stiffness),
                     c.calibration.limit_scale * test::kappa_of_element(*unscaled.limit_stiffness));
    scale[lagged] = c.calibration.limit_scale;
    const RunRecord record = run(c.config);
    EXPECT_EQ(record.status.outcome, Outcome::ok) << record.status.detail;
    EXPECT_GT(record.summary.limit_load_max_N_per_m.value, 0);
  }
  EXPECT_GT(scale[1], 1.2 * scale[0]);  // 1.37: at the width alone, frozen or not makes no difference
}

/// kappa_e = w^T M w/(c h^2) by hand for every element that the calibration run stretched into its limit, and the load
/// that it carried there: s makes the neediest one as stiff as the fixed limit matched to its load.
TEST(Calibration, TheScaleOfADynamicLimitIsThatOfItsNeediestElement) {
  const Calibrated c = calibrated(
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "pinned"},
    "formulation": "cubic", "strain_limit": {"shape": "cubic", "stiffness_policy":
      {"name": "elasticity_inclusive", "mass_term": "inertia", "elastic_term": false}},
    "matching": {"rule": "equal_force"}, "time": {"steps": 30}})");
  const std::shared_ptr<const CalibrationRun> calibration_run = run_calibration(c.config, c.scene, {});
  const double h = c.config.time.dt;
  double needed = 0, smallest_area = 1, largest_area = 0;
  long long active = 0, left_out = 0;
  for (std::size_t step = 0; step + 1 < calibration_run->x.size(); ++step) {
    for (std::size_t e = 0; e < c.scene.limit.triangles.size(); ++e) {
      const auto& t = c.scene.limit.triangles[e];
      Eigen::Matrix2d rest, now;
      Eigen::Matrix<double, 2, 3> start;
      for (int k = 0; k < 3; ++k)
        start.col(k) = calibration_run->x[step].col(t[static_cast<std::size_t>(k)]).head<2>();
      for (int k = 0; k < 2; ++k) {
        rest.col(k) =
            (c.scene.rest.col(t[static_cast<std::size_t>(k) + 1]) - c.scene.rest.col(t[0])).head<2>();
        now.col(k) = (calibration_run->x[step + 1].col(t[static_cast<std::size_t>(k) + 1]) -
                      calibration_run->x[step + 1].col(t[0]))
                         .head<2>();
      }
      const double width = c.scene.limit.width[e], area = std::abs(rest.determinant()) / 2;
      const double sigma =
          static_cast<double>(test::singular_values((now * rest.inverse()).cast<long double>())[0]);
      const double y = width - (sigma - 1 - c.scene.limit.onset[e]);
      if (!(y < width)) continue;
      ++active;
      smallest_area = std::min(smallest_area, area), largest_area = std::max(largest_area, area);
      double kappa = 0;
      for (int k = 0; k < 3; ++k) {
        kappa += c.scene.mass[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])] *
                 (start.col(k) - start.rowwise().mean()).squaredNorm() / (h * h);
      }
      if (calibration_run->answers.of_limit(e) > 0.5) {  // no load
        ++left_out;
        continue;
      }
      const double load = *calibration_run->stiffness.k_s * -log_barrier().eval(y, width).db;  // N/m
      needed = std::max(needed, load * area / (kappa * slope("cubic", 0.1 * width, width)));
    }
  }
  EXPECT_GT(active, 100);
  EXPECT_LT(left_out, active / 100);
  EXPECT_EQ(c.record.elements_left_out, left_out);
  EXPECT_EQ(c.record.elements_considered, active - left_out);
  EXPECT_LT(largest_area, 0.5);  // else a forgotten area shows nothing
  EXPECT_NEAR(c.calibration.limit_scale / needed, 1, 1e-6);
}

TEST(Calibration, ALimitThatWasNeverActiveStaysAsGiven) {
  const Calibrated c = calibrated(block, {"/strain_limit/limit=0.5"});
  EXPECT_TRUE(c.calibration.limited);
  EXPECT_EQ(c.calibration.limit_scale, 1);
  EXPECT_FALSE(c.record.limit_scale.finite());
  EXPECT_EQ(c.record.limit_load_source, "static_weight");
  EXPECT_NE(c.record.pilot_note.find("the limit's policy stays as given"), std::string::npos)
      << c.record.pilot_note;
}

/// A soft cloth that hangs from one side has its weight in its limit. One between two sides that are driven apart has the
/// strain that it is given: its force is its stiffness times a fixed b'.
TEST(Calibration, AStretchThatIsGivenIsNoLoadOfTheLimit) {
  const std::string hanging_cloth =
      R"({"name": "hanging", "material": {"youngs_N_per_m": 10}, "transform": {"translate_m": [0, 0, 5]},
      "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "pins": [{"box_m": [[-1, -1, -1], [-0.49, 1, 9]]}]})";
  const std::string stretched = R"({"name": "stretched", "transform": {"translate_m": [9, 0, 5]},
      "mesh": {"generator": "grid", "n_x": 3, "n_y": 2},
      "pins": [{"box_m": [[8, -1, -1], [8.51, 1, 9]]},
               {"box_m": [[9.49, -1, -1], [10, 1, 9]], "motion": {"velocity_m_per_s": [0.2, 0, 0], "start_s": 0, "end_s": 0.2}}]})";
  const auto config = [](const std::string& bodies) {
    return R"({"schema": "barrierbench.config/1", "scene": {"bodies": [)" + bodies +
           R"(]}, "formulation": {"name": "cubic", "d_hat_m": 0.01}, "strain_limit": {"limit": 0.05, "shape": "cubic"},
    "matching": {"rule": "equal_force", "load_N": 1}, "time": {"dt_s": 0.01, "steps": 100}})";
  };
  const Calibrated alone = calibrated(config(hanging_cloth).c_str());
  const Calibrated both = calibrated(config(hanging_cloth + "," + stretched).c_str());
  EXPECT_EQ(alone.record.elements_left_out, 0) << alone.record.left_out_element;
  EXPECT_GT(alone.record.elements_considered, 10);
  EXPECT_NEAR(*both.calibration.k_s / *alone.calibration.k_s, 1, 0.05);
  EXPECT_NE(both.record.limit_element.find("hanging["), std::string::npos) << both.record.limit_element;
  EXPECT_NE(both.record.left_out_element.find("stretched["), std::string::npos)
      << both.record.left_out_element;
  EXPECT_GT(both.record.elements_left_out, 10);
  EXPECT_GT(both.record.left_out_N_per_m.value, 1.2 * both.record.limit_load_N_per_m.value);
  EXPECT_LT(std::abs(both.record.limit_answer.value), 0.5);
  const Calibrated only = calibrated(config(stretched).c_str());
  EXPECT_EQ(only.record.limit_load_source, "static_weight");
  EXPECT_GT(only.record.elements_left_out, 10);
}

TEST(Calibration, TheRecordSaysWhereTheLimitsLoadComesFrom) {
  EXPECT_EQ(calibrated(block).record.limit_load_source, "none");
  EXPECT_EQ(calibrated(hanging).record.limit_load_source, "pilot");
  EXPECT_EQ(calibrated(hanging, {"/matching/limit_load_N_per_m=2"}).record.limit_load_source, "given");
}

TEST(Calibration, ALimitOnNothingNeedsNoStiffness) {
  const RunConfig config =
      parsed(falling, {"/strain_limit/limit=0.1", "/scene/bodies/0/limited=false", "/time/steps=8"});
  const RunRecord record = run(config);
  EXPECT_EQ(record.status.outcome, Outcome::ok) << record.status.detail;
}

}  // namespace
}  // namespace bb::limit_calibration_test
