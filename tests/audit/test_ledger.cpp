// The verdict over a whole run: every count that is bad makes it bad, those that are reported apart do not, and a run in
// which a kind of primitive was never checked is not audited.
#include "core/audit/audit_ledger.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace bb::audit::ledger_test {
namespace {

/// A ledger of a scene in which everything was checked once.
AuditLedger judged_ledger() {
  AuditLedger ledger;
  ledger.subjects = {6, 4, 4, 1, {4, 6, 4}};
  ledger.pair_queries = 10;
  ledger.obstacle_judged = {4, 6, 4};
  return ledger;
}

PairName some_pair() { return {PairKind::edge_edge, 3, 5}; }

struct Counted {
  const char* what;
  bool bad, penetrated, fault;
};

void expect_verdict(const AuditLedger& ledger, const Counted& c, int step) {
  EXPECT_EQ(ledger.clean(), !c.bad) << c.what;
  EXPECT_EQ(ledger.ok(), !c.bad) << c.what;
  EXPECT_EQ(ledger.penetrated(), c.penetrated) << c.what;
  EXPECT_EQ(ledger.first_bad_step, c.bad ? step : -1) << c.what;
  EXPECT_EQ(ledger.first_fault_step, c.fault ? step : -1) << c.what;
  EXPECT_EQ(ledger.first_fault.has_value(), c.fault) << c.what;
}

TEST(Ledger, EveryBadCountOfAStateIsBad) {
  const std::vector<std::pair<Counted, std::function<void(StateAudit&)>>> cases = {
      {{"crossing", true, true, false}, [](StateAudit& s) { s.crossings = 1; }},
      {{"touch", false, false, false}, [](StateAudit& s) { s.touches = 1; }},
      {{"inverted", false, false, false}, [](StateAudit& s) { s.inverted = 1; }},
      {{"beyond an obstacle", true, true, false}, [](StateAudit& s) { s.obstacle_violations = 1; }},
      {{"fault", true, false, true}, [](StateAudit& s) { s.scene_faults = 1, s.first_fault = some_pair(); }},
      {{"not finite", true, false, false}, [](StateAudit& s) { s.finite = false; }},
      {{"nothing", false, false, false}, [](StateAudit&) {}}};
  for (const auto& [counted, change] : cases) {
    AuditLedger ledger = judged_ledger();
    ledger.add(StateAudit{}, 3);
    EXPECT_TRUE(ledger.ok());
    StateAudit state;
    change(state);
    ledger.add(state, 7);
    ledger.add(StateAudit{}, 9);
    expect_verdict(ledger, counted, 7);
    EXPECT_EQ(ledger.states, 3);
    EXPECT_EQ(ledger.crossings + ledger.touches + ledger.inverted + ledger.obstacle_violations +
                  ledger.scene_faults + ledger.non_finite,
              std::string(counted.what) == "nothing" ? 0 : 1);
  }
}

TEST(Ledger, EveryBadCountOfAMotionIsBad) {
  const std::vector<std::pair<Counted, std::function<void(MotionAudit&)>>> cases = {
      {{"violation", true, true, false}, [](MotionAudit& m) { m.violations = 1; }},
      {{"unproven", true, false, false}, [](MotionAudit& m) { m.unproven = 1; }},
      {{"unproven at an obstacle", true, false, false}, [](MotionAudit& m) { m.obstacle_unproven = 1; }},
      {{"beyond an obstacle", true, true, false}, [](MotionAudit& m) { m.obstacle_violations = 1; }},
      {{"fault", true, false, true}, [](MotionAudit& m) { m.scene_faults = 1, m.first_fault = some_pair(); }},
      {{"not finite", true, false, false}, [](MotionAudit& m) { m.finite = false; }},
      {{"nothing", false, false, false}, [](MotionAudit&) {}}};
  for (const auto& [counted, change] : cases) {
    AuditLedger ledger = judged_ledger();
    ledger.add(MotionAudit{}, 3);
    MotionAudit motion;
    change(motion);
    ledger.add(motion, 7);
    ledger.add(MotionAudit{}, 9);
    expect_verdict(ledger, counted, 7);
    EXPECT_EQ(ledger.motions, 3);
    EXPECT_EQ(ledger.violations + ledger.unproven + ledger.obstacle_violations + ledger.scene_faults +
                  ledger.non_finite,
              std::string(counted.what) == "nothing" ? 0 : 1);
  }
}

TEST(Ledger, CountsOfStatesAndMotionsAddUp) {
  AuditLedger ledger;
  for (int k = 1; k <= 2; ++k) {
    StateAudit state;
    state.pairs = 1, state.queries = 2, state.obstacle_judged = {3, 4, 5};
    state.crossings = 6, state.touches = 7, state.inverted = 8;
    state.obstacle_violations = 9, state.obstacle_by_vertex = 10, state.scene_faults = 11;
    ledger.add(state, k);
    MotionAudit motion;
    motion.pairs = 12, motion.queries = 13, motion.obstacle_judged = {14, 15, 16};
    motion.violations = 17, motion.unproven = 18, motion.obstacle_unproven = 19;
    motion.obstacle_violations = 20, motion.obstacle_by_vertex = 21, motion.scene_faults = 22;
    ledger.add(motion, k);
    ledger.add_unjudged(k);
  }
  EXPECT_EQ(ledger.states, 2);
  EXPECT_EQ(ledger.motions, 2);
  EXPECT_EQ(ledger.state_pairs, 2);
  EXPECT_EQ(ledger.motion_pairs, 24);
  EXPECT_EQ(ledger.pair_queries, 2 * (2 + 13));
  EXPECT_EQ(ledger.obstacle_judged.vertices, 2 * (3 + 14));
  EXPECT_EQ(ledger.obstacle_judged.edges, 2 * (4 + 15));
  EXPECT_EQ(ledger.obstacle_judged.triangles, 2 * (5 + 16));
  EXPECT_EQ(ledger.crossings, 12);
  EXPECT_EQ(ledger.touches, 14);
  EXPECT_EQ(ledger.inverted, 16);
  EXPECT_EQ(ledger.violations, 34);
  EXPECT_EQ(ledger.unproven, 2 * (18 + 19));
  EXPECT_EQ(ledger.obstacle_violations, 2 * (9 + 20));
  EXPECT_EQ(ledger.obstacle_by_vertex, 2 * (10 + 21));
  EXPECT_EQ(ledger.scene_faults, 2 * (11 + 22));
  EXPECT_EQ(ledger.unjudged, 2);
}

TEST(Ledger, AHoleInTheRunAndAFailedSelfTestAreBad) {
  AuditLedger ledger = judged_ledger();
  ledger.add_unjudged(4);
  expect_verdict(ledger, {"unjudged", true, false, false}, 4);
  AuditLedger broken = judged_ledger();
  broken.self_test_passed = false;
  EXPECT_FALSE(broken.clean());
  EXPECT_FALSE(broken.penetrated());
}

/// Pairs of the surface, and each kind that the obstacles require, have to be checked at least once.
TEST(Ledger, AKindThatWasNeverAskedLeavesNothingJudged) {
  EXPECT_EQ(judged_ledger().judged(), 10 + 4 + 6 + 4);
  for (long ObstacleCounts::*kind :
       {&ObstacleCounts::vertices, &ObstacleCounts::edges, &ObstacleCounts::triangles}) {
    AuditLedger missing = judged_ledger();
    missing.obstacle_judged.*kind = 0;
    EXPECT_EQ(missing.judged(), 0);
    EXPECT_TRUE(missing.clean());
    EXPECT_FALSE(missing.ok());
    missing.subjects.at_obstacles.*kind = 0;  // not requested, so not missed
    EXPECT_GT(missing.judged(), 0);
    EXPECT_TRUE(missing.ok());
  }
  AuditLedger no_pairs = judged_ledger();
  no_pairs.pair_queries = 0;
  for (long AuditSubjects::*part : {&AuditSubjects::edges, &AuditSubjects::triangles}) {
    no_pairs.subjects.edges = no_pairs.subjects.triangles = 0;
    no_pairs.subjects.*part = 1;
    EXPECT_EQ(no_pairs.judged(), 0);
  }
  no_pairs.subjects.edges = no_pairs.subjects.triangles = 0;  // loose particles
  EXPECT_EQ(no_pairs.judged(), 4 + 6 + 4);
  AuditLedger no_obstacle = judged_ledger();
  no_obstacle.obstacle_judged = {}, no_obstacle.subjects.at_obstacles = {};
  EXPECT_EQ(no_obstacle.judged(), 0);  // there is one
  no_obstacle.subjects.obstacles = 0;
  EXPECT_EQ(no_obstacle.judged(), 10);
}

/// The first of each, in time; an inverted element is never named as bad.
TEST(Ledger, TheFirstFindsAreKept) {
  AuditLedger ledger = judged_ledger();
  StateAudit state;
  state.inverted = 1, state.first_bad = PairName{PairKind::inverted, 2, 2};
  ledger.add(state, 1);
  EXPECT_EQ(ledger.first_bad_step, -1);
  EXPECT_FALSE(ledger.first_bad);
  state.crossings = 1;
  ledger.add(state, 2);
  EXPECT_EQ(ledger.first_bad_step, 2);
  EXPECT_FALSE(ledger.first_bad);
  MotionAudit motion;
  motion.violations = 1, motion.first_bad = PairName{PairKind::edge_edge, 8, 9};
  ledger.add(motion, 3);
  motion.first_bad = PairName{PairKind::edge_triangle, 0, 1};
  ledger.add(motion, 4);
  EXPECT_EQ(ledger.first_bad_step, 2);
  ASSERT_TRUE(ledger.first_bad);
  EXPECT_EQ(*ledger.first_bad, (PairName{PairKind::edge_edge, 8, 9}));
  MotionAudit fault;
  fault.scene_faults = 1, fault.first_fault = some_pair();
  ledger.add(fault, 5);
  fault.first_fault = PairName{};
  ledger.add(fault, 6);
  EXPECT_EQ(ledger.first_fault_step, 5);
  EXPECT_EQ(*ledger.first_fault, some_pair());
}

}  // namespace
}  // namespace bb::audit::ledger_test
