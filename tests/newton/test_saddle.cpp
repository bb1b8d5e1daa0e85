// A step ends in a minimum of E or says that it does not: the certificate against the spectrum of the exact matrix.
#include <gtest/gtest.h>

#include "tests/newton/saddle_scenes.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::saddle_test {
namespace {

using namespace test;

/// The smallest eigenvalue of the exact matrix at the last iterate of a step.
class Spectrum final : public StepObserver {
 public:
  void on_matrix(StepSystem& step_system, int, int) override {
    NewtonSystem& system = step_system.on_host();
    const Eigen::MatrixXd full =
        Eigen::MatrixXd(system.diagnosis().exact().lower).selfadjointView<Eigen::Lower>();
    smallest = eigenvalues(full)[0];
    contacts = std::max(contacts, rows_of(system).size());
  }
  void on_iteration(const IterationReport& report) override {
    iterations.push_back(report);
    energy = report.energy_J + report.energy_change_J.value;
  }
  double smallest = 0, energy = 0;
  std::size_t contacts = 0;
  std::vector<IterationReport> iterations;
};

struct Driven {
  Scene scene;
  Method method;
  Simulation simulation;
  Spectrum seen;
  StepReport report;

  Driven(const SheetCase& sheet, Method given)
      : scene(driven_sheet(sheet)),
        method(std::move(given)),
        simulation(scene, method, sheet_dt, 1),
        report(simulation.step(seen)) {}
  double height() const { return simulation.history().x.row(2).cwiseAbs().maxCoeff(); }
};

TEST(Saddle, a_flat_sheet_that_is_driven_together_leaves_its_plane) {
  const Driven driven({}, saddle_method(SaddleRule::escape));
  ASSERT_EQ(driven.report.status, StepStatus::converged) << driven.report.detail;
  ASSERT_GT(driven.seen.contacts, 0U);
  EXPECT_EQ(driven.report.end_proof, EndProof::factor);
  EXPECT_GT(driven.seen.smallest, 0);
  EXPECT_GT(driven.height(), 1e-3);
  EXPECT_GE(driven.report.escapes, 1);
  EXPECT_LT(driven.report.saddle_curvature_N_per_m.value, 0);
  EXPECT_LT(driven.report.end_error_tolerances.value, 1);
  const Driven flat({}, saddle_method(SaddleRule::ignore));
  EXPECT_LT(driven.seen.energy, flat.seen.energy);
}

TEST(Saddle, that_is_only_reported_is_where_the_step_ends) {
  const Driven told({}, saddle_method(SaddleRule::report)), silent({}, saddle_method(SaddleRule::ignore));
  ASSERT_EQ(told.report.status, StepStatus::converged);
  ASSERT_EQ(silent.report.status, StepStatus::converged);
  EXPECT_EQ(told.report.end_proof, EndProof::saddle);
  EXPECT_EQ(silent.report.end_proof, EndProof::not_checked);
  EXPECT_EQ(silent.report.end_checks, 0);
  EXPECT_EQ(told.report.escapes, 0);
  EXPECT_EQ(told.height(), 0);
  EXPECT_EQ(told.simulation.history().x, silent.simulation.history().x);  // to look changes nothing
  ASSERT_LT(told.seen.smallest, 0);
  EXPECT_FALSE(silent.report.saddle_curvature_N_per_m.finite());
  EXPECT_GE(told.report.saddle_curvature_N_per_m.value, told.seen.smallest * (1 + 1e-9));
  EXPECT_LE(told.report.saddle_curvature_N_per_m.value, 0.5 * told.seen.smallest);  // and close to it
}

TEST(Saddle, a_sheet_that_is_driven_apart_is_proven_by_the_factor_that_is_there) {
  SheetCase apart;
  apart.speed = -0.2;
  const Driven driven(apart, saddle_method(SaddleRule::escape));
  ASSERT_EQ(driven.report.status, StepStatus::converged);
  ASSERT_GT(driven.seen.contacts, 0U);
  EXPECT_GT(driven.seen.smallest, 0);
  EXPECT_EQ(driven.report.end_proof, EndProof::factor);
  EXPECT_EQ(driven.report.escapes, 0);
  EXPECT_GE(driven.report.end_checks, 1);
  EXPECT_EQ(driven.report.end_check_factorizations, 0);
  EXPECT_EQ(driven.report.end_check_iterations, 0);
}

/// With a contact that is stiff enough the same flat sheet is a minimum.
TEST(Saddle, planes_that_hold_the_sheet_make_it_a_minimum) {
  const Driven driven({}, saddle_method(SaddleRule::report, StepHessian::blend, 1000));
  ASSERT_EQ(driven.report.status, StepStatus::converged);
  EXPECT_GT(driven.seen.smallest, 0);
  EXPECT_EQ(driven.report.end_proof, EndProof::factor);
}

TEST(Saddle, is_not_looked_for_where_no_exact_matrix_is_known) {
  const Driven clamped({}, saddle_method(SaddleRule::escape, StepHessian::clamped));
  ASSERT_EQ(clamped.report.status, StepStatus::converged);
  EXPECT_EQ(clamped.report.end_proof, EndProof::clamped);
  EXPECT_EQ(clamped.report.end_check_factorizations, 0);
  EXPECT_EQ(clamped.height(), 0);
  // exact membranes show the saddle although contact is clamped; without it a minimum is not proven
  Method some = saddle_method(SaddleRule::escape);
  some.step_hessian["contact"] = StepHessian::clamped;
  const Driven partly({}, std::move(some));
  EXPECT_GT(partly.height(), 1e-3);
  EXPECT_EQ(partly.report.end_proof, EndProof::clamped);
  Method gauss = saddle_method(SaddleRule::escape);
  gauss.hessian_mode = HessianMode::gauss_newton;
  EXPECT_EQ(Driven({}, std::move(gauss)).report.end_proof, EndProof::clamped);
}

/// Thick sheets over a floor, some flat and some not, driven both ways: the word of the record is that of the
/// spectrum.
TEST(Saddle, the_word_is_that_of_the_spectrum_in_random_scenes) {
  int saddles = 0, minima = 0;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    SheetCase sheet;
    sheet.seed = seed;
    sheet.speed = 0.3 * (unit(random) - 0.2);
    sheet.thickness = 0.004 * unit(random);
    sheet.gap = 0.002 + 0.006 * unit(random);
    sheet.jitter = seed % 2 == 0 ? 0 : 1e-4 * unit(random);
    sheet.only_floor = seed % 3 == 0;
    for (const SaddleRule rule : {SaddleRule::report, SaddleRule::escape}) {
      const Driven driven(sheet, saddle_method(rule, StepHessian::blend, seed % 4 == 1 ? 20 : 0.02));
      ASSERT_EQ(driven.report.status, StepStatus::converged) << seed << driven.report.detail;
      EXPECT_GT(driven.seen.contacts, 0U) << seed;
      const bool minimum = driven.seen.smallest > 0;
      EXPECT_EQ(driven.report.end_proof, minimum ? EndProof::factor : EndProof::saddle)
          << seed << " " << driven.seen.smallest;
      EXPECT_TRUE(minimum || rule == SaddleRule::report) << seed;
      ++(minimum ? minima : saddles);
    }
  }
  EXPECT_GE(saddles, 3);
  EXPECT_GE(minima, 6);
}

class SaddleOfSolver : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, SaddleOfSolver, testing::Values("pcg", "lagged_cholesky"),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(SaddleOfSolver, sees_it_without_a_factor_of_the_matrix) {
  for (const SaddleRule rule : {SaddleRule::report, SaddleRule::escape}) {
    for (const double speed : {0.2, -0.2}) {
      SheetCase sheet;
      sheet.speed = speed;
      Method method = saddle_method(rule);
      method.linear.name = GetParam();
      const Driven driven(sheet, std::move(method));
      ASSERT_EQ(driven.report.status, StepStatus::converged) << driven.report.detail;
      const bool minimum = driven.seen.smallest > 0;
      EXPECT_EQ(minimum, speed < 0 || rule == SaddleRule::escape);
      const bool said =
          driven.report.end_proof == EndProof::factor || driven.report.end_proof == EndProof::lanczos;
      EXPECT_EQ(said, minimum) << to_string(driven.report.end_proof);
      EXPECT_GT(driven.report.end_check_factorizations + driven.report.end_check_iterations, 0);
    }
  }
}

/// An escape keeps to the bound of contact: planes so close that a move of d_hat would go through them.
TEST(Saddle, is_left_without_touching) {
  SheetCase close;
  close.gap = 1e-4;
  close.thickness = 0;
  Method method = saddle_method(SaddleRule::escape, StepHessian::blend, 1e-4);
  const Driven driven(close, std::move(method));
  ASSERT_EQ(driven.report.status, StepStatus::converged) << driven.report.detail;
  EXPECT_GE(driven.report.escapes, 1);
  EXPECT_GT(driven.height(), 1e-6);
  EXPECT_LT(driven.height(), close.gap);
  EXPECT_GT(driven.report.gap_min_iterates_m.value, 0);
}

/// Thin sheets so close that a move of d_hat would come out behind them, where E is lower.
TEST(Saddle, is_left_without_passing_through) {
  SheetCase close;
  close.gap = 2e-4;
  close.thickness = 0;
  close.plates = true;
  const Driven driven(close, saddle_method(SaddleRule::escape, StepHessian::blend, 1e-4));
  ASSERT_EQ(driven.report.status, StepStatus::converged) << driven.report.detail;
  ASSERT_GT(driven.seen.contacts, 0U);
  EXPECT_GE(driven.report.escapes, 1);
  const auto sheet = driven.simulation.history().x.leftCols(driven.scene.bodies[0].n_vertices);
  EXPECT_GT(sheet.row(2).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(sheet.row(2).cwiseAbs().maxCoeff(), close.gap);
}

/// Barriers of all strengths about the one at which the flat sheet becomes a minimum: every escape goes down.
TEST(Saddle, every_escape_lowers_the_energy) {
  int escapes = 0;
  for (const double kappa : {1e-3, 1e-2, 0.03, 0.1, 0.3, 1.0}) {
    for (const double gap : {3e-4, 0.002, 0.006}) {
      SheetCase sheet;
      sheet.gap = gap;
      const Driven driven(sheet, saddle_method(SaddleRule::escape, StepHessian::blend, kappa));
      ASSERT_EQ(driven.report.status, StepStatus::converged) << kappa << " " << gap;
      EXPECT_EQ(driven.report.end_proof, EndProof::factor) << kappa << " " << gap;
      for (const IterationReport& iteration : driven.seen.iterations) {
        if (iteration.escapes == 0) continue;
        ++escapes;
        EXPECT_LT(iteration.energy_change_J.value, 0) << kappa << " " << gap;
        EXPECT_GT(iteration.alpha, 0);
      }
    }
  }
  EXPECT_GE(escapes, 5);
}

/// Where the gradient has a part along it, the direction goes down, is as long as requested and moves no
/// prescribed vertex.
TEST(Saddle, the_way_out_does_not_climb) {
  int steep = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Scene scene = driven_sheet({.jitter = 1e-3, .seed = seed});
    Method method = saddle_method(SaddleRule::report);
    NewtonSystem system(scene, method);
    Prediction prediction;
    prediction.x_tilde = scene.x0;
    system.begin_step(scene.x0, prediction, sheet_dt, 1);
    Positions pressed = scene.x0;
    pressed.row(0) *= 0.97;
    const Positions motion = pressed - scene.x0;
    system.assemble();
    ASSERT_TRUE(test::try_state(system, pressed).has_value());
    system.accept();
    system.assemble();
    system.set_target(system.view().x());
    ASSERT_EQ(system.find_direction().linear.status, LinearStatus::ok);
    const Positions newton = system.diagnosis().direction();
    const EndCheck end = system.check_end();
    ASSERT_EQ(end.proof, EndProof::saddle);
    EXPECT_EQ(system.diagnosis().direction(), newton);  // to look moves nothing
    system.aim_at_escape(1e-3);
    const DirectionSize size = system.direction_size();
    EXPECT_NEAR(size.inf_m, 1e-3, 1e-12);
    EXPECT_LE(size.slope_J, 0) << seed;
    EXPECT_LT(system.direction_curvature(), 0);
    EXPECT_NEAR(system.direction_curvature(),
                end.curvature_N_per_m * system.diagnosis().direction().squaredNorm(), 1e-9);
    for (const Pin& pin : scene.pins) EXPECT_TRUE(system.diagnosis().direction().col(pin.vertex).isZero(0));
    steep += size.slope_J < -1e-9 ? 1 : 0;
  }
  EXPECT_GE(steep, 4);
}

TEST(Saddle, has_the_same_bits_in_every_run) {
  const Driven one({}, saddle_method(SaddleRule::escape)), two({}, saddle_method(SaddleRule::escape));
  EXPECT_EQ(one.simulation.history().x, two.simulation.history().x);
}

TEST(Saddle, time_of_checks_has_a_phase_of_its_own) {
  const Driven driven({}, saddle_method(SaddleRule::escape));
  EXPECT_GT(driven.report.time[Phase::end_check], 0);
  EXPECT_EQ(Driven({}, saddle_method(SaddleRule::ignore)).report.time[Phase::end_check], 0);
}

}  // namespace
}  // namespace bb::saddle_test
