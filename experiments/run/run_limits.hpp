// What may end a run early: a signal, or the time that it was given. Looked at between two parts of whatever runs.
#pragma once

#include <atomic>
#include <string>

namespace bb {

/// Thrown when the run was stopped: no run.json is written, an earlier one stays.
struct Interrupted {
  std::string kept;  // what a sweep reports of the records that it has; empty: nothing was kept
};

/// Thrown when the time limit was reached before the first step of a run.
struct TimeOver {
  std::string detail;  // of the outcome timeout
};

struct RunLimits {
  const std::atomic<bool>* interrupted = nullptr;  // may be null
  double deadline_s = 0;                           // as now_s() counts; 0: none
  double time_limit_s = 0;                         // what was requested, for the message

  /// Between two parts of what comes before the first step: of `part`, at a place such as "before its step 3 of 20".
  /// Errors: Interrupted; TimeOver.
  void look_up(const std::string& part, const std::string& place) const;
};

}  // namespace bb
