// Condition numbers by Spectra and by our Lanczos, against dense algebra and each other, on every diagnosed Newton matrix of a
// demo scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/linear/condition.hpp"
#include "core/step_solvers/simulation.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration.hpp"
#include "tests/linear/scaled_spectrum.hpp"

namespace bb::condition_spectra_test {
namespace {

/// Compares both on the matrix of every second iteration.
class Comparison final : public StepObserver {
 public:
  void on_matrix(StepSystem& step_system, int step, int iteration) override {
    if (iteration % 2 != 0) return;
    NewtonSystem& system = step_system.on_host();
    with_contact += system.diagnosis().active(TermGroup::contact);
    const ReducedSystem& matrix = system.diagnosis().solved();
    for (const Scaling scaling : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
      SCOPED_TRACE(std::string(to_string(scaling)) + ", step " + std::to_string(step) + ", iteration " +
                   std::to_string(iteration));
      const VecXd truth = test::scaled_spectrum(matrix, scaling);
      ASSERT_GT(truth[0], 0);
      const double largest = truth[truth.size() - 1];
      double cond[2] = {};
      for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
        const ConditionEstimate e = estimator_.estimate(matrix, {.estimator = estimator, .scaling = scaling});
        ASSERT_EQ(e.status, ConditionStatus::ok);
        EXPECT_EQ(e.method.substr(0, 7), estimator == Estimator::spectra ? "spectra" : "lanczos");
        EXPECT_EQ(e.proof, ProvenEnds::both);
        EXPECT_LE(e.solves, 25 + (estimator == Estimator::spectra ? default_max_solves : 0));
        EXPECT_LE(e.products, 40 + (estimator == Estimator::spectra ? default_max_products : 0));
        EXPECT_NEAR(e.lambda_max / largest, 1, 1e-3);
        EXPECT_NEAR(e.lambda_min / truth[0], 1, 1e-3);
        EXPECT_NEAR(e.cond / (largest / truth[0]), 1, 1e-3);
        cond[estimator == Estimator::lanczos ? 1 : 0] = e.cond;
        by_spectra_alone += e.method == "spectra";
      }
      largest_difference = std::max(largest_difference, std::abs(cond[0] / cond[1] - 1));
      ++compared;
    }
  }
  int compared = 0, with_contact = 0, by_spectra_alone = 0;
  double largest_difference = 0;

 private:
  ConditionEstimator estimator_;
};

TEST(ConditionSpectra, SpectraAndLanczosAgreeOnEveryDiagnosedMatrixOfTheStrip) {
  const std::vector<std::string> overrides = {"/scene/variant=\"strip\"", "/scene/n=6", "/time/steps=8",
                                              "/formulation=\"cubic\"", "/strain_limit/shape=\"cubic\""};
  const RunConfig config = load_config(configs_folder() + "/scenes/drape2d.json", overrides);
  const Scene scene = build_scene(config);
  MatchingRecord record;
  Method method = make_method(config, calibrate(config, scene, {}, record));
  Simulation simulation(scene, method, config.time.dt, config.time.steps);
  Comparison comparison;
  for (int step = 0; step < config.time.steps; ++step) {
    ASSERT_EQ(simulation.step(comparison).status, StepStatus::converged);
  }
  EXPECT_GE(comparison.compared, 60);
  EXPECT_GE(comparison.with_contact, 10);
  EXPECT_GE(comparison.by_spectra_alone, comparison.compared / 2);
  EXPECT_LE(comparison.largest_difference, 1e-3);
  std::printf("%d matrices and scalings, %d by Spectra alone, largest difference of cond to Lanczos %.1e\n",
              comparison.compared, comparison.by_spectra_alone, comparison.largest_difference);
}

}  // namespace
}  // namespace bb::condition_spectra_test
