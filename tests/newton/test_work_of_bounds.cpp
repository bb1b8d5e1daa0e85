// An iteration that requests the bound of more than one motion states the work of all of them.
#include <gtest/gtest.h>

#include "tests/newton/scripted_system.hpp"

namespace bb::work_of_bounds_test {
namespace {

using test::Change;
using test::ScriptedIteration;
using test::ScriptedStep;

/// An iteration whose direction is bounded by 0.1, and a second one that ends the step.
std::vector<ScriptedIteration> held(double corrected_bound, bool serves = true) {
  ScriptedIteration first{.dx = 1, .slope = -1, .bound = 0.1};
  first.corrected_bound = corrected_bound;
  first.work.queries = 50, first.work.probes = 70, first.work.capped = 3, first.work.zero = 2;
  if (!serves)
    first.change = [](double alpha) -> Change { return EnergyChange{alpha > 0.2 ? 1 : -alpha, 1e-3}; };
  return {first, {.dx = 1e-5, .slope = -1e-10}};
}

void expect_work(const std::vector<ScriptedIteration>& script, int times, long long detours) {
  const ScriptedStep step(script);
  ASSERT_EQ(step.report.status, StepStatus::converged);
  const StepBound& said = step.iterations.at(0).bound;
  EXPECT_EQ(step.iterations[0].detours, detours);
  EXPECT_EQ(said.queries, 50 * times);
  EXPECT_EQ(said.probes, 70 * times);
  EXPECT_EQ(said.capped, 3 * times) << "ccd_cap is an outcome: what ran out of probes is never forgotten";
  EXPECT_EQ(said.zero, 2 * times);
}

TEST(WorkOfBounds, IsThatOfOneMotionOfACurvatureCorrectionAndOfTheWayBack) {
  expect_work(held(0), 1, 0);
  expect_work(held(1), 2, 1);
  expect_work(held(1, false), 3, 0);
}

/// Of a direction that is lengthened because steps crawl: of dx and of the longer one.
TEST(WorkOfBounds, IsThatOfADirectionAndOfALongerOne) {
  ScriptedIteration crawl{.dx = 1, .slope = -1, .bound = 1e9};
  crawl.t = 0.125, crawl.lengthens = true;
  crawl.change = [](double length) -> Change { return EnergyChange{-length, 1e-3}; };
  crawl.work.queries = 50, crawl.work.capped = 3;
  const ScriptedStep step({crawl}, SaddleRule::escape, 0.1, 22);
  ASSERT_EQ(step.report.solver.values.at("lengthened"), 2);
  EXPECT_EQ(step.iterations[19].bound.capped, 3);
  EXPECT_EQ(step.iterations[20].bound.capped, 6);
  EXPECT_EQ(step.iterations[21].bound.queries, 100);
}

}  // namespace
}  // namespace bb::work_of_bounds_test
