// Trials that are judged by feasibility alone: no term's energy is evaluated there, and what is reported of the state
// afterwards is what it would be.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/saddle_scenes.hpp"
#include "tests/terms/all_terms.hpp"

namespace bb::feasible_trials_test {
namespace {

/// A term writes energies of trials where evaluate() requests them, and nowhere else: what is not 0 there was requested.
class TrialEnergies final : public StepObserver {
 public:
  void on_matrix(StepSystem& system, int, int) override {
    system_ = &system.on_host();
    terms = static_cast<int>(system_->diagnosis().terms().size());
    look();
  }
  void on_iteration(const IterationReport& report) override {
    look();
    trials += report.line_search_trials;
    contacts += report.contacts.total();
  }
  double written = 0;  // J
  int terms = 0;
  long long trials = 0;
  std::size_t contacts = 0;

 private:
  void look() {
    for (const auto& term : system_->diagnosis().terms()) {
      for (const TermFamily& family : term->families()) {
        for (const double energy : family.trial_energy) written += std::abs(energy);
      }
    }
  }
  NewtonSystem* system_ = nullptr;
};

TrialEnergies step_of(const std::string& solver) {
  const Scene scene = test::driven_sheet({.jitter = 1e-4});
  Method method = test::saddle_method(SaddleRule::ignore);
  choose_step_solver(method, solver);
  Simulation simulation(scene, method, test::sheet_dt, 1);
  TrialEnergies out;
  EXPECT_EQ(simulation.step(out).status, StepStatus::converged);
  return out;
}

TEST(FeasibleTrials, AStepOfAccumulatedToiEvaluatesNoEnergyOfATrial) {
  const TrialEnergies accumulated = step_of("accumulated_toi"), compared = step_of("line_search");
  for (const TrialEnergies* each : {&accumulated, &compared}) {
    EXPECT_GE(each->terms, 3);
    EXPECT_GT(each->trials, 0);
    EXPECT_GT(each->contacts, 0U);
  }
  EXPECT_EQ(accumulated.written, 0);
  EXPECT_GT(compared.written, 0);
}

Method contact_method(const std::string& policy) {
  Method method = test::fixed_method("cubic", 3.5);
  method.limit_stiffness = test::fixed_limit(2);
  if (policy != "fixed") {
    PolicyConfig config;
    config.name = policy;
    method.stiffness = make_policy(config);
  }
  return method;
}

/// Two systems at one iterate, one of which is moved by feasibility alone.
struct Two {
  Scene scene = test::scene_with_everything();
  Method method[2];
  NewtonSystem known, late;

  explicit Two(const std::string& policy = "fixed")
      : method{contact_method(policy), contact_method(policy)},
        known(scene, method[0]),
        late(scene, method[1]) {
    Prediction prediction;
    prediction.x_tilde = scene.x0;
    prediction.x_tilde.row(2).array() -= 0.01;
    for (NewtonSystem* system : {&known, &late}) {
      system->begin_step(scene.x0, prediction, 0.05, 1.0);
      system->assemble();
    }
  }
  void move(double size) {
    const Positions to = test::disturbed(scene, size);
    ASSERT_TRUE(test::try_state(known, to).has_value());
    ASSERT_TRUE(test::is_feasible(late, to));
    known.accept();
    late.accept();
  }
};

TEST(FeasibleTrials, WhatIsSaidOfTheAcceptedStateIsWhatItWouldBe) {
  for (const char* policy : {"fixed", "elasticity_inclusive"}) {
    Two two(policy);
    two.move(0.004);
    StepNumbers known, late;
    two.known.view().report_end(known);
    two.late.view().report_end(late);
    ASSERT_GT(known.contacts.total(), 0U);
    EXPECT_EQ(late.contacts.total(), known.contacts.total());
    EXPECT_GT(known.contact_load_sum_N.value, 0);
    EXPECT_EQ(late.contact_load_sum_N.value, known.contact_load_sum_N.value);
    EXPECT_EQ(late.limit_load_max_N_per_m.value, known.limit_load_max_N_per_m.value);
    for (const TermGroup group :
         {TermGroup::load, TermGroup::elastic, TermGroup::limit, TermGroup::contact}) {
      EXPECT_NE(two.known.view().energy(group), 0);
      EXPECT_EQ(two.late.view().energy(group), two.known.view().energy(group));
    }
  }
}

TEST(FeasibleTrials, TheNextChangeOfEIsMeasuredFromThere) {
  Two two;
  two.move(0.004);
  const Positions to = test::disturbed(two.scene, 0.005);
  const auto known = test::try_state(two.known, to), late = test::try_state(two.late, to);
  ASSERT_TRUE(known && late);
  EXPECT_NE(known->change, 0);
  EXPECT_EQ(late->change, known->change);
  EXPECT_EQ(late->magnitude, known->magnitude);
}

TEST(FeasibleTrials, AStateThatIsNotFiniteIsNotFeasible) {
  Two two;
  Positions to = two.scene.x0;
  to(1, 2) = std::nan("");
  EXPECT_FALSE(test::is_feasible(two.late, to));
  to = two.scene.x0;
  EXPECT_TRUE(test::is_feasible(two.late, to));
}

}  // namespace
}  // namespace bb::feasible_trials_test
