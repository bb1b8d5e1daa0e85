// The pass `audit`: every state and motion of a run goes to the audit, its ledger to the record.
#pragma once

#include "core/audit/audit.hpp"
#include "core/base/record/run_record.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/outcome.hpp"

namespace bb {

class Archive;

class AuditWatch {
 public:
  /// Judges the start. scene and record must outlive it. dt: of a whole step, s.
  /// promised_overlap: as of Audit; only_points: as of AuditMesh.
  AuditWatch(const Scene& scene, double dt, double min_gap_fraction, AuditRecord& record,
             double promised_overlap = 0, bool only_points = false);

  void on_motion(const Positions& x0, const Positions& x1, int step);
  /// Fills the counts of the step that ended at x.
  void on_step(const Positions& x, StepRecord& step);
  /// Forgets the motions since the last step ended: they are no part of the run.
  void on_retry();
  /// The same, and until the step is over no pair waits for its end: every motion is bounded.
  void on_redo();
  /// What the audit found so far, at the end of a step.
  void keep(Archive& archive);
  const audit::AuditLedger& ledger() const { return audit_.ledger(); }
  /// What was found, as an outcome.
  Verdict verdict() const;

 private:
  void judge(const Positions& x, int step);
  void measure_gaps(const Positions& x, StepRecord& step);
  void fill_record();
  void note_step_end(int step);

  const Scene& scene_;
  AuditRecord& record_;
  audit::AuditMesh mesh_;  // for names
  audit::Audit audit_;
  double tolerance_ = 0;
  double reach_ = 0;       // m, within which gaps between surfaces are measured: the largest d_hat
  Positions last_judged_;  // where the next motion has to start
  long crossings_ = 0;     // that state's, with primitives beyond obstacles
  struct {
    audit::AuditLedger ledger;
    Positions last_judged;  // the end of the step
    long crossings = 0;     // of it
  } at_step_end_;
};

}  // namespace bb
