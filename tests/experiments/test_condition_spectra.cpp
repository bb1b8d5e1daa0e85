// Tier 2 of the condition numbers against Spectra, on every diagnosed Newton matrix of a demo scene.
#include <Spectra/SymEigsShiftSolver.h>
#include <Spectra/SymEigsSolver.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/linear/block_scaling.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/condition.hpp"
#include "core/linear/symmetric_product.hpp"
#include "core/newton/simulation.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration.hpp"

namespace bb {
namespace {

constexpr double tight = 1e-9;  // Spectra's relative tolerance
constexpr int restarts = 2000;

/// x -> L^-1 A L^-T x, for Spectra's largest eigenvalue.
struct ScaledProduct {
  using Scalar = double;
  const SymmetricProduct& product;
  const BlockScaling& scaling;
  Eigen::Index rows() const { return product.n(); }
  Eigen::Index cols() const { return product.n(); }
  void perform_op(const double* x, double* y) const {
    VecXd in = Eigen::Map<const VecXd>(x, rows()), out;
    scaling.solve_upper(in);
    product.multiply(in, out);
    scaling.solve_lower(out);
    Eigen::Map<VecXd>(y, rows()) = out;
  }
};

/// x -> L^T A^-1 L x, for Spectra's shift-invert mode at shift 0.
struct ScaledSolve {
  using Scalar = double;
  CholmodFactor& factor;
  const BlockScaling& scaling;
  Eigen::Index n;
  Eigen::Index rows() const { return n; }
  Eigen::Index cols() const { return n; }
  void set_shift(double) {}
  void perform_op(const double* x, double* y) const {
    VecXd in = Eigen::Map<const VecXd>(x, n), out;
    scaling.multiply_lower(in);
    factor.solve(in, out);
    scaling.multiply_upper(out);
    Eigen::Map<VecXd>(y, n) = out;
  }
};

struct Ends {
  double lambda_min = 0, lambda_max = 0;
};

template <class Solver>
double one_eigenvalue(Solver& solver, Spectra::SortRule rule) {
  solver.init();  // Spectra's own start vector, which is seeded
  const auto found = solver.compute(rule, restarts, tight, Spectra::SortRule::LargestAlge);
  EXPECT_EQ(found, 1);
  return found == 1 ? solver.eigenvalues()[0] : 0;
}

Ends ends_by_spectra(const ReducedSystem& system, Scaling scaling) {
  SymmetricProduct product;
  product.update(system);
  CholmodFactor factor;
  BlockScaling scale;
  EXPECT_EQ(factor.factorize(system), LinearStatus::ok);
  EXPECT_EQ(scale.setup(system, scaling), LinearStatus::ok);
  const int n = product.n();
  ScaledProduct multiply{product, scale};
  ScaledSolve solve{factor, scale, n};
  Spectra::SymEigsSolver<ScaledProduct> largest(multiply, 1, std::min(n, 40));
  Spectra::SymEigsShiftSolver<ScaledSolve> smallest(solve, 1, std::min(n, 30), 0.0);
  return {one_eigenvalue(smallest, Spectra::SortRule::LargestMagn),
          one_eigenvalue(largest, Spectra::SortRule::LargestAlge)};
}

/// Compares both on the matrix of every second iteration.
class Comparison final : public StepObserver {
 public:
  void on_matrix(StepSystem& step_system, int step, int iteration) override {
    if (iteration % 2 != 0) return;
    NewtonSystem& system = step_system.on_cpu();
    with_contact += system.active(TermGroup::contact);
    const ReducedSystem& matrix = system.solved();
    for (const Scaling scaling : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
      SCOPED_TRACE(std::string(to_string(scaling)) + ", step " + std::to_string(step) + ", iteration " +
                   std::to_string(iteration));
      const ConditionEstimate ours = estimator_.estimate(matrix, {2, scaling, 1});
      ASSERT_EQ(ours.status, ConditionStatus::ok);
      EXPECT_LE(ours.solves, 25);
      EXPECT_LE(ours.products, 40);
      const Ends spectra = ends_by_spectra(matrix, scaling);
      ASSERT_GT(spectra.lambda_min, 0);
      EXPECT_NEAR(ours.lambda_max / spectra.lambda_max, 1, 1e-3);
      EXPECT_NEAR(ours.lambda_min / spectra.lambda_min, 1, 1e-3);
      EXPECT_NEAR(ours.cond / (spectra.lambda_max / spectra.lambda_min), 1, 1e-3);
      ++compared;
    }
  }
  int compared = 0, with_contact = 0;

 private:
  ConditionEstimator estimator_;
};

TEST(ConditionSpectra, Tier2AgreesOnEveryDiagnosedMatrixOfTheStrip) {
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
}

}  // namespace
}  // namespace bb
