// Runs one resolved config: matching, its passes, and the record it leaves.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/earlier_run.hpp"
#include "experiments/run/run_limits.hpp"

namespace bb {

/// What a progress line shows.
struct Progress {
  std::string label;      // the note of the run
  const char* pass = "";  // "calibration", "time" or "diagnose"
  int step = 0, steps = 0;
  double t_s = 0, t_end_s = 0;  // simulated
  int newton = 0;               // iterations of the step
  std::size_t contacts = 0;
  Number gap;            // m, at the end of the step
  double elapsed_s = 0;  // of the pass
  double eta_s = 0;      // to the end of the run: the passes that follow are taken to be as long as this one
};

/// What becomes of a checkpoint in the folder.
enum class Resume {
  no,           // it goes
  if_this_run,  // the run goes on from it where it is one of this very run; else it goes
  yes  // the run goes on from it, and is refused where it is one of another run; from the start without one
};

struct RunOptions {
  std::filesystem::path folder;  // run.json, trace.jsonl; what may be there already: earlier_run.hpp
  Replace replace = Replace::own;
  std::vector<std::string> argv;  // for the record
  std::string note;               // how the row of a table differs
  std::string sweep_id;
  std::map<std::string, std::string> swept;       // of a case of a sweep: pointer -> JSON text, of its axes
  std::string rerun_of;                           // run_id of the record that is repeated
  BuildValidity build;                            // of this program; not valid: no times are kept
  std::vector<PluginFile> plugins;                // loaded, `file` as a path that can be opened
  bool keep_inputs = false;                       // copy meshes and plugins to inputs/ and name the copies
  std::function<void(const Progress&)> progress;  // may be empty
  std::function<void(const std::string&)> tell;   // what the user should know beside the record; may be empty
  const std::atomic<bool>* interrupted = nullptr;
  Resume resume = Resume::no;
  double time_limit_s =
      0;  // of this process, looked at between two steps, those of the calibration run too; 0: none
  int step_limit = 0;     // of this process in each pass; 0: none
  double deadline_s = 0;  // set by run_config: when that is over, as now_s() counts

  RunLimits limits() const { return {interrupted, deadline_s, time_limit_s}; }
};

/// The run was cut off before it had as many steps as the record of the same run that is in the folder.
struct EarlierStays : Interrupted {
  explicit EarlierStays(std::string why) : Interrupted{std::move(why)} {}
};

/// What is known before the run: config with its files named from options.folder, provenance, machine, ids.
RunRecord identified(const RunConfig& config, const RunOptions& options);

/// What a run that uses a formula should report of it: signs of its derivatives that are only sampled. One text a formula.
std::vector<std::string> formula_caveats(const RunConfig& config);

/// Runs and writes. The outcome is in the record, whatever it is. The folder is locked meanwhile; an earlier
/// run in it stays as it is until this one is over, and then goes with its trace, frames and matrices. A run that time or
/// memory ends leaves its record and its checkpoint; the record of more steps of the same run stays in its place.
/// With options.resume a run whose record is in the folder already is not run: the record is returned.
/// Errors: ConfigError for what config and files show, as build_scene and require_replaceable (nothing of this run is written; what a
///   run that was killed had finished has its names by then);
///   RecordError (output, or another process has the folder); Interrupted.
RunRecord run_config(const RunConfig& config, const RunOptions& options);

/// scene-formulation-id8: the folder name of a run.
std::string run_label(const RunConfig& config);

/// What tables call a run that is no case of a sweep: "NAME: FORMULATION", of the config's name (without one, of the scene), and
/// of the shape, the policy and the first digits of the config's id where the formulation is no preset.
std::string own_note(const RunConfig& config);

}  // namespace bb
