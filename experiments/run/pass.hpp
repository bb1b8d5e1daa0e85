// One pass of a run: a simulation from its start, or from where an archive leaves it, to its end, seen by a recorder.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/step_solvers/simulation.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/outcome.hpp"
#include "experiments/run/recorder.hpp"
#include "experiments/run/runner.hpp"

namespace bb {

struct PassResult {
  Verdict verdict;
  bool whole = false;      // it came to its end, good or bad; false: memory or time ran out before
  std::string state_hash;  // of the state that was reached
  struct StepTime {
    double wall_s;  // on its own clock, round the whole step
    PhaseTimes phases;
    void keep(Archive& archive);
  };
  std::vector<StepTime> steps;
  double wall_s = 0;  // of all steps
  StiffnessPolicy::State stiffness;
  void keep(Archive& archive);
};

class Pass {
 public:
  enum class Moment {
    between,  // after every config.output.checkpoint_every-th step but the last
    stop,     // a signal, the time limit or the step limit ends the pass here
    before_device,  // before every step of a run on a device, where a step may end in an error from which nothing can
                    // be read any more
  };

  /// All arguments must outlive the pass. name: of its progress line; passes_after: that follow it.
  Pass(const RunConfig& config, const Scene& scene, const Calibration& calibration, const Plan& plan,
       const RunOptions& options, const char* name, Recorder& recorder, int passes_after = 0);

  /// Goes on to the end. save() is called between two steps, at the moments below: a pass that goes on from an archive
  /// of such a moment is the same, bit for bit. std::bad_alloc and exec::OutOfMemory of a step are the outcome oom,
  /// exec::ExecutionError is kernel_failed, options.time_limit_s and options.step_limit
  /// the outcome timeout.
  /// Errors: Interrupted.
  PassResult run(const std::function<void(Moment)>& save);
  /// All that the rest of the pass depends on, and what it has recorded so far.
  void keep(Archive& archive);
  /// Steps that are over.
  std::size_t steps() const { return result_.steps.size(); }

 private:
  void step();
  void show(const StepReport& step) const;
  bool is_at_step_limit() const;
  bool should_stop() const;
  void stop();
  void cut(Outcome outcome, const char* what);

  const RunConfig& config_;
  const RunOptions& options_;
  const char* name_;
  Recorder& recorder_;
  int passes_after_;
  Method method_;
  Simulation simulation_;
  PassResult result_;
  double t_end_ = 0, t_begin_ = 0;  // s, simulated: of the run, of what this process does
  std::size_t begun_with_ = 0;      // steps that were over when this process took the pass
  double start_s_ = 0;              // on the clock
};

}  // namespace bb
