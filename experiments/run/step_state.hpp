// A state of a run in front of one step, as two files: NAME.state, the archive of its simulation, compressed, and NAME.json, what it
// belongs to. The folder results/steps holds states that are hard for a step solver.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/run/step_trial.hpp"

namespace bb {

inline constexpr const char* step_state_schema = "barrierbench.step_state/1";

struct StepState {
  std::string name;      // of its files
  std::string hard_for;  // what makes the step hard; empty where the file does not say it
  std::string split;     // "tune" or "report"; empty where the file does not say it
  RunConfig config;
  Scene scene;
  Calibration calibration;  // of the run, so that none is made again
  StepStart start;
  std::string file;  // NAME.json
};

/// Runs the config to the start of a step and writes stem.state and stem.json. Errors: as run_config; ConfigError when the step is
/// beyond the run, or the run does not get there; RecordError, before the run where the files cannot be written.
void keep_step_state(const RunConfig& config, int step, const std::filesystem::path& stem,
                     const RunOptions& options);

/// The names of the states in a folder, ascending. Errors: ConfigError when there is no folder, or no state in it.
std::vector<std::string> step_states_in(const std::filesystem::path& folder);

/// Errors: ConfigError naming the file: it is not there, no JSON, damaged, of another scene or mesh than its config makes now, or
/// no archive that this program can read; what makes it again.
StepState read_step_state(const std::filesystem::path& folder, const std::string& name);

}  // namespace bb
