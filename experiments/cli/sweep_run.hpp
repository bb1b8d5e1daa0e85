// Runs the chosen cases of a sweep, here or in processes of their own, and counts what became of them.
#pragma once

#include <string>
#include <vector>

#include "experiments/cli/sweep_folder.hpp"

namespace bb::cli {

/// What a call reports whose only fault is that others are at its runs.
inline constexpr const char* made_by_others = "runs are made by other processes";

/// What became of the cases of one call.
struct SweepTally {
  std::size_t kept = 0;             // records that are there
  std::vector<bool> refused;        // one a case of the sweep: it cannot be run
  std::vector<std::size_t> in_use;  // another process had the folder
  std::size_t beyond_budget = 0;    // not begun
  std::vector<Violation> violations;
  std::string complaints;  // of processes that ended with an error, line by line
  bool failed = false;     // one ended as no run should
  bool try_again = false;  // one could not write, or was killed by the system
};

/// One case after the other in this process, or verb.jobs processes at a time. A case whose record is there is not run; one
/// whose folder another process has is looked at again at the end. Rows go to stdout as runs end, progress of the whole to
/// stderr. Errors: Interrupted once a signal has stopped it, its runs with a checkpoint; RecordError of this process.
SweepTally run_sweep_cases(const Sweep& sweep);

}  // namespace bb::cli
