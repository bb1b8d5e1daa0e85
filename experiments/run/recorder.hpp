// The observer that keeps a run: trace rows, step records, and what condition estimates and audit find. It
// changes nothing: the state hash is the same with and without it.
#pragma once

#include <optional>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "core/base/record/writer.hpp"
#include "core/newton/report.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/artifacts.hpp"
#include "experiments/run/audit_watch.hpp"
#include "experiments/run/condition_watch.hpp"
#include "experiments/run/contact_gaps.hpp"
#include "experiments/run/first_contacts.hpp"
#include "experiments/run/outcome.hpp"
#include "experiments/run/pair_forces.hpp"

namespace bb {

class Recorder final : public StepObserver {
 public:
  /// trace and artifacts may be null (nothing is written). record is filled step by step.
  Recorder(const RunConfig& config, const Scene& scene, RunRecord& record, TraceWriter* trace,
           ArtifactWriter* artifacts = nullptr);

  /// The times that the trace gives to the iterations: those of the run that was timed, in order, or none.
  /// `times` must outlive the recorder.
  void report_times(const std::vector<PhaseTimes>& times) { reported_ = &times; }
  /// Of every iteration that this recorder saw.
  const std::vector<PhaseTimes>& iteration_times() const { return seen_; }

  void on_matrix(StepSystem& system, int step, int iteration) override;
  void on_iteration(const IterationReport& report) override;
  bool watches_motions() const override { return audit_.has_value(); }
  void on_motion(const Positions& x0, const Positions& x1, int step) override;
  void on_retry(int step) override;
  void on_redo(int step) override;
  void on_step(StepSystem& system, const StepReport& report, const Positions& x) override;

  /// What it has recorded so far, between two steps; its files are not in it.
  void keep(Archive& archive);
  /// Fills the summary and writes the frame of the last state, once the run is over.
  void finish();

  /// What the audit found, as an outcome; ok without the pass `audit`.
  Verdict audit_verdict() const;
  /// Of the audit; null without the pass `audit`.
  const audit::AuditLedger* ledger() const { return audit_ ? &audit_->ledger() : nullptr; }

 private:
  /// The end of a step without a frame of its own: the run may end there.
  struct LastState {
    int step = 0;
    Positions x;  // m
    ContactFields fields;
    void keep(Archive& archive);
  };
  void forget_attempt(int step);
  bool wants_forces() const;
  std::vector<ContactForce> forces_of(Diagnosis& state) const;
  void look_at_rows(StepSystem& system, const StepReport& report, const Positions& x);
  void write_last();

  const RunConfig& config_;
  RunRecord& record_;
  TraceWriter* trace_;
  ArtifactWriter* artifacts_;
  ConditionWatch condition_;
  std::optional<AuditWatch> audit_;
  FirstContacts first_contacts_;
  ContactGaps gaps_;
  std::optional<PairForces> pair_forces_;
  std::optional<LastState> last_;
  std::vector<TraceRow> rows_;  // of the step in progress
  std::vector<double> linear_;  // iterations of every solve
  std::vector<PhaseTimes> seen_;
  const std::vector<PhaseTimes>* reported_ = &seen_;
};

}  // namespace bb
