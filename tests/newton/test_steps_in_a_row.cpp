// Two steps in a row on one object: the second is, bit for bit, the first of a fresh object that read the archive of the state
// between them. What a step leaves behind in the object and has to forget, and what an archive lacks, are both seen. Every step
// solver with every integrator on every feature that it takes.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "core/base/archive/archive.hpp"
#include "core/base/record/run_record.hpp"
#include "core/base/record/writer.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/feature_scenes.hpp"

namespace bb::steps_in_a_row_test {
namespace {

using test::Feature, test::FeatureScene;

constexpr double dt = 0.01;
constexpr int n_steps = 5;

/// Everything that a step says, but for times.
class Said final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override {
    TraceRow row = report;
    row.time = {};
    text += to_json(row) + '\n';
    contacts = std::max(contacts, report.contacts.total());
  }
  void on_step(StepSystem&, const StepReport& report, const Positions&) override {
    RunRecord record;
    record.steps = {report};
    record.steps[0].time = {};
    text += to_json(record);
    contacts = std::max(contacts, report.contacts.total());
  }
  std::string text;
  std::size_t contacts = 0;
};

struct Choice {
  std::string solver, integrator, policy = "fixed", linear = "cholmod";
  double friction = 0;
  Precision precision = Precision::full;
  HessianMode hessian = HessianMode::gauss_newton;
};

std::unique_ptr<StiffnessPolicy> policy_of(const std::string& name) {
  PolicyConfig config;
  config.name = name.substr(0, name.find(' '));
  if (name == "fixed") config.parameters["kappa_N_per_m"] = 300.0;
  if (name == "elasticity_inclusive per_step") config.parameters.emplace("refresh", "per_step");
  return make_policy(config);
}

Method method_of(const Choice& of) {
  const StepSolverEntry& entry = step_solvers().require(of.solver, "test");
  Method method = test::fixed_method("cubic", 300, of.integrator);
  method.stiffness = policy_of(of.policy);
  method.limit_stiffness = test::elastic_limit({.refresh = Refresh::per_step});
  method.friction.mu = of.friction;
  method.friction.lag_iterations = entry.needs.minimum ? 2 : 1;
  choose_step_solver(method, of.solver);
  method.step_solver.max_iterations = 40;
  method.step_solver.tol_velocity = 1e-4;
  method.step_solver.saddle = entry.needs.minimum ? SaddleRule::escape : SaddleRule::ignore;
  method.linear.name = of.linear;
  method.precision = of.precision;
  method.contact.in_float = method.limit.in_float = values_in_float(of.precision);
  method.hessian_mode = of.hessian;
  fit_terms(method);
  // so that some step adapts, and some gap is small enough for multipliers
  if (method.linear_contact) method.linear_contact->stall_updates = 2;
  if (method.barrier_multipliers)
    method.barrier_multipliers->near = 0.5, method.barrier_multipliers->release = 0.9;
  return method;
}

/// A simulation with the method that it reads.
struct Runner {
  Method method;
  Simulation simulation;
  Runner(const Scene& scene, const Choice& choice)
      : method(method_of(choice)), simulation(scene, method, dt, n_steps) {}
};

struct Seen {
  std::size_t contacts = 0, steps = 0;
};

std::string archived(Simulation& simulation) {
  Archive archive;
  simulation.keep(archive);
  return archive.bytes();
}

/// Steps on one object, each beside that of a fresh one.
Seen compare(const Scene& scene, const Choice& choice, const std::string& where) {
  Runner run(scene, choice);
  Seen seen;
  for (int step = 0; step < n_steps; ++step) {
    const std::string before = archived(run.simulation);
    Runner fresh(scene, choice);
    Archive read(before);
    fresh.simulation.keep(read);
    EXPECT_TRUE(read.at_end()) << where;
    Said said, said_afresh;
    run.simulation.step(said);
    fresh.simulation.step(said_afresh);
    EXPECT_EQ(said.text, said_afresh.text) << where << ", step " << step;
    EXPECT_TRUE(archived(run.simulation) == archived(fresh.simulation)) << where << ", step " << step;
    seen.contacts = std::max(seen.contacts, said.contacts);
    ++seen.steps;
    if (::testing::Test::HasFailure() || !run.simulation.history().x.allFinite()) break;
  }
  return seen;
}

/// The scene with these features; nothing where the step solver refuses one of them.
std::optional<Seen> compared(const std::vector<const Feature*>& with, const Choice& asked,
                             std::set<std::string>& terms) {
  FeatureScene parts = test::falling_sheets();
  std::string where = asked.solver + ", " + asked.integrator + ", " + asked.policy + ":";
  for (const Feature* feature : with) feature->add(parts), where += " " + feature->name + ",";
  const Scene scene = parts.scene();
  Choice choice = asked;
  choice.friction = parts.friction;
  try {
    Method method = method_of(choice);
    const Simulation refuses(scene, method, dt, n_steps);
  } catch (const ConfigError&) {
    if (choice.policy == "fixed") return std::nullopt;
    choice.policy = "fixed";
    return compared(with, choice, terms);
  }
  Method method = method_of(choice);
  const Plan plan = make_plan(scene, method, plan_options(method));
  for (const TermEntry& entry : term_entries())
    if (plan.term(entry.name).needed) terms.emplace(entry.name);
  return compare(scene, choice, where);
}

const std::vector<std::string> policies = {"fixed", "ipc_adaptive", "elasticity_inclusive",
                                           "elasticity_inclusive per_step", "dart"};

TEST(StepsInARow, AreEachTheFirstOfAFreshObject) {
  std::set<std::string> terms;
  std::map<std::string, std::size_t> contacts, features;
  std::size_t cells = 0;
  const auto count = [&](const std::string& solver, const std::vector<const Feature*>& with,
                         const std::optional<Seen>& seen) {
    if (!seen) return false;
    contacts[solver] = std::max(contacts[solver], seen->contacts);
    for (const Feature* feature : with) ++features[feature->name];
    ++cells;
    return true;
  };
  for (const StepSolverEntry& solver : step_solvers()) {
    for (const IntegratorEntry& integrator : integrators()) {
      if (solver.settings.implicit_euler && integrator.name != "implicit_euler") continue;
      const Choice choice{solver.name, integrator.name, policies[cells % policies.size()]};
      std::vector<const Feature*> all;
      for (const Feature& feature : test::features()) all.push_back(&feature);
      if (count(solver.name, all, compared(all, choice, terms))) continue;
      std::vector<const Feature*> taken;
      for (const Feature& feature : test::features()) {
        if (count(solver.name, {&feature}, compared({&feature}, choice, terms))) taken.push_back(&feature);
      }
      EXPECT_TRUE(count(solver.name, taken, compared(taken, choice, terms))) << solver.name;
      if (HasFailure()) return;
    }
    EXPECT_GT(contacts[solver.name], 0U) << solver.name << " met nothing that touches";
  }
  for (const TermEntry& entry : term_entries())
    EXPECT_TRUE(terms.contains(std::string(entry.name))) << entry.name;
  for (const Feature& feature : test::features()) EXPECT_GT(features[feature.name], 0U) << feature.name;
  EXPECT_GE(cells, 40U);
}

/// Random scenes with many features at once, linear solvers, precisions and Hessians.
TEST(StepsInARow, AreThoseOfRandomScenes) {
  std::mt19937_64 rng(20261128);
  const auto one_of = [&rng](const auto& list) { return list[rng() % list.size()]; };
  const std::vector<std::string> linear = {"cholmod", "pcg", "lagged_cholesky"},
                                 steps = {"implicit_euler", "bdf2", "newmark"},
                                 solvers = {"line_search", "line_search", "al_barrier", "pncg"};
  std::set<std::string> terms;
  std::size_t contacts = 0, run = 0;
  for (int trial = 0; trial < 24; ++trial) {
    Choice choice{one_of(solvers), one_of(steps), one_of(policies), one_of(linear)};
    choice.precision = one_of(std::vector{Precision::full, Precision::full, Precision::mixed});
    choice.hessian = one_of(std::vector{HessianMode::gauss_newton, HessianMode::projected_full});
    std::vector<const Feature*> some;
    for (const Feature& feature : test::features())
      if (rng() % 2 == 0) some.push_back(&feature);
    if (const auto seen = compared(some, choice, terms)) contacts += seen->contacts, ++run;
    if (HasFailure()) return;
  }
  EXPECT_GE(run, 12U);
  EXPECT_GT(contacts, 100U);
}

/// Without anything that remembers, positions and velocities at the start of a step are all that it depends on: of a solver of
/// which each step is that of the first of a run.
TEST(StepsInARow, DependOnPositionsAndVelocitiesAloneWhereNothingRemembers) {
  const std::set<std::string> remember = {"al_free"};  // its constraints, from step to step
  std::size_t judged = 0, contacts = 0;
  for (const StepSolverEntry& solver : step_solvers()) {
    if (remember.contains(solver.name)) continue;
    for (const bool all : {false, true}) {
      FeatureScene parts = test::falling_sheets();
      for (const Feature& feature : test::features())
        if (all && !feature.remembers && !feature.takes_time) feature.add(parts);
      Choice choice{solver.name, "implicit_euler"};
      // friction remembers the loads of the step before where contact begins each step without its multipliers
      choice.friction = solver.needs.multipliers ? 0 : parts.friction;
      const Scene scene = parts.scene();
      try {
        Runner run(scene, choice);
        for (int step = 0; step < n_steps; ++step) {
          Scene here = scene;
          here.x0 = run.simulation.history().x;
          here.v0 = run.simulation.history().v;
          Runner first(here, choice);
          Said said, of_first;
          run.simulation.step(said);
          first.simulation.step(of_first);
          EXPECT_TRUE(run.simulation.history().x == first.simulation.history().x)
              << solver.name << (all ? " with all features" : "") << ", step " << step;
          EXPECT_TRUE(run.simulation.history().v == first.simulation.history().v) << solver.name << step;
          contacts += said.contacts;
          ++judged;
        }
      } catch (const ConfigError&) {
        EXPECT_TRUE(all) << solver.name;  // it takes springs and contact
      }
    }
  }
  EXPECT_GE(judged, 50U);
  EXPECT_GT(contacts, 50U);
}

}  // namespace
}  // namespace bb::steps_in_a_row_test
