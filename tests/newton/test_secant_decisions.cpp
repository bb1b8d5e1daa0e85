// When the matrix has the secant of a term, and how much of it: what is required of that, with a number on either side.
#include <gtest/gtest.h>

#include "tests/newton/scripted_system.hpp"

namespace bb::secant_decisions_test {
namespace {

using test::Change;
using test::ScriptedIteration;
using test::ScriptedStep;

ScriptedIteration whole() { return {.dx = 1, .slope = -1}; }
/// E rises along dx, and falls along its half.
ScriptedIteration shortened() {
  ScriptedIteration out = whole();
  out.change = [](double alpha) -> Change { return EnergyChange{alpha > 0.5 ? 1 : -alpha, 1e-3}; };
  return out;
}

ScriptedStep taken(const std::vector<ScriptedIteration>& script, int n, bool has_secant = true) {
  return ScriptedStep(script, SaddleRule::escape, 0.1, n, {.has_secant = has_secant});
}
/// Share of the secant in each of n iterations.
std::vector<double> shares(const std::vector<ScriptedIteration>& script, int n, bool has_secant = true) {
  return taken(script, n, has_secant).system.secants;
}
using Shares = std::vector<double>;

TEST(SecantDecisions, AStepThatWasShortenedAsksForAllOfItAndWholeOnesForEverLess) {
  EXPECT_EQ(shares({whole()}, 3), (Shares{0, 0, 0}));
  EXPECT_EQ(shares({whole(), shortened(), whole()}, 7), (Shares{0, 0, 1, 0.25, 0.0625, 0, 0}));
  EXPECT_EQ(shares({shortened(), whole(), shortened(), whole()}, 5), (Shares{0, 1, 0.25, 1, 0.25}));
}

/// E rises along all of dx.
ScriptedIteration rising() {
  ScriptedIteration out = whole();
  out.change = [](double) -> Change { return EnergyChange{1, 1e-3}; };
  return out;
}

TEST(SecantDecisions, AStepAlongWhichERisesIsAskedForItBeforeItFails) {
  const ScriptedStep turned = taken({rising(), whole()}, 4);
  EXPECT_EQ(turned.system.secants, (Shares{0, 1, 0.25, 0.0625}));
  EXPECT_EQ(turned.report.status, StepStatus::iteration_cap);
  const ScriptedStep from_a_share = taken({shortened(), whole(), rising(), whole()}, 5);
  EXPECT_EQ(from_a_share.system.secants, (Shares{0, 1, 0.25, 1, 0.25}));
  const ScriptedStep twice = taken({whole(), rising()}, 5), without = taken({whole(), rising()}, 5, false);
  EXPECT_EQ(twice.system.secants, (Shares{0, 0, 1}));
  EXPECT_EQ(twice.report.status, StepStatus::line_search_failed);
  EXPECT_EQ(without.system.secants, (Shares{0, 0}));
  EXPECT_EQ(without.report.status, StepStatus::line_search_failed);
}

TEST(SecantDecisions, OfTheLastIterationAndOfAStepThatContactHoldsItIsNotAsked) {
  const ScriptedStep last = taken({whole(), rising()}, 2);
  EXPECT_EQ(last.system.secants, (Shares{0, 0}));
  EXPECT_EQ(last.report.status, StepStatus::line_search_failed);
  ScriptedIteration held = rising();
  held.bound = 1e-9;
  EXPECT_EQ(shares({held}, 4), (Shares{0, 0, 0, 0}));
  ScriptedIteration short_of_its_pose = whole();
  short_of_its_pose.at_target = false;
  short_of_its_pose.change = [](double) -> Change { return std::nullopt; };
  const ScriptedStep infeasible = taken({short_of_its_pose}, 4);
  EXPECT_EQ(infeasible.system.secants, (Shares{0}));
  EXPECT_EQ(infeasible.report.status, StepStatus::line_search_failed);
}

TEST(SecantDecisions, IterationsWithAShareOfItAreCounted) {
  EXPECT_EQ(taken({whole(), shortened(), whole()}, 7).report.solver.values.at("secants"), 3);
  EXPECT_EQ(taken({whole()}, 3).report.solver.values.at("secants"), 0);
}

TEST(SecantDecisions, WithoutATermThatHasOneNothingIsAskedAgain) {
  EXPECT_EQ(taken({shortened(), whole()}, 4, false).report.solver.values.at("secants"), 0);
}

TEST(SecantDecisions, AStepThatABoundOrNoiseCutWasNotShortened) {
  ScriptedIteration held = whole();
  held.bound = 0.5;
  EXPECT_EQ(shares({held}, 3), (Shares{0, 0, 0}));
  ScriptedIteration noisy = whole();
  noisy.change = [](double alpha) -> Change {
    return alpha > 0.5 ? Change() : Change(EnergyChange{1e-20, 1});
  };
  EXPECT_EQ(shares({noisy, whole()}, 2), (Shares{0, 0}));
}

/// A particle that slides on a floor under its weight, ahead of where it began.
struct Sliding {
  Method method;
  Scene scene = test::particle_over_plane(1, 0.5 * d_hat, d_hat);
  NewtonSystem system;

  /// c: of the inertia, 0 without.
  explicit Sliding(double c = 1, const char* solver = "cholmod")
      : method(rubbing(solver)), system(scene, method) {
    system.begin_step(scene.x0, {c, Positions(scene.x0 + test::one_point(5e-3, 0, -1e-4))}, 0.01, 1);
    system.go_to(scene.x0 + test::one_point(4e-3, 0, -1e-4));
    system.set_target(scene.x0);
  }
  /// Along the slide at the iterate, N/m, of the matrix that is solved.
  double stiffness() {
    system.assemble();
    system.set_direction(test::one_point(1, 0, 0));
    return system.diagnosis().solved().lower.coeff(0, 0);
  }

  static constexpr double d_hat = 0.01;
  static Method rubbing(const char* solver = "cholmod") {
    Method out = test::fixed_method("cubic", 1e5);
    out.friction.mu = 0.5;
    out.linear.name = solver;
    out.hessian_mode = HessianMode::projected_full;
    for (const HessianChoice& term : hessian_choices()) out.step_hessian[term.name] = StepHessian::blend;
    return out;
  }
};

/// Without inertia nothing but the secant holds a particle that slides: the matrix that is solved with it is positive definite,
/// that of E is not, and the end has to be one of E.
TEST(SecantDecisions, TheProofOfTheEndIsOfTheExactMatrix) {
  for (const char* solver : {"cholmod", "pcg"}) {
    SCOPED_TRACE(solver);
    Sliding sliding(0, solver);
    NewtonSystem& system = sliding.system;
    ASSERT_TRUE(system.take_secant(1));
    const double whole = sliding.stiffness();
    ASSERT_GT(whole, 1);
    EXPECT_FALSE(system.diagnosis().solved_is_exact());
    EXPECT_EQ(system.find_direction().linear.status, LinearStatus::ok);
    const EndCheck end = system.check_end();
    EXPECT_NE(end.proof, EndProof::factor);
    EXPECT_NE(end.proof, EndProof::lanczos);
    EXPECT_EQ(system.diagnosis().exact().lower.coeff(0, 0), 0) << "that of E is what is left";
  }
}

/// A matrix that is written as exact is that of E, whatever was solved.
TEST(SecantDecisions, TheExactMatrixOfADiagnosisIsThatOfE) {
  Sliding sliding;
  NewtonSystem& system = sliding.system;
  const double exact = sliding.stiffness();
  EXPECT_TRUE(system.diagnosis().solved_is_exact());
  ASSERT_TRUE(system.take_secant(1));
  EXPECT_GT(sliding.stiffness(), 1.01 * exact);
  EXPECT_FALSE(system.diagnosis().solved_is_exact());
  EXPECT_EQ(system.diagnosis().exact().lower.coeff(0, 0), exact);
}

TEST(SecantDecisions, TheWholeOfItIsTheForceOverTheSlide) {
  Sliding sliding;
  NewtonSystem& system = sliding.system;
  const double slide = system.view().x()(0, 0) - sliding.scene.x0(0, 0);
  ASSERT_GT(slide, 100 * sliding.method.friction.eps_v * 0.01)
      << "beyond the slide from which the force is whole";
  const double exact = sliding.stiffness();
  const Positions with_exact = system.view().gradient();
  ASSERT_TRUE(system.take_secant(1));
  const double whole = sliding.stiffness();
  EXPECT_EQ(system.view().gradient(), with_exact) << "forces are those of E";
  ASSERT_TRUE(system.take_secant(0.25));
  EXPECT_NEAR(sliding.stiffness() - exact, (whole - exact) / 4, 1e-9 * whole);
  system.take_secant(0);
  EXPECT_EQ(sliding.stiffness(), exact);
  // inertia apart, the gradient along the slide is the force of friction
  const double inertia =
      system.view().energy(TermGroup::load) > 0 ? (system.view().x()(0, 0) - 5e-3) / 1e-4 : 0;
  const double force = with_exact(0, 0) - inertia;
  ASSERT_GT(force, 0.1);
  EXPECT_NEAR(whole - exact, force / slide, 1e-6 * force / slide);
}

/// exact: no term has a secant.
TEST(SecantDecisions, FrictionThatIsToBeExactHasNone) {
  Scene scene = test::particle_over_plane(1, 0.005, 0.01);
  Method method = Sliding::rubbing();
  method.friction.hessian = FrictionHessian::exact;
  NewtonSystem system(scene, method);
  system.begin_step(scene.x0, {1, scene.x0}, 0.01, 1);
  EXPECT_FALSE(system.take_secant(1));
}

}  // namespace
}  // namespace bb::secant_decisions_test
