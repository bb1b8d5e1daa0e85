// Looks on at a simulation and turns what it sees into trace rows, step records, condition samples and the
// audit's ledger. It changes nothing: the state hash is the same with and without it.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/audit/audit.hpp"
#include "core/linear/condition.hpp"
#include "core/newton/report.hpp"
#include "core/record/run_record.hpp"
#include "core/record/writer.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/artifacts.hpp"
#include "experiments/run/cond_summary.hpp"
#include "experiments/run/outcome.hpp"
#include "experiments/run/pcg_probe.hpp"

namespace bb {

class Recorder final : public StepObserver {
 public:
  /// trace and artifacts may be null (nothing is written). record is filled step by step.
  Recorder(const RunConfig& config, const Scene& scene, RunRecord& record, TraceWriter* trace,
           ArtifactWriter* artifacts = nullptr);
  ~Recorder() override;

  /// The times that the trace gives to the iterations: those of the run that was timed, in order, or none.
  /// `times` must outlive the recorder.
  void report_times(const std::vector<PhaseTimes>& times) { reported_ = &times; }
  /// Of every iteration that this recorder saw.
  const std::vector<PhaseTimes>& iteration_times() const { return seen_; }

  void on_matrix(NewtonSystem& system, int step, int iteration) override;
  void on_iteration(const IterationReport& report) override;
  void on_motion(const Positions& x0, const Positions& x1, int step) override;
  void on_step(NewtonSystem& system, const StepReport& report, const Positions& x) override;

  /// Sums over the run, once it is over.
  void finish();

  /// What the audit found, as an outcome; ok without the pass `audit`.
  Verdict audit_verdict() const;
  /// Of the audit; null without the pass `audit`.
  const audit::AuditLedger* ledger() const { return audit_ ? &audit_->ledger() : nullptr; }

 private:
  void judge(const Positions& x, int step);
  void fill_gaps(const NewtonSystem& system, const StepReport& report, StepRecord& step);
  void fill_audit();
  TraceRow trace_row(const IterationReport& report) const;
  void add_ritz_sample(const LinearReport& linear);
  bool due(int step, int iteration) const;
  void note_contacts(const NewtonSystem& system, int step);

  const RunConfig& config_;
  const Scene& scene_;
  RunRecord& record_;
  TraceWriter* trace_;
  ArtifactWriter* artifacts_;
  audit::AuditMesh audit_mesh_;  // for names; empty without the pass `audit`
  std::unique_ptr<audit::Audit> audit_;
  double audit_tolerance_ = 0;
  Positions last_judged_;  // by the audit: where the next motion has to start
  ConditionEstimator estimator_;
  std::vector<ConditionSample> samples_;  // of the iteration in progress
  bool due_now_ = false;                  // whether it is diagnosed
  std::vector<TraceRow> rows_;            // of the step in progress
  double condition_s_ = 0;
  CondSummary cond_;
  std::set<std::pair<int, int>> touching_;  // bodies, then obstacles, that have been in contact
  PcgProbe probe_;
  Number probed_;  // of the iteration in progress
  std::vector<double> newton_, linear_, probes_, contacts_, gaps_;
  Number iterates_gap_, iterates_gap_rel_;  // of the step in progress
  std::vector<PhaseTimes> seen_;
  const std::vector<PhaseTimes>* reported_ = &seen_;
};

}  // namespace bb
