// The passes of a run, from its first step to its outcome: `time` alone, then what `diagnose` and `audit` share.
#pragma once

#include <optional>
#include <vector>

#include "core/base/record/writer.hpp"
#include "core/terms/plan.hpp"
#include "experiments/run/artifacts.hpp"
#include "experiments/run/checkpoint.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/runner.hpp"

namespace bb {

/// Written beside the record; they get their names when the run is over (put_in_place).
struct RunFiles {
  std::optional<TraceWriter> trace;
  std::optional<ArtifactWriter> artifacts;

  /// What the record names: frames and matrices so far, and the trace as it is now.
  std::vector<Artifact> written() const {
    std::vector<Artifact> out;
    if (artifacts) out = artifacts->written();
    if (trace) out.push_back(trace->artifact());
    return out;
  }
  /// Everything is on the disk, and stays.
  void close() {
    if (trace) trace->close();
    if (artifacts) artifacts->leave_unfinished();
  }
  /// They go, for a run that leaves neither record nor checkpoint.
  void leave_nothing() {
    trace.reset();
    artifacts.reset();
  }
};

/// Where a run goes on from: what came before its passes, and the rest of the checkpoint.
struct Resumed {
  RunRecord record;  // as it was when the passes began
  Calibration calibration;
  Archive rest;
};

/// The head of a checkpoint's archive. Errors: ConfigError when it is of another config, machine, plugin ...
/// than `now`, the record of the run that is requested, naming what differs.
std::optional<Resumed> read_resumed(Checkpoint& checkpoint, const RunRecord& now);

/// Runs all passes, or what a checkpoint leaves of them, and fills the record. No time of the second pass is
/// reported as a time. The checkpoint is written while they run; removing it is the caller's.
/// Errors: Interrupted, RecordError; ConfigError when files that the checkpoint names are not there.
void run_passes(const RunConfig& config, const Scene& scene, const Plan& plan, const Calibration& calibration,
                const RunOptions& options, Checkpoint& checkpoint, Resumed* resumed, RunRecord& record,
                RunFiles& files);

}  // namespace bb
