// The strain limit of an executor against the term of the CPU path: stiffness, feasibility, bound, reports.
#include <cmath>

#include "core/math/error.hpp"
#include "tests/barriers/host_policy.hpp"
#include "tests/executor/limit_rules.hpp"
#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec_limit_test {
namespace {

using namespace bb::test;

// Two iterates of one step, so that kappa is refreshed or kept.
TEST(ExecutorLimit, HasTheTermsOfTheCpuForEveryRule) {
  for (const bool planar : {false, true}) {
    const Scene scene = cloth_scene("corotational", planar);
    const StepFrame frame = step_frame(scene);
    for (const LimitRule& rule : limit_rules()) {
      TermOptions options = element_options(rule.shape);
      options.limit_stiffness = rule.policy();
      CpuElements cpu(scene, options, frame);
      test::TestedExecutor executor;
      OnExecutor resident(executor, scene, options, frame);
      const double tolerance = planar ? rule.tolerance : std::max(rule.tolerance, 1e-12);
      for (const double size : {0.006, 0.009}) {
        const Positions x = strained(scene, size);
        cpu.linearise(x, StepHessian::clamped);
        const double moved = resident.linearise(x);
        IterateNumbers report;
        const HostTerm& term = cpu.terms[cpu.terms.size() - 1];
        ASSERT_EQ(term.name(), "strain_limit");
        const_cast<HostTerm&>(term).report(x, report, cpu.clock);
        const IterateNumbers numbers = resident.report();
        const double load_max = numbers.limit_load_max_N_per_m.value;
        ASSERT_GT(load_max, 0);
        ASSERT_GT(numbers.limit_gap_min_rel.value, 0);
        EXPECT_EQ(numbers.max_stretch.value, report.max_stretch.value);
        EXPECT_EQ(numbers.limit_gap_min_rel.value, report.limit_gap_min_rel.value);
        EXPECT_NEAR(load_max, report.limit_load_max_N_per_m.value, std::max(tolerance, 1e-14) * load_max);
        EXPECT_NEAR(moved, report.limit_kappa_change_rel.value, tolerance * (1 + moved));
        const bool moves = rule.elastic && rule.elastic->refresh == Refresh::per_iteration && size > 0.007;
        EXPECT_EQ(moved > 1e-6, moves) << rule.shape;
        double energy = 0;
        for (const double e : term.families()[0].local.energy) energy += e;
        ASSERT_GT(energy, 0);
        EXPECT_NEAR(resident.energy(TermGroup::limit).value(), energy, std::max(tolerance, 1e-14) * energy);
        const double difference =
            (resident.gradient() - cpu.gradient).cwiseAbs().maxCoeff() / cpu.gradient.cwiseAbs().maxCoeff();
        EXPECT_LE(difference, tolerance) << rule.shape << " planar " << planar;
      }
    }
  }
}

TEST(ExecutorLimit, BoundsAStepAsTheCpuDoes) {
  int n_below = 0;
  for (const bool planar : {false, true}) {
    const Scene scene = cloth_scene("corotational", planar);
    TermOptions options = element_options();
    const StepFrame frame = step_frame(scene);
    CpuElements cpu(scene, options, frame);
    test::TestedExecutor executor;
    OnExecutor resident(executor, scene, options, frame);
    const Positions x = strained(scene);
    cpu.linearise(x, StepHessian::clamped);
    resident.linearise(x);
    HostTerm& term = const_cast<HostTerm&>(cpu.terms[cpu.terms.size() - 1]);
    for (const double park : {0.0, 1e-4, 0.3}) {
      options.contact_options.ccd_park = park;
      for (const double size : {1e-4, 0.03, 0.1, 0.7, 20.0}) {
        const Positions dx = wave(scene, size), x1 = x + dx;
        IterateNumbers report;
        const double expected = bound(term, {x, x1, dx}, report, cpu.clock);
        const double found = resident.bound(dx);
        EXPECT_EQ(found, expected) << size << " " << park;
        n_below += found > 0 && found < 1;
        EXPECT_TRUE(resident.evaluate(x + found * dx));
        EXPECT_EQ(resident.evaluate(x + 1.01 * found * dx) || found == 1 || park > 0, found == 1 || park > 0);
      }
    }
  }
  EXPECT_GT(n_below, 10);
}

TEST(ExecutorLimit, RefusesStatesBeyondIt) {
  const Scene scene = cloth_scene("arap", true, 4);
  TermOptions options = element_options();
  test::TestedExecutor executor;
  OnExecutor resident(executor, scene, options, step_frame(scene));
  resident.linearise(strained(scene));
  Positions beyond = scene.x0;
  beyond.row(0) *= 1.3;
  EXPECT_FALSE(resident.evaluate(beyond));
  Positions nowhere = scene.x0;
  nowhere(1, 7) = std::nan("");
  EXPECT_FALSE(resident.evaluate(nowhere));
  EXPECT_TRUE(resident.evaluate(strained(scene)));
  options.limit.literal = true;  // is read at every call
  EXPECT_TRUE(resident.evaluate(beyond));
}

TEST(ExecutorLimit, LiteralAndSquaredGapAreThoseOfTheCpu) {
  const Scene scene = cloth_scene("arap", true, 4);
  const StepFrame frame = step_frame(scene);
  int n_beyond = 0;
  for (const char* shape : {"log", "log_squared", "quadratic", "cubic", "two_stage", "exponential"}) {
    for (const bool literal : {false, true}) {
      TermOptions options = element_options(shape);
      options.limit.literal = literal;
      if (!literal) options.limit.argument = Argument::squared_gap;
      Positions x = strained(scene);
      if (literal) x.row(0) *= 1.3, ++n_beyond;
      CpuElements cpu(scene, options, frame);
      test::TestedExecutor executor;
      OnExecutor resident(executor, scene, options, frame);
      cpu.linearise(x, StepHessian::clamped);
      resident.linearise(x);
      const double scale = cpu.gradient.cwiseAbs().maxCoeff();
      ASSERT_TRUE(std::isfinite(scale));
      EXPECT_LE((resident.gradient() - cpu.gradient).cwiseAbs().maxCoeff(), 1e-12 * scale)
          << shape << literal;
    }
  }
  EXPECT_EQ(n_beyond, 6);
}

// What was measured of a refused trial is not taken for the iterate, and what was measured of an accepted one is.
TEST(ExecutorLimit, IsMeasuredWhereItIsAsked) {
  const Scene scene = cloth_scene("arap", false);
  for (const bool elastic : {false, true}) {
    TermOptions options = element_options();
    if (elastic) options.limit_stiffness = elastic_limit();
    const StepFrame frame = step_frame(scene);
    test::TestedExecutor executor;
    OnExecutor resident(executor, scene, options, frame), fresh(executor, scene, options, frame);
    const Positions x = strained(scene), to = strained(scene, 0.009);
    resident.linearise(x);
    resident.fill(TermSet::all(), {});
    const std::vector<double> matrix = resident.matrix();
    const double stretch = resident.report().max_stretch.value;
    ASSERT_TRUE(resident.evaluate(to));
    EXPECT_EQ(resident.report().max_stretch.value, stretch);
    ASSERT_TRUE(resident.evaluate(to));
    resident.fill(TermSet::all(), {});
    EXPECT_EQ(resident.matrix(), matrix);
    ASSERT_TRUE(resident.evaluate(to));
    resident.accept();
    EXPECT_NE(resident.report().max_stretch.value, stretch);
    resident.linearise(to);
    fresh.linearise(x), fresh.linearise(to);
    EXPECT_EQ(resident.gradient(), fresh.gradient());
    fresh.fill(TermSet::all(), {}), resident.fill(TermSet::all(), {});
    EXPECT_EQ(resident.matrix(), fresh.matrix());
    EXPECT_NE(resident.matrix(), matrix);
  }
}

TEST(ExecutorLimit, IsLeftOutWhereNothingIsLimited) {
  const Scene scene = cloth_scene("arap", true, 4);
  TermOptions options = element_options();
  options.strain_limit = false;
  test::TestedExecutor executor;
  OnExecutor resident(executor, scene, options, step_frame(scene));
  EXPECT_EQ(resident.linearise(scene.x0), 0);
  EXPECT_EQ(resident.bound(wave(scene, 10)), 1);
  EXPECT_FALSE(resident.report().max_stretch.finite());
}

TEST(ExecutorLimit, RefusesAPolicyWithoutKernelByItsName) {
  const Scene scene = cloth_scene("corotational", false);
  TermOptions options = element_options();
  options.limit_stiffness = std::make_unique<HostPolicy>();
  test::TestedExecutor executor;
  try {
    const OnExecutor resident(executor, scene, options);
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations()[0].where, "stiffness_policy/name");
    EXPECT_EQ(error.violations()[0].found, "host_only");
  }
}

}  // namespace
}  // namespace bb::exec_limit_test
