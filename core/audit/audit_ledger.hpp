// What the audit of a whole run found, summed over its accepted states and motions.
#pragma once

#include <algorithm>
#include <optional>

#include "core/audit/motion_audit.hpp"
#include "core/audit/state_audit.hpp"

namespace bb::audit {

struct AuditLedger {
  long states = 0, motions = 0;
  long crossings = 0, touches = 0;    // of states
  long motion_pairs = 0;              // judged
  long violations = 0, unproven = 0;  // of motions
  long inverted = 0;                  // planar elements, summed over states; not a penetration
  long obstacle_violations = 0;       // of states and motions
  long non_finite = 0;                // states and motions that could not be judged
  bool self_test_passed = true;       // of the exact predicates on this machine
  int first_bad_step = -1;            // first step at which ok() became false
  std::optional<PairName> first_bad;  // and what was found there

  /// No accepted state or motion penetrates, and every one of them was judged. Touches and inversions are
  /// reported apart and do not enter.
  bool ok() const {
    return crossings == 0 && violations == 0 && unproven == 0 && obstacle_violations == 0 &&
           non_finite == 0 && self_test_passed;
  }

  void add(const StateAudit& s, int step) {
    ++states;
    crossings += s.crossings, touches += s.touches, inverted += s.inverted;
    obstacle_violations += s.obstacle_violations, non_finite += s.finite ? 0 : 1;
    note(step, s.first_bad);
  }
  void add(const MotionAudit& m, int step) {
    ++motions;
    motion_pairs += m.pairs, violations += m.violations, unproven += m.unproven;
    obstacle_violations += m.obstacle_violations, non_finite += m.finite ? 0 : 1;
    note(step, m.first_bad);
  }

 private:
  void note(int step, const std::optional<PairName>& name) {
    if (ok() || first_bad_step >= 0) return;
    first_bad_step = step;
    first_bad = name;
  }
};

}  // namespace bb::audit
