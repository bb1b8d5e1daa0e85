// A step as terms hand it to families of elements: every number is the one of its name.
#include <gtest/gtest.h>

#include "core/energy/families/families.hpp"
#include "core/terms/family_term.hpp"
#include "tests/terms/all_terms.hpp"

namespace bb::step_frame_test {
namespace {

TEST(StepFrame, FamiliesSeeTheStepThatItIs) {
  StepFrame frame;
  frame.x_n = Positions::Constant(3, 2, 1);
  frame.x_tilde = Positions::Constant(3, 2, 2);
  frame.dt = 0.1, frame.c = 0.25, frame.load_factor = 0.5, frame.t_end = 3, frame.at_start = true;
  const FamilyStep step = StepColumns(frame).of_families();
  EXPECT_EQ(step.dt, 0.1);
  EXPECT_EQ(step.c, 0.25);
  EXPECT_EQ(step.load_factor, 0.5);
  EXPECT_EQ(step.t_end, 3);
  EXPECT_TRUE(step.at_start);
  EXPECT_EQ(step.middle(), 3.05);
  EXPECT_EQ(step.x_n[5], 1);
  EXPECT_EQ(step.x_tilde[5], 2);
  frame.at_start = false;
  EXPECT_EQ(StepColumns(frame).of_families().middle(), 2.95);
}

/// Inertia is 0 at the prediction alone, the work of the weight at the start alone.
TEST(StepFrame, InertiaIsOfThePredictionAndTheWeightOfTheStart) {
  const Scene scene = test::scene_with_everything();
  PhaseClock clock;
  StepFrame frame;
  frame.x_n = scene.x0;
  frame.x_tilde = scene.x0.array() + 0.1;
  frame.dt = 0.1, frame.t_end = 0.1;
  exec::HostExecutor executor;
  const auto energies = [&](MadeFamily family, const Positions& x) {
    FamilyTerm term("load", TermGroup::load, std::move(family));
    term.begin_step(frame, clock);
    term.evaluate(x);
    return term.families()[0].trial_energy;
  };
  const std::vector<double> none(scene.mass.size(), 0);
  ASSERT_GT(none.size(), 0U);
  EXPECT_EQ(energies(inertia_family({executor}, scene), frame.x_tilde), none);
  EXPECT_NE(energies(inertia_family({executor}, scene), frame.x_n), none);
  EXPECT_EQ(energies(weight_family({executor}, scene), frame.x_n), none);
  EXPECT_NE(energies(weight_family({executor}, scene), frame.x_tilde), none);
}

}  // namespace
}  // namespace bb::step_frame_test
