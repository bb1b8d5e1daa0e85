// What makes a run invalid, one check at a time.
#include "experiments/run/validity.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace bb::validity_test {
namespace {

/// A run to which nothing can be objected.
struct Finished {
  Scene scene;
  audit::AuditLedger ledger;
  std::string hash_time = "aaaa", hash_seen = "aaaa";
  RunRecord record;

  Finished() {
    scene.limit.onset = {0.01, 0.02};
    scene.limit.width = {0.04, 0.04};
    ledger.pair_queries = 1;
    record.status.outcome = Outcome::ok;
    record.summary.max_stretch = 0.059;
  }

  /// The check of this name and whether the run is valid; every other check has to pass.
  const Check& failed(const std::string& name) {
    fill_validity(scene, &ledger, hash_time, hash_seen, record);
    EXPECT_FALSE(record.validity.valid) << name;
    const Check* found = nullptr;
    for (const Check& check : record.validity.checks) {
      if (check.name == name) found = &check;
      EXPECT_EQ(check.pass, check.name != name) << check.name;
    }
    if (!found) throw std::logic_error("no check " + name);
    return *found;
  }
};

TEST(Validity, ARunThatPassesAllFiveChecksIsValid) {
  Finished run;
  fill_validity(run.scene, &run.ledger, run.hash_time, run.hash_seen, run.record);
  EXPECT_EQ(run.record.validity.checks.size(), 5U);
  EXPECT_TRUE(run.record.validity.valid);
}

TEST(Validity, WhateverTheAuditFoundOrCouldNotJudgeIsNotClean) {
  using audit::AuditLedger;
  for (long AuditLedger::*count : {&AuditLedger::crossings, &AuditLedger::violations, &AuditLedger::unproven,
                                   &AuditLedger::obstacle_violations, &AuditLedger::scene_faults,
                                   &AuditLedger::non_finite, &AuditLedger::unjudged}) {
    Finished run;
    run.ledger.*count = 3;
    const Check& check = run.failed("audit_clean");
    EXPECT_EQ(check.value.value, 3);
    EXPECT_EQ(check.bound.value, 0);
  }
  Finished run;
  run.ledger.self_test_passed = false;
  run.failed("audit_clean");
}

TEST(Validity, AnAuditThatJudgedNothingDoesNotPass) {
  Finished run;
  run.ledger.pair_queries = 0;
  EXPECT_EQ(run.failed("audit_judged").value.value, 0);
}

TEST(Validity, PassesThatEndInDifferentStatesDoNotAgree) {
  Finished run;
  run.hash_seen = "aaab";
  run.failed("state_hash_equal_in_all_passes");
}

TEST(Validity, AStretchAtTheLargestLimitOrBeyondIsNotKept) {
  for (const double stretch : {0.06, 0.061}) {
    Finished run;
    run.record.summary.max_stretch = stretch;
    const Check& check = run.failed("strain_limit_kept");
    EXPECT_EQ(check.value.value, stretch);
    EXPECT_DOUBLE_EQ(check.bound.value, 0.06);
  }
}

TEST(Validity, AFailureIsNotValid) {
  Finished run;
  run.record.status.outcome = Outcome::newton_stall;
  run.failed("outcome_ok");
}

TEST(Validity, WhatWasNotDoneIsNotChecked) {
  Finished run;
  run.record.summary.max_stretch = Number::missing("no_limit");
  fill_validity(run.scene, nullptr, "", run.hash_seen, run.record);
  ASSERT_EQ(run.record.validity.checks.size(), 1U);
  EXPECT_EQ(run.record.validity.checks[0].name, "outcome_ok");
  EXPECT_TRUE(run.record.validity.valid);
}

TEST(Validity, AStepThatEndsInASaddleFailsAndWhatWasNotLookedAtIsNoProof) {
  Finished run;
  run.record.summary.end_proofs = {{"factor", 7}, {"saddle", 2}};
  const Check& check = run.failed("no_saddle");
  EXPECT_EQ(check.value.value, 2);
  EXPECT_EQ(check.bound.value, 0);
  for (const CountMap& proofs : {CountMap{{"factor", 9}}, CountMap{{"lanczos", 1}, {"unproven", 3}}}) {
    Finished good;
    good.record.summary.end_proofs = proofs;
    fill_validity(good.scene, &good.ledger, good.hash_time, good.hash_seen, good.record);
    EXPECT_EQ(good.record.validity.checks.size(), 6U);
    EXPECT_TRUE(good.record.validity.valid);
  }
  for (const CountMap& proofs : {CountMap{}, CountMap{{"not_checked", 9}}, CountMap{{"clamped", 9}}}) {
    Finished silent;
    silent.record.summary.end_proofs = proofs;
    fill_validity(silent.scene, &silent.ledger, silent.hash_time, silent.hash_seen, silent.record);
    for (const Check& each : silent.record.validity.checks) EXPECT_NE(each.name, "no_saddle");
  }
}

}  // namespace
}  // namespace bb::validity_test
