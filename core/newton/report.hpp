// What an iteration, a step and an observer report to each other: plain numbers, no JSON. What the record keeps
// of them is in TraceRow and StepRecord (core/base/record).
#pragma once

#include "core/base/record/step_record.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/terms/report.hpp"

namespace bb {

/// The attempts at one Newton system: the matrix is changed until it is positive definite and the direction
/// descends.
struct SolveReport {
  LinearReport linear;  // of the last attempt; its iterations are sums over all
  int attempts = 0, factorizations = 0, analyses = 0;
  int corrections = 0;  // solves beyond those attempts, with the matrix of the last
  double factor_flop = 0;
  double t = 0;  // of the matrix that was solved, 0 exact to 1 clamped
  int fallbacks() const { return attempts - 1; }
  /// One more attempt.
  void add_attempt(const LinearReport& attempt) {
    ++attempts;
    factorizations += attempt.factorized ? 1 : 0;
    factor_flop += attempt.factor_flop;
    analyses += attempt.analyzed ? 1 : 0;
    const int before = linear.iterations;
    linear = attempt;
    linear.iterations += before;
  }
  /// The work of one more solve; what is reported of the direction stays.
  void add_correction(const SolveReport& solve) {
    ++corrections;
    factorizations += solve.factorizations;
    analyses += solve.analyses;
    factor_flop += solve.factor_flop;
    linear.iterations += solve.linear.iterations;
  }
};

/// `time` is from its assembly to its end, what observers of the matrix took included.
struct IterationReport : IterateNumbers {
  SolveReport solve;
  bool pattern_changed = false;
  double dx_beyond_m = 0, dx_rounding_m = 0;  // parts of dx_inf_m (DirectionSize)
};

/// `detail` names the pin, the pair, the linear status. `time` has every moment of Simulation::step; on_step
/// sees what came before it.
struct StepReport : StepNumbers {
  bool still_falling = false;       // |dx| was, when the cap on iterations was reached
  long long ccd_capped_before = 0;  // of ccd_capped, those of attempts before the last
  int iterations_before = 0;        // of newton_iterations
  /// Counts what an attempt before this one cost, which was twice as long and failed.
  void add_attempt(const StepReport& failed, const std::vector<SolverCounter>& counters = {}) {
    add_work(failed, counters);
    retries = failed.retries + 1;
    redone_audited = failed.redone_audited;
  }
  /// The same of one as long, whose motion was not proven.
  void add_unproven(const StepReport& attempt, const std::vector<SolverCounter>& counters = {}) {
    add_work(attempt, counters);
    retries = attempt.retries;
    redone_audited = attempt.redone_audited + 1;
  }

 private:
  void add_work(const StepReport& failed, const std::vector<SolverCounter>& counters) {
    audited_queries += failed.audited_queries;
    ccd_capped_before = failed.ccd_capped;
    iterations_before = failed.newton_iterations;
    newton_iterations += failed.newton_iterations;
    *this += failed;
    for (const SolverCounter& counter : counters) {
      if (counter.over_steps == OverSteps::sum)
        solver.values[counter.name] += failed.solver.values.at(counter.name);
    }
  }
};

class StepSystem;

/// Observer; override what you need. Callbacks are charged to Phase::output.
class StepObserver {
 public:
  virtual ~StepObserver() = default;
  /// After the solve, before the step: the matrices of this iteration are in `system`.
  virtual void on_matrix(StepSystem&, int /*step*/, int /*iteration*/) {}
  virtual void on_iteration(const IterationReport&) {}
  /// Whether on_motion has to be called: elsewhere than on the CPU it costs two copies of the state.
  virtual bool watches_motions() const { return true; }
  /// An accepted line search, as rounded.
  virtual void on_motion(const Positions& /*x0*/, const Positions& /*x1*/, int /*step*/) {}
  /// The step failed and begins again from its start, shorter: what it was is no part of the run.
  virtual void on_retry(int /*step*/) {}
  /// The step was not proven to pass through nothing and begins again from its start, as long, with every
  /// motion bounded until it is over.
  virtual void on_redo(int step) { on_retry(step); }
  /// A finished step; `system` holds the contact table of its end state.
  virtual void on_step(StepSystem&, const StepReport&, const Positions& /*x*/) {}
};

}  // namespace bb
