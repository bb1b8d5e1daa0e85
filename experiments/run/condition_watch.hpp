// The pass `diagnose`: condition estimates, PCG probes and matrix files of the iterations that are due.
#pragma once

#include <vector>

#include "core/base/record/run_record.hpp"
#include "core/linear/condition.hpp"
#include "core/newton/report.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/artifacts.hpp"
#include "experiments/run/cond_summary.hpp"
#include "experiments/run/pcg_probe.hpp"

namespace bb {

class Diagnosis;

class ConditionWatch {
 public:
  /// `artifacts` gets matrices where the config has them; may be null.
  ConditionWatch(const RunConfig& config, ArtifactWriter* artifacts);

  /// After the solve: estimates of the stages and scalings of the config, none when the iteration is not due.
  void on_matrix(StepSystem& system, int step, int iteration);
  /// At the end of the iteration: fills `cond` and `probe_pcg_iterations` of its row.
  void on_iteration(const LinearReport& linear, TraceRow& row);
  /// The step is over: what was estimated in it is of the run; or it begins again, and that is forgotten.
  void end_step();
  void forget_step();
  /// `cond` and `probe_pcg` of the steps that are over.
  void fill(Summary& summary) const;
  /// What was estimated so far, between two steps.
  void keep(Archive& archive);

 private:
  bool due(int iteration) const;
  void write_matrices(Diagnosis& system, int step, int iteration);
  void estimate(const ReducedSystem& matrix, MatrixForm form, MatrixStage stage);
  void find_ends(Diagnosis& system, TermSet set);

  const RunConfig& config_;
  ArtifactWriter* artifacts_;
  ConditionEstimator estimator_;
  PcgProbe probe_;
  bool due_ = false;                       // of the iteration in progress, as the next three
  MatrixForm form_ = MatrixForm::clamped;  // of the matrix that was solved
  std::vector<ConditionSample> samples_;
  Number probed_;
  CondSummary cond_, step_cond_;  // of the steps that are over; of the one in progress
  std::vector<double> probes_, step_probes_;
  double spent_s_ = 0;
};

}  // namespace bb
