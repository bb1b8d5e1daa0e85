#include "experiments/run/audit_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/archive/archive.hpp"
#include "core/base/record/phase_times.hpp"
#include "experiments/run/audit_mesh.hpp"
#include "experiments/run/audit_verdict.hpp"

namespace bb {
namespace audit {

static void keep(Archive& archive, PairName& name) {
  archive(name.kind, name.first, name.second, name.proven);
}

static void keep(Archive& archive, AuditLedger& ledger) {
  archive(ledger.states, ledger.motions, ledger.state_pairs, ledger.motion_pairs, ledger.pair_queries,
          ledger.obstacle_judged.vertices, ledger.obstacle_judged.edges, ledger.obstacle_judged.triangles,
          ledger.crossings, ledger.touches, ledger.violations, ledger.unproven, ledger.obstacle_unproven,
          ledger.inverted, ledger.obstacle_violations, ledger.overlaps, ledger.deepest_overlap_m,
          ledger.first_overlap_step, ledger.corners_cut, ledger.scene_faults, ledger.non_finite,
          ledger.unjudged, ledger.self_test_passed, ledger.first_bad_step, ledger.first_fault_step,
          ledger.first_bad, ledger.first_fault);
}

}  // namespace audit

AuditWatch::AuditWatch(const Scene& scene, double dt, double min_gap_fraction, AuditRecord& record,
                       double promised_overlap, bool only_points)
    : scene_(scene),
      record_(record),
      mesh_(make_audit_mesh(scene, dt, only_points)),
      audit_(mesh_, promised_overlap),
      tolerance_(audit_tolerance(scene, min_gap_fraction)),
      reach_(*std::max_element(scene.d_hat.begin(), scene.d_hat.end())) {
  if (promised_overlap > 0) record_.promised_m = promised_overlap;
  if (only_points) record_.obstacles_judge = "points";
  judge(scene.x0, -1);
  audit_.check_step_end(scene.x0, scene.x0, -1, tolerance_);
  at_step_end_ = {audit_.ledger(), last_judged_, crossings_};
}

void AuditWatch::judge(const Positions& x, int step) {
  const double start = now_s();
  const audit::StateAudit found = audit_.check_state(x, step);
  crossings_ = found.crossings + found.obstacle_violations;
  last_judged_ = x;
  record_.time_s += now_s() - start;
}

void AuditWatch::on_motion(const Positions& x0, const Positions& x1, int step) {
  const double start = now_s();
  if (x0 != last_judged_) audit_.note_unjudged(step);
  audit_.check_motion(x0, x1, step, tolerance_);
  record_.time_s += now_s() - start;
  judge(x1, step);
}

void AuditWatch::on_step(const Positions& x, StepRecord& step) {
  if (x != last_judged_) audit_.note_unjudged(step.step);
  const double start = now_s();
  audit_.check_step_end(at_step_end_.last_judged, x, step.step, tolerance_);
  audit_.judge_all_motions(false);
  record_.time_s += now_s() - start;
  const AuditRecord before = record_;
  fill_record();
  step.crossings = record_.crossings - before.crossings;
  step.violations = record_.violations - before.violations;
  step.unproven = record_.unproven - before.unproven;
  step.inverted = record_.inverted - before.inverted;
  note_step_end(step.step);
  measure_gaps(x, step);
  at_step_end_ = {audit_.ledger(), last_judged_, crossings_};
}

void AuditWatch::note_step_end(int step) {
  if (crossings_ == 0 && record_.step_end_crossings_last > 0) record_.recovered_step = step;
  record_.step_end_crossings_last = crossings_;
  record_.step_end_crossings_max = std::max<long long>(record_.step_end_crossings_max, crossings_);
}

void AuditWatch::measure_gaps(const Positions& x, StepRecord& step) {
  if (step.status != StepStatus::converged) {
    step.surface_gap_obstacles_m = step.surface_gap_between_m = Number::missing("not_converged");
    return;
  }
  const double start = now_s();
  const audit::SurfaceGap gap = audit_.gap_of(x, reach_);
  const auto number = [](double m, const char* absent) {
    return std::isfinite(m) ? Number(m) : Number::missing(absent);
  };
  step.surface_gap_obstacles_m = number(gap.to_obstacles, "no_obstacles");
  step.surface_gap_between_m = number(gap.between, "none_within_d_hat");
  keep_smaller(record_.surface_gap_obstacles_m, step.surface_gap_obstacles_m);
  keep_smaller(record_.surface_gap_between_m, step.surface_gap_between_m);
  ++record_.surface_gaps;
  record_.surface_gap_time_s += now_s() - start;
}

void AuditWatch::on_retry() {
  audit_.restore(at_step_end_.ledger);
  last_judged_ = at_step_end_.last_judged;
  crossings_ = at_step_end_.crossings;
}

void AuditWatch::on_redo() {
  on_retry();
  audit_.judge_all_motions(true);
}

// The subjects are those of the scene.
void AuditWatch::keep(Archive& archive) {
  archive(at_step_end_.ledger, at_step_end_.last_judged, at_step_end_.crossings);
  if (!archive.reads()) return;
  const audit::AuditSubjects subjects = audit_.ledger().subjects;
  at_step_end_.ledger.subjects = subjects;
  on_retry();
}

void AuditWatch::fill_record() {
  const audit::AuditLedger& ledger = audit_.ledger();
  record_.edges = ledger.subjects.edges;
  record_.triangles = ledger.subjects.triangles;
  record_.vertices = ledger.subjects.vertices;
  record_.obstacles = ledger.subjects.obstacles;
  record_.states = ledger.states;
  record_.motions = ledger.motions;
  record_.state_pairs = ledger.state_pairs;
  record_.motion_pairs = ledger.motion_pairs;
  record_.obstacle_queries = ledger.obstacle_judged.total();
  record_.obstacle_vertices = ledger.obstacle_judged.vertices;
  record_.obstacle_edges = ledger.obstacle_judged.edges;
  record_.obstacle_triangles = ledger.obstacle_judged.triangles;
  record_.judged = ledger.judged();
  record_.crossings = ledger.crossings;
  record_.touches = ledger.touches;
  record_.violations = ledger.violations + ledger.obstacle_violations;
  record_.unproven = ledger.unproven;
  record_.inverted = ledger.inverted;
  record_.obstacle_violations = ledger.obstacle_violations;
  record_.overlaps = ledger.overlaps;
  record_.overlap_max_m = ledger.overlaps > 0 ? Number(ledger.deepest_overlap_m) : Number::missing("none");
  record_.corners_cut = ledger.corners_cut;
  record_.scene_faults = ledger.scene_faults;
  record_.first_bad_step = ledger.first_bad_step;
}

Verdict AuditWatch::verdict() const {
  const audit::AuditLedger& ledger = audit_.ledger();
  Verdict out = judge_audit(scene_, mesh_, ledger);
  if (out.outcome == Outcome::penetration && record_.step_end_crossings_max > 0) {
    out.detail += fmt::format("; steps ended with at most {} crossings, the last with {}{}",
                              record_.step_end_crossings_max, record_.step_end_crossings_last,
                              record_.recovered_step >= 0
                                  ? fmt::format(", after recovery in step {}", record_.recovered_step)
                                  : std::string());
  }
  if (!mesh_.only_points || out.outcome != Outcome::ok) return out;
  const Number& gap = record_.surface_gap_obstacles_m;
  out.detail += fmt::format(
      "{}audit: points only: vertices were judged at obstacles; the surface between them is at most {:.3g} m "
      "deep in one, and surfaces pass through each other with {} crossings in states and {} passages in "
      "motions, which nothing keeps them from",
      out.detail.empty() ? "" : "; ", gap.finite() ? std::max(0.0, -gap.value) : 0.0, ledger.crossings,
      ledger.violations);
  return out;
}

}  // namespace bb
