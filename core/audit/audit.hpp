// The judge of a run. Newton hands it every accepted state and motion and never reads its verdict back:
// what the audit finds goes to the record and changes no step. Includes nothing of the solver's
// geometry or contact.
#pragma once

#include <optional>
#include <vector>

#include "core/audit/audit_ledger.hpp"
#include "core/audit/surface_gap.hpp"

namespace bb::audit {

class Audit {
 public:
  /// Errors: ConfigError if an index is negative or beyond `fixed`, a radius or an axis makes no obstacle,
  /// or the flags and opposite vertices do not fit the mesh.
  /// @param promised_overlap  m; where > 0, obstacles are judged at the ends of steps alone (check_step_end), with that tolerance.
  explicit Audit(AuditMesh mesh, double promised_overlap = 0);

  /// Judges x [3 n_vertices], m. The first call includes pairs within one rigid body, later calls skip them.
  /// Returns what this state adds to the ledger.
  StateAudit check_state(const Positions& x, int step);

  /// Judges the linear motion x0 -> x1, m, both ends as committed. @param tolerance m, a tenth of
  /// the park distance. Returns what this motion adds to the ledger.
  MotionAudit check_motion(const Positions& x0, const Positions& x1, int step, double tolerance);

  /// Judges a step from x0 to x1, m: the obstacles, where there is a promise, and the pairs of the mesh that
  /// are judged at the ends of steps alone (JudgedPairs::late), in the state x1 and in the straight motion,
  /// with the tolerance of check_motion. x0 is the end of the step before, or x1 at the start.
  void check_step_end(const Positions& x0, const Positions& x1, int step, double tolerance);

  /// Whether those pairs are judged as all others in the motions and states from here on, and not at the ends
  /// of steps.
  void judge_all_motions(bool all) { all_motions_ = all; }

  /// Reports a state that the run reached and that is not the end of the last judged motion: an audit with
  /// such a hole is never ok.
  void note_unjudged(int step) { ledger_.add_unjudged(step); }

  /// Smallest gaps of the whole surface in the state x, m; see surface_gap.hpp. No verdict depends on them.
  SurfaceGap gap_of(const Positions& x, double reach) const {
    return surface_gap(mesh_, vertices_, primitives_, x, reach);
  }

  const AuditMesh& mesh() const { return mesh_; }
  const std::vector<int>& vertices() const { return vertices_; }  // those that collide, ascending
  const AuditLedger& ledger() const { return ledger_; }
  /// Goes on from an earlier ledger of an audit of the same mesh: what was judged since never happened.
  void restore(const AuditLedger& earlier) { ledger_ = earlier; }

 private:
  /// What is judged within steps.
  const AuditMesh& in_motions() const { return late_ && !all_motions_ ? early_ : ends_ ? pairs_ : mesh_; }

  AuditMesh mesh_;
  std::vector<int> vertices_;
  ObstaclePrimitives primitives_;
  std::optional<StepEnds> ends_;   // where there is a promise
  AuditMesh pairs_;                // then: the mesh without obstacles
  std::optional<AuditMesh> late_;  // where some pairs are judged at the ends of steps: with these
  AuditMesh early_;                // then: with the others
  bool all_motions_ = false;
  AuditLedger ledger_;
};

}  // namespace bb::audit
