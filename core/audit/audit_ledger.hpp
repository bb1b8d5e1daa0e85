// What the audit of a whole run found, summed over its accepted states and motions, and what it judged.
#pragma once

#include <algorithm>
#include <optional>

#include "core/audit/motion_audit.hpp"
#include "core/audit/state_audit.hpp"
#include "core/audit/step_end.hpp"

namespace bb::audit {

/// What there is to judge: sizes of the surface, and what has to be checked at the obstacles.
struct AuditSubjects {
  long edges = 0, triangles = 0, vertices = 0, obstacles = 0;
  ObstacleCounts at_obstacles;  // checks of one state, over all obstacles
};

struct AuditLedger {
  AuditSubjects subjects;
  long states = 0, motions = 0;
  long state_pairs = 0, motion_pairs = 0;  // that met in the broad phase
  long pair_queries = 0;                   // primitives compared with all that they may meet
  ObstacleCounts obstacle_judged;          // primitives compared with an obstacle, at rest and in motion
  long crossings = 0, touches = 0;         // of states
  long violations = 0, unproven = 0;       // of motions; unproven ones at obstacles too
  long inverted = 0;                       // planar elements, summed over states; not a penetration
  long obstacle_violations = 0;            // of states and motions
  long obstacle_by_vertex = 0;             // those in which a vertex is beyond, not only what lies between
  long overlaps =
      0;  // of ends of steps: primitives beyond an obstacle by no more than the step solver promises
  double deepest_overlap_m = 0;  // of these
  int first_overlap_step = -1;
  long corners_cut = 0;          // ways over a step that cut a corner round a sphere or a cylinder
  long scene_faults = 0;         // prescribed primitives that cross or cannot be certified; in no other count
  long non_finite = 0;           // states and motions that could not be judged
  long unjudged = 0;             // states of the run that no judged motion led to
  long obstacle_unproven = 0;    // those of unproven at obstacles
  bool only_points = false;      // what surfaces do to each other is counted and decides nothing
  bool self_test_passed = true;  // of the exact predicates on this machine
  int first_bad_step = -1;       // first step at which clean() became false
  int first_fault_step = -1;
  std::optional<PairName> first_bad;    // and what was found there, if not a fault of the scene
  std::optional<PairName> first_fault;  // the first fault of the scene

  /// Number of primitives that were compared with all that they may meet, over all states and motions; boxes
  /// decide most of them. 0 when no pair of the surface was, or when a kind of primitive that the obstacles require
  /// was never checked: such a run was not audited. Only loose particles, which have neither edges nor
  /// triangles, have no pairs: they can pass through obstacles and nothing else.
  long judged() const {
    const ObstacleCounts &need = subjects.at_obstacles, &done = obstacle_judged;
    const bool kinds = (need.vertices == 0 || done.vertices > 0) && (need.edges == 0 || done.edges > 0) &&
                       (need.triangles == 0 || done.triangles > 0);
    const bool pairs = subjects.edges + subjects.triangles == 0 || pair_queries > 0;
    const bool all = pairs && kinds && (subjects.obstacles == 0 || done.total() > 0);
    if (only_points) return kinds ? done.total() : 0;
    return all ? pair_queries + done.total() : 0;
  }

  /// What the solver moves penetrated something that it has to keep out of.
  bool penetrated() const { return obstacle_violations > 0 || (!only_points && crossings + violations > 0); }

  /// Nothing bad was found. Says nothing of how much was judged.
  bool clean() const {
    return !penetrated() && (only_points ? obstacle_unproven : unproven) == 0 && scene_faults == 0 &&
           non_finite == 0 && unjudged == 0 && self_test_passed;
  }

  /// No accepted state or motion penetrates, every one of them was judged, and there was something to judge.
  /// Touches and inversions are reported apart and do not enter.
  bool ok() const { return clean() && judged() > 0; }

  void add(const StateAudit& s, int step) {
    ++states;
    add_found(s, step);
  }
  void add(const MotionAudit& m, int step) {
    ++motions;
    add_found(m, step);
  }
  /// Of the pairs that are judged at the ends of steps alone: the state there, which add() counts, and the
  /// motion of the step.
  void add_late(const StateAudit& end, const MotionAudit& way, int step) {
    add_found(end, step);
    add_found(way, step);
  }
  void add(const StepEndAudit& e, int step) {
    obstacle_judged.add(e.obstacles.judged);
    obstacle_violations += e.obstacles.violations, obstacle_by_vertex += e.obstacles.by_vertex;
    unproven += e.obstacles.unproven, obstacle_unproven += e.obstacles.unproven;
    scene_faults += e.obstacles.scene_faults;
    overlaps += e.overlaps;
    corners_cut += e.corners_cut;
    deepest_overlap_m = std::max(deepest_overlap_m, e.deepest_m);
    if (e.overlaps > 0 && first_overlap_step < 0) first_overlap_step = step;
    note(step, e.obstacles.first_bad, e.obstacles.first_fault);
  }
  /// A state that the run reached, and that is not the end of the last judged motion.
  void add_unjudged(int step) {
    ++unjudged;
    note(step, std::nullopt, std::nullopt);
  }

 private:
  void add_found(const StateAudit& s, int step) {
    state_pairs += s.pairs, pair_queries += s.queries;
    obstacle_judged.add(s.obstacle_judged);
    crossings += s.crossings, touches += s.touches, inverted += s.inverted;
    obstacle_by_vertex += s.obstacle_by_vertex;
    obstacle_violations += s.obstacle_violations, scene_faults += s.scene_faults;
    non_finite += s.finite ? 0 : 1;
    note(step, s.first_bad, s.first_fault);
  }
  void add_found(const MotionAudit& m, int step) {
    motion_pairs += m.pairs, pair_queries += m.queries;
    obstacle_judged.add(m.obstacle_judged);
    violations += m.violations, unproven += m.unproven + m.obstacle_unproven;
    obstacle_unproven += m.obstacle_unproven;
    obstacle_by_vertex += m.obstacle_by_vertex;
    obstacle_violations += m.obstacle_violations, scene_faults += m.scene_faults;
    non_finite += m.finite ? 0 : 1;
    note(step, m.first_bad, m.first_fault);
  }
  void note(int step, const std::optional<PairName>& bad, const std::optional<PairName>& fault) {
    if (!first_fault && fault) first_fault = fault, first_fault_step = step;
    if (clean()) return;
    if (first_bad_step < 0) first_bad_step = step;
    if (!first_bad && bad && bad->kind != PairKind::inverted) first_bad = bad;
  }
};

}  // namespace bb::audit
