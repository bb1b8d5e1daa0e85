// Runs one resolved config: matching, the passes it asks for, and the record it leaves.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/record/run_record.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// What a progress line shows.
struct Progress {
  std::string label;      // scene and formulation
  const char* pass = "";  // "pilot", "time" or "diagnose"
  int step = 0, steps = 0;
  int newton = 0;  // iterations of the step
  std::size_t contacts = 0;
  double gap = 0;  // m; infinity without contacts
  double elapsed_s = 0, eta_s = 0;
};

struct RunOptions {
  std::filesystem::path folder;   // run.json, trace.jsonl; must not exist or is overwritten
  std::vector<std::string> argv;  // for the record
  std::string note;               // how the row of a table differs
  std::string sweep_id;
  std::function<void(const Progress&)> progress;  // may be empty
  const std::atomic<bool>* interrupted = nullptr;
};

/// Thrown when the run was interrupted: no run.json is written.
struct Interrupted {};

/// Runs and writes. The outcome is in the record, whatever it is.
/// Errors: ConfigError for what config and files can tell, as build_scene (nothing is written); RecordError
/// (output), Interrupted.
RunRecord run_config(const RunConfig& config, const RunOptions& options);

/// scene-formulation-id8: the folder name of a run.
std::string run_label(const RunConfig& config);

}  // namespace bb
