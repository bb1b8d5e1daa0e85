// A run that its caller advances one step at a time: the same scene, matching, steps and record as run_config, without
// checkpoints. It is one pass.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/base/archive/archive.hpp"
#include "core/base/record/folder_lock.hpp"
#include "core/step_solvers/simulation.hpp"
#include "core/terms/plan.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/outcome.hpp"
#include "experiments/run/pass.hpp"
#include "experiments/run/passes.hpp"
#include "experiments/run/recorder.hpp"
#include "experiments/run/runner.hpp"

namespace bb {

class ThreadLimit;

class SteppedRun {
 public:
  /// Called after every Newton iteration; what it throws ends the step.
  using Iteration = std::function<void(const IterationReport&)>;

  /// Of the two passes of a config it is the observed one, where there is one, and then leaves out the timed one: the config
  /// of its record reports it. options.folder: of record, trace, frames and matrices; empty: nothing is written, and
  /// the config may request no frames or matrices. options.resume and limits are not read.
  /// While it lives the process computes with at most the threads of the config: to limit them anew in each step costs
  /// milliseconds. A scene that cannot start is an outcome: the run is over before its first step.
  /// Errors: those of run_config; ConfigError for a run on a card, or a folder with a checkpoint;
  /// those of require_replaceable.
  SteppedRun(const RunConfig& asked, RunOptions options);
  /// Without finish() what was written goes.
  ~SteppedRun();
  SteppedRun(const SteppedRun&) = delete;
  SteppedRun& operator=(const SteppedRun&) = delete;

  /// After its last step, after one that did not converge, or after finish().
  bool over() const;
  /// The next step, as the record has it; valid until the next call. When something throws (a hook, a shape
  /// that is not of this program) the run is where it was before the step, bit for bit, and the error goes on.
  /// Errors: std::logic_error when it is over. std::bad_alloc is the outcome oom.   Cost: that of the step, and a copy of the state.
  const StepRecord& step(const Iteration& iteration = {});

  const RunConfig& config() const { return config_; }
  const Scene& scene() const { return scene_; }
  /// The state, [3 n], m and m/s; it moves with the next step.
  const Positions& x() const { return simulation_ ? simulation_->history().x : scene_.x0; }
  const Positions& v() const { return simulation_ ? simulation_->history().v : scene_.v0; }
  double time() const { return simulation_ ? simulation_->time() : 0; }  // s
  /// How it ended; ok while it goes on.
  const Verdict& verdict() const { return result_.verdict; }
  std::size_t steps() const { return result_.steps.size(); }

  /// The record of the steps so far. One of a run that is not over has the outcome timeout.
  /// Errors: std::logic_error for a run with frames that is not finished. Cost: O(steps).
  RunRecord record();
  /// Writes the record with what belongs to it, where there is a folder, and returns it. Again: the same record.
  /// Errors: RecordError.
  const RunRecord& finish();

 private:
  void prepare();
  void take_folder();  // locks it, and requires that what is there may be replaced
  void make_pass();
  void keep(Archive& archive);
  void go_back(const Archive& start);
  void close_record(Recorder& recorder, RunRecord& record) const;
  bool has_folder() const { return !options_.folder.empty(); }

  const bool asked_time_;  // /passes/time, as the caller gave it
  const RunConfig config_;
  std::unique_ptr<ThreadLimit> threads_;
  RunOptions options_;
  Scene scene_;
  std::optional<FolderLock> lock_;
  RunRecord record_;
  Plan plan_;
  Calibration calibration_;
  RunFiles files_;
  std::optional<Recorder> recorder_;
  std::optional<Method> method_;
  std::unique_ptr<Simulation> simulation_;
  PassResult result_;
  double t_end_ = 0;  // s, simulated
  bool finished_ = false;
  GrownLists lists_;  // of the archives that steps begin with
  std::string log_;   // what was appended to them
};

}  // namespace bb
